//! A finished figure: SVG text, PNG bytes, files.

use super::font;
use crate::error::{Error, Result};
use resvg::{tiny_skia, usvg};
use std::path::{Path, PathBuf};

/// Pixels per SVG pixel in the PNG files of [`Figure::write`]: sharp in print at the width of a page.
pub const PNG_SCALE: f64 = 2.0;
/// Beyond this a scale is a slip of the pen.
const MAX_SCALE: f64 = 20.0;

/// A drawing as SVG text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    svg: String,
}

impl Figure {
    pub(super) fn from_svg(svg: String) -> Self {
        Self { svg }
    }

    /// The SVG text: one `svg` element with a `viewBox`, ready to stand in a page; its identifiers are its own, so that
    /// several figures in one page do not disturb each other.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// The PNG image with `scale` pixels per SVG pixel, drawn with the bundled font.
    ///
    /// # Errors
    /// [`Error::Input`] for a scale that is not in (0, 20]; [`Error::Numerical`] when the picture cannot be drawn.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>> {
        if !(scale > 0.0 && scale <= MAX_SCALE) {
            return Err(Error::input(
                "scale of the PNG image",
                format!("a number above 0 and up to {MAX_SCALE}"),
                scale.to_string(),
            ));
        }
        let failed = |what: String| Error::Numerical(format!("figure: {what}"));
        let tree = usvg::Tree::from_str(&self.svg, &font::svg_options())
            .map_err(|e| failed(e.to_string()))?;
        let pixels = |length: f32| (f64::from(length) * scale).round().max(1.0) as u32;
        let size = (pixels(tree.size().width()), pixels(tree.size().height()));
        let mut picture = tiny_skia::Pixmap::new(size.0, size.1)
            .ok_or_else(|| failed(format!("{} x {} pixels do not fit", size.0, size.1)))?;
        let transform = tiny_skia::Transform::from_scale(scale as f32, scale as f32);
        resvg::render(&tree, transform, &mut picture.as_mut());
        picture.encode_png().map_err(|e| failed(e.to_string()))
    }

    /// Writes `stem.svg` and `stem.png` into the existing directory `dir`; returns their paths.
    ///
    /// # Errors
    /// [`Error::Io`] naming the file; [`Error::Numerical`] when the picture cannot be drawn.
    pub fn write(&self, dir: impl AsRef<Path>, stem: &str) -> Result<[PathBuf; 2]> {
        let path = |extension: &str| dir.as_ref().join(format!("{stem}.{extension}"));
        let paths = [path("svg"), path("png")];
        let png = self.png(PNG_SCALE)?;
        for (path, bytes) in paths.iter().zip([self.svg.as_bytes(), &png]) {
            std::fs::write(path, bytes).map_err(|e| Error::io(path, e))?;
        }
        Ok(paths)
    }
}
