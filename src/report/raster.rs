//! Figures as PNG images, drawn with the bundled font: they look the same on every machine.

use super::font::FONT;
use super::vocabulary::Figure;
use crate::error::{Error, Result};
use resvg::usvg::fontdb;
use resvg::{tiny_skia, usvg};
use std::sync::{Arc, OnceLock};

/// Pixels per SVG pixel in the images that the program writes: sharp in print at the width of a page.
pub const PNG_SCALE: f64 = 2.0;
/// Beyond this a scale is a slip of the pen.
const MAX_SCALE: f64 = 20.0;
const NAME: &str = "DejaVu Sans";

impl Figure {
    /// The PNG image with `scale` pixels per SVG pixel, drawn with the bundled font.
    ///
    /// # Errors
    /// [`Error::Input`] for a scale that is not in (0, 20]; [`Error::Numerical`] when the picture cannot be drawn.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>> {
        if !(scale > 0.0 && scale <= MAX_SCALE) {
            let expected = format!("a number above 0 and up to {MAX_SCALE}");
            let (place, found) = ("scale of the PNG image", scale.to_string());
            return Err(Error::input(place, expected, found));
        }
        let failed = |what: String| Error::Numerical(format!("figure: {what}"));
        let tree =
            usvg::Tree::from_str(self.svg(), &options()).map_err(|e| failed(e.to_string()))?;
        let pixels = |length: f32| (f64::from(length) * scale).round().max(1.0) as u32;
        let (width, height) = (pixels(tree.size().width()), pixels(tree.size().height()));
        let mut picture = tiny_skia::Pixmap::new(width, height)
            .ok_or_else(|| failed(format!("{width} x {height} pixels do not fit")))?;
        let transform = tiny_skia::Transform::from_scale(scale as f32, scale as f32);
        resvg::render(&tree, transform, &mut picture.as_mut());
        picture.encode_png().map_err(|e| failed(e.to_string()))
    }
}

/// How SVG is read: with the bundled font and no other.
fn options() -> usvg::Options<'static> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let fonts = FONTS.get_or_init(|| {
        let mut fonts = fontdb::Database::new();
        fonts.load_font_source(fontdb::Source::Binary(Arc::new(FONT)));
        fonts.set_sans_serif_family(NAME);
        Arc::new(fonts)
    });
    usvg::Options {
        font_family: NAME.to_owned(),
        fontdb: Arc::clone(fonts),
        ..usvg::Options::default()
    }
}
