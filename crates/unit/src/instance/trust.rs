//! What is said of winds and rotations that no test or theory stands behind, and how numbers are shown.

use super::coupled::{Coupled, CoupledKind};
use super::memory::Memory;

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

impl<S: CoupledKind> Coupled<S> {
    #[inline]
    pub(super) fn in_tested_winds(&self, memory: &Memory) -> bool {
        let wind = self.indices.wind_speed(memory);
        S::tested_winds(self).is_some_and(|[low, high]| (low..=high).contains(&wind))
    }

    /// Says, once, when the wind leaves the tested range.
    #[cold]
    pub(super) fn watch_wind(&mut self, memory: &Memory, notices: &mut Vec<String>) {
        let inside = self.in_tested_winds(memory);
        let leaves = self.wind_was_tested && !inside && !self.wind_left;
        if let Some([low, high]) = S::tested_winds(self).filter(|_| leaves) {
            self.wind_left = true;
            let wind = shown(self.indices.wind_speed(memory));
            notices.push(format!(
                "wind_speed = {wind} m/s leaves the speeds at which {}, {low:.3} to {high:.3} m/s: the forces are \
                 extrapolated",
                S::TESTED_AT
            ));
        }
        self.wind_was_tested = inside;
    }
}
