//! Whether the wind and the rotation of a section are those that were tested.

use super::coupled::CoupledUnit;
use super::memory::Memory;
use super::section_unit::SectionUnit;
use super::trust::beyond_linear;
use crate::variables::LINEAR_ROTATION_RAD;

impl SectionUnit {
    #[inline]
    pub(super) fn in_tested_winds(&self, memory: &Memory) -> bool {
        let wind = self.places().wind_speed(memory);
        let tested = self.tested_winds;
        tested.is_some_and(|[low, high]| (low..=high).contains(&wind))
    }

    /// Whether there may be something to say; part of every step.
    #[inline]
    pub(super) fn trust_changes(&self, memory: &Memory) -> bool {
        self.in_tested_winds(memory) != self.warned.wind_was_tested || self.rotation_news(memory)
    }

    /// Whether the rotation is beyond linear theory for the first time.
    #[inline]
    pub(super) fn rotation_news(&self, memory: &Memory) -> bool {
        self.rotation(memory).abs() > LINEAR_ROTATION_RAD && !self.warned.rotation_left
    }

    /// Says when the wind leaves the tested range, and when the rotation leaves linear theory; each once.
    #[cold]
    pub(super) fn watch_trust(&mut self, memory: &Memory, notices: &mut Vec<String>) {
        let inside = self.in_tested_winds(memory);
        let leaves = self.warned.wind_was_tested && !inside && !self.warned.wind_left;
        if let Some([low, high]) = self.tested_winds.filter(|_| leaves) {
            self.warned.wind_left = true;
            let wind = self.places().wind_speed(memory);
            notices.push(format!(
                "wind_speed = {wind} m/s leaves the speeds at which this section was tested, {low:.3} to {high:.3} m/s \
                 at its frequencies in still air: the forces are extrapolated"
            ));
        }
        self.warned.wind_was_tested = inside;
        let rotation = self.rotation(memory);
        if rotation.abs() > LINEAR_ROTATION_RAD && !self.warned.rotation_left {
            self.warned.rotation_left = true;
            notices.push(beyond_linear(rotation));
        }
    }
}
