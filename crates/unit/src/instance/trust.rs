//! What is said of rotations.

/// What is said of a rotation (rad) beyond it.
pub(super) fn beyond_linear(rotation: f64) -> String {
    let degrees = rotation.to_degrees();
    format!("the rotation, {degrees:.1} degrees, is beyond linear theory (about 10 degrees)")
}
