//! The one font of all figures, and how wide a text is in it.
//!
//! DejaVu Sans 2.37, under the Bitstream Vera licence in `fonts/LICENSE_DEJAVU`; it holds the Greek letters,
//! subscripts and stars of the field.

use std::sync::OnceLock;
use ttf_parser::{Face, GlyphId};

/// Families in the order in which a viewer of the SVG tries them; Verdana has the widths of DejaVu Sans.
pub(super) const FAMILIES: &str = "DejaVu Sans, Verdana, sans-serif";
/// The file of the font.
pub(super) const FONT: &[u8] = include_bytes!("fonts/DejaVuSans.ttf");

/// Width of `text` at `size`, px: the sum of the advances, without kerning; a character that the font lacks is as wide as its box.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    static FACE: OnceLock<Option<Face<'static>>> = OnceLock::new();
    let face = FACE.get_or_init(|| Face::parse(FONT, 0).ok());
    let Some(face) = face else { return 0.0 };
    let advance = |c: char| {
        let glyph = face.glyph_index(c).unwrap_or(GlyphId(0));
        f64::from(face.glyph_hor_advance(glyph).unwrap_or(0))
    };
    text.chars().map(advance).sum::<f64>() * size / f64::from(face.units_per_em())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_those_of_the_font() {
        // advance widths of DejaVu Sans in 1/2048 em: "0" 1303, "V" 1401
        let em = 2048.0;
        assert_eq!(text_width("00", 10.0), 2.0 * 1303.0 / em * 10.0);
        assert_eq!(text_width("V", 12.0), 1401.0 / em * 12.0);
        assert!(text_width("a<b & c", 12.0) > text_width("ab", 12.0));
        assert_eq!(text_width("", 12.0), 0.0);
    }

    #[test]
    fn every_character_the_figures_use_is_in_the_font() {
        let face = Face::parse(FONT, 0).unwrap();
        for c in "ωζλθ°·×−–≤₁₂₃₄₅₆⁰¹²³⁴⁵⁶⁷⁸⁹⁻*̂".chars()
        {
            assert!(face.glyph_index(c).is_some(), "{c} is missing");
        }
    }
}
