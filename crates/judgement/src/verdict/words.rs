//! Words for speeds, reduced frequencies and readings.

use super::evidence::FlutterReading;
use crate::flutter::{FlutterSearch, shown_m_s};
use crate::units::ReducedFrequency;

/// A wind speed with its unit.
pub(super) fn speed(m_s: f64) -> String {
    format!("{} m/s", shown_m_s(m_s))
}

/// The same, or that there is none.
pub(super) fn speed_or_none(m_s: Option<f64>) -> String {
    m_s.map_or("none".to_owned(), speed)
}

/// Two reduced frequencies.
pub(super) fn k_range(from: ReducedFrequency, to: ReducedFrequency) -> String {
    format!("{:.2}–{:.2}", from.full_width(), to.full_width())
}

impl FlutterReading {
    /// `the model is`, `the models are`.
    pub(super) fn are(&self) -> String {
        let several = ["the models", "the tables"];
        let verb = match several.iter().any(|s| self.forces.starts_with(s)) {
            true => "are",
            false => "is",
        };
        format!("{} {verb}", self.forces)
    }

    /// What it found, with its ends.
    pub(super) fn found(&self) -> String {
        match &self.search {
            FlutterSearch::Onset(onset) => {
                let ends = onset.interval.ends();
                let ends = ends.map(|(a, b)| format!(" ({}–{})", shown_m_s(a), shown_m_s(b)));
                speed(onset.at.speed_m_s) + &onset.wide() + &ends.unwrap_or_default()
            }
            FlutterSearch::UnstableAtOrBelow(start) => {
                format!("unstable at and below {}", speed(start.at.speed_m_s))
            }
            FlutterSearch::StableUpTo(range) => range.explain(),
        }
    }
}
