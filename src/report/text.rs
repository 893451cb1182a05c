//! Texts of figures as elements of the drawing.

use kuva::render::color::Color;
use kuva::render::render::{Primitive, TextAnchor};

/// A text that starts at a point.
pub(super) fn text((x, y): (f64, f64), content: &str, size: u32, colour: &str) -> Primitive {
    Primitive::Text {
        x,
        y,
        content: literal(content),
        size,
        anchor: TextAnchor::Start,
        rotate: None,
        bold: false,
        color: Some(Color::from(colour)),
    }
}

/// `content` as it stands: dollars are no mathematics, and what XML cannot hold becomes a space.
fn literal(content: &str) -> String {
    content
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect::<String>()
        .replace('$', "\\$")
}
