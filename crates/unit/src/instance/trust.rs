//! What is said of rotations, and how numbers are shown.

/// A number in a message: of one that is very large or small no hundred digits.
pub(super) fn shown(number: f64) -> String {
    match number.abs() {
        0.0 => number.to_string(),
        size if size <= 1e-6 || size >= 1e6 => format!("{number:e}"),
        _ => number.to_string(),
    }
}

/// What is said of a rotation (rad) beyond it.
pub(super) fn beyond_linear(rotation: f64) -> String {
    let degrees = match rotation.to_degrees() {
        few if few.abs() < 1e6 => format!("{few:.1}"),
        many => format!("{many:.1e}"),
    };
    format!("the rotation, {degrees} degrees, is beyond linear theory (about 10 degrees)")
}
