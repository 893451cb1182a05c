//! The winds in which a section was tested, and what is said of rotations.

use crate::resources::Resources;
use crate::response::Stepper;

/// Wind speeds (m/s) at which every motion, at its frequency in still air, lies in the tested range; `None` where there
/// are none.
pub(super) fn tested_winds(stepper: &Stepper, resources: &Resources) -> Option<[f64; 2]> {
    let s = stepper.section().structure();
    let (slowest, fastest) = s
        .still_air_rad_s()
        .fold((f64::INFINITY, 0.0_f64), |(a, b), w| (a.min(w), b.max(w)));
    let range = resources.model.tested_range;
    let low = fastest * s.width_m / range.max.full_width();
    let high = slowest * s.width_m / range.min.full_width();
    (low <= high).then_some([low, high])
}

/// What is said of a rotation (rad) beyond it.
pub(super) fn beyond_linear(rotation: f64) -> String {
    let degrees = rotation.to_degrees();
    format!("the rotation, {degrees:.1} degrees, is beyond linear theory (about 10 degrees)")
}
