//! A band of wind speeds in which something grows.

use super::mode_words::mode_in_words;
use crate::units::ReducedFrequency;
use serde::{Deserialize, Serialize};

/// A band of wind speeds in which an oscillating eigenvalue has a positive real part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GrowthBand {
    /// Lowest speed with growth, m/s.
    pub from_m_s: f64,
    /// Highest speed with growth, m/s; the end of the scan where it goes on.
    pub to_m_s: f64,
    /// Whether there is growth at the lowest speed of the scan already, so that the band begins there or below.
    pub from_start: bool,
    /// Fastest growth rate that was met in the band, 1/s.
    pub fastest_growth_per_s: f64,
    /// Speed of the fastest growth, m/s.
    pub fastest_at_m_s: f64,
    /// Frequency of the fastest growth, Hz.
    pub frequency_hz: f64,
    /// `K` of the fastest growth.
    pub reduced_frequency: ReducedFrequency,
    /// Lowest speed of the band at which a motion with `K` inside the tested range grows, m/s; that of the band itself
    /// where there is no such range, `None` where nothing grows inside.
    pub tested_from_m_s: Option<f64>,
    /// Name of the structural mode with the fastest growth; `aerodynamic` for an eigenvalue of the force model itself.
    pub branch: String,
}

impl GrowthBand {
    /// Whether all growth of the band lies outside the tested range: the model extrapolates there.
    pub fn extrapolated(&self) -> bool {
        self.tested_from_m_s.is_none()
    }

    /// The band in words.
    pub fn explain(&self) -> String {
        let tested = match self.extrapolated() {
            true => ", outside the tested range",
            false => "",
        };
        let below = if self.from_start { "at or below " } else { "" };
        format!(
            "grows from {below}{:.3} to {:.3} m/s, by {:.4} 1/s at {:.3} m/s ({}, {:.4} Hz, K {:.3}{tested})",
            self.from_m_s,
            self.to_m_s,
            self.fastest_growth_per_s,
            self.fastest_at_m_s,
            mode_in_words(&self.branch),
            self.frequency_hz,
            self.reduced_frequency.full_width(),
        )
    }
}
