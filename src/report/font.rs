//! The one font of all figures, and how wide a text is in it.
//!
//! DejaVu Sans 2.37, under the Bitstream Vera licence in `fonts/LICENSE_DEJAVU`; it holds the Greek letters,
//! subscripts and stars of the field.

use resvg::usvg::{self, fontdb};
use std::sync::{Arc, OnceLock};

/// Families in the order in which a viewer of the SVG tries them; Verdana has the widths of DejaVu Sans.
pub(super) const FAMILIES: &str = "DejaVu Sans, Verdana, sans-serif";
const NAME: &str = "DejaVu Sans";
const FONT: &[u8] = include_bytes!("fonts/DejaVuSans.ttf");
/// Size at which texts are measured: large, so that rounding does not matter.
const MEASURING_SIZE: f64 = 100.0;

/// How SVG is read: with the bundled font and no other.
pub(super) fn svg_options() -> usvg::Options<'static> {
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

/// Width of `text` at `size`, px.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1\" height=\"1\"><text y=\"1\" font-size=\"{MEASURING_SIZE}\">{}</text></svg>",
        escape(text)
    );
    let Ok(tree) = usvg::Tree::from_str(&svg, &svg_options()) else {
        return 0.0;
    };
    let width = tree.root().abs_bounding_box().width();
    f64::from(width) * size / MEASURING_SIZE
}

/// `text` as character data of XML.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_those_of_the_font() {
        // advance widths of DejaVu Sans in 1/2048 em: "0" 1303, "V" 1401
        let em = 2048.0;
        assert!((text_width("00", 10.0) - 2.0 * 1303.0 / em * 10.0).abs() < 0.02);
        assert!((text_width("V", 12.0) - 1401.0 / em * 12.0).abs() < 0.02);
        assert!(text_width("a<b & c", 12.0) > text_width("ab", 12.0));
        assert_eq!(text_width("", 12.0), 0.0);
    }

    #[test]
    fn every_character_the_figures_use_is_in_the_font() {
        // a missing glyph is drawn as the box of .notdef, which is 1229/2048 em wide
        let missing = text_width("\u{e000}", 100.0);
        for c in "ωζλθ°·×−–≤₁₂₃₄₅₆⁰¹²³⁴⁵⁶⁷⁸⁹⁻*̂".chars()
        {
            let width = text_width(&format!("a{c}"), 100.0) - text_width("a", 100.0);
            assert!((width - missing).abs() > 0.1, "{c} is missing");
        }
    }
}
