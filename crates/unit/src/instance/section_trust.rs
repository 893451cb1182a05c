//! How far a section is from flutter, and whether its wind and rotation are those that were tested.

use super::memory::Memory;
use super::section_unit::SectionUnit;
use super::trust::{LINEAR_ROTATION_RAD, MonitoredUnit, beyond_linear};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::resources::Resources;
use crate::response::Stepper;

impl MonitoredUnit for SectionUnit {
    fn coupled(&self) -> Option<&CoupledSection> {
        self.stepper.as_ref().map(Stepper::section)
    }

    fn damping_at(&mut self, wind: f64) -> Result<f64> {
        match &mut self.stepper {
            Some(stepper) => self.damping.at(stepper, wind),
            None => Ok(0.0),
        }
    }

    fn wind_speed(&self, memory: &Memory) -> f64 {
        memory.values[self.places.wind_speed]
    }

    fn onset_speed(&self, memory: &Memory) -> f64 {
        memory.values[self.places.onset_speed]
    }

    fn rotation(&self, memory: &Memory) -> f64 {
        memory.system.values[self.places.force.len() - 1]
    }

    fn wind_is_tested(&mut self, _: &Resources, memory: &mut Memory, _: &mut Vec<String>) -> bool {
        self.in_tested_winds(memory)
    }
}

impl SectionUnit {
    #[inline]
    fn in_tested_winds(&self, memory: &Memory) -> bool {
        let wind = self.wind_speed(memory);
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
            let wind = self.wind_speed(memory);
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
