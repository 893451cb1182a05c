//! The truth behind a virtual campaign.

use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// One entry of the transfer matrix at one test point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TruthPoint {
    /// Name of the run.
    pub run: String,
    /// Frequency of motion, Hz.
    pub frequency_hz: f64,
    /// Reduced frequency `K = ωB/V`.
    pub k: f64,
    /// Force: row of `G`.
    pub force: Dof,
    /// Motion: column of `G`.
    pub motion: Dof,
    /// Real part of the entry.
    pub real: f64,
    /// Imaginary part of the entry.
    pub imaginary: f64,
}

/// What was applied to one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AppliedDisturbances {
    /// Name of the run.
    pub run: String,
    /// Mean load of the wind on the whole model: drag N, lift N, nose-up moment N·m.
    pub static_wind: [f64; 3],
    /// Standard deviation of the noise of the sum of the cells: drag N, lift N, nose-up moment about the centre of
    /// rotation N·m.
    pub noise: [f64; 3],
    /// Force channels are late by this against the motion, s.
    pub force_lag_s: f64,
    /// The still-air recording is late by this against the one in wind, s.
    pub still_air_offset_s: f64,
    /// The spike in wind.
    pub spike: Option<AppliedSpike>,
}

/// Where a spike stands.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AppliedSpike {
    /// First sample that differs.
    pub first: usize,
    /// Number of samples that differ.
    pub samples: usize,
    /// Greatest height on the whole model: drag N, lift N, nose-up moment N·m.
    pub height: [f64; 3],
}
