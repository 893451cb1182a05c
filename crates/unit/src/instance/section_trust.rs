//! Whether the wind and the rotation of a section are those that were tested.

use super::coupled::CoupledKind;
use super::memory::Memory;
use super::section_unit::{SectionUnit, SuspendedSection};
use super::trust::beyond_linear;
use crate::variables::LINEAR_ROTATION_RAD;

impl SectionUnit {
    #[inline]
    pub(super) fn in_tested_winds(&self, memory: &Memory) -> bool {
        let wind = self.indices.wind_speed(memory);
        let tested = self.built.tested_winds;
        tested.is_some_and(|[low, high]| (low..=high).contains(&wind))
    }

    /// Whether there may be something to say; part of every step.
    #[inline]
    pub(super) fn trust_changes(&self, memory: &Memory) -> bool {
        self.in_tested_winds(memory) != self.own.wind_was_tested || self.rotation_news(memory)
    }

    /// Whether the rotation is beyond linear theory for the first time.
    #[inline]
    pub(super) fn rotation_news(&self, memory: &Memory) -> bool {
        SuspendedSection::rotation(self, memory).abs() > LINEAR_ROTATION_RAD
            && !self.own.rotation_left
    }

    /// Says when the wind leaves the tested range, and when the rotation leaves linear theory; each once.
    #[cold]
    pub(super) fn watch_trust(&mut self, memory: &Memory, notices: &mut Vec<String>) {
        let inside = self.in_tested_winds(memory);
        let leaves = self.own.wind_was_tested && !inside && !self.own.wind_left;
        if let Some([low, high]) = self.built.tested_winds.filter(|_| leaves) {
            self.own.wind_left = true;
            let wind = self.indices.wind_speed(memory);
            notices.push(format!(
                "wind_speed = {wind} m/s leaves the speeds at which this section was tested, {low:.3} to {high:.3} m/s \
                 at its frequencies in still air: the forces are extrapolated"
            ));
        }
        self.own.wind_was_tested = inside;
        let rotation = SuspendedSection::rotation(self, memory);
        if rotation.abs() > LINEAR_ROTATION_RAD && !self.own.rotation_left {
            self.own.rotation_left = true;
            notices.push(beyond_linear(rotation));
        }
    }
}
