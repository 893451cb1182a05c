//! Words for speeds, reduced frequencies and readings.

use super::evidence::FlutterReading;
use crate::flutter::{FlutterSearch, shown_m_s};
use crate::units::ReducedFrequency;

/// A wind speed with its unit.
pub(super) fn speed(m_s: f64) -> String {
    format!("{} m/s", shown_m_s(m_s))
}

/// Two reduced frequencies.
pub(super) fn k_range(from: ReducedFrequency, to: ReducedFrequency) -> String {
    format!("{:.2}–{:.2}", from.full_width(), to.full_width())
}

impl FlutterReading {
    /// `the model is`, `the models are`.
    pub(super) fn are(&self) -> String {
        let verb =
            match self.forces.starts_with("the models") || self.forces.starts_with("the tables") {
                true => "are",
                false => "is",
            };
        format!("{} {verb}", self.forces)
    }
}

/// What a reading found, with its ends.
pub(super) fn found(reading: &FlutterReading) -> String {
    match &reading.search {
        FlutterSearch::Onset(onset) => match onset.interval.ends() {
            Some((low, high)) => format!(
                "{} ({}–{})",
                speed(onset.at.speed_m_s),
                shown_m_s(low),
                shown_m_s(high)
            ),
            None => speed(onset.at.speed_m_s),
        },
        FlutterSearch::UnstableAtOrBelow(start) => {
            format!("unstable at and below {}", speed(start.at.speed_m_s))
        }
        FlutterSearch::StableUpTo(range) => range.explain(),
    }
}
