//! What a search by stepping is asked, and what it answers.

use crate::error::{Result, ensure, positive};
use crate::flutter::StableRange;
use serde::Serialize;

/// Where to look and how to step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteppingSearch {
    /// Wind speed from which on is searched, m/s; where the section grows there already, the search goes down.
    pub speed_min_m_s: f64,
    /// Highest wind speed, m/s.
    pub speed_max_m_s: f64,
    /// Number of intervals in which the first change of sign is looked for.
    pub intervals: usize,
    /// Communication step, s; several to a period of the fastest mode.
    pub communication_step_s: f64,
    /// Relative width of the bracket at which the search ends.
    pub tolerance: f64,
}

impl SteppingSearch {
    /// Between two wind speeds in ten intervals, to 1e-6.
    pub fn between(speed_min_m_s: f64, speed_max_m_s: f64, communication_step_s: f64) -> Self {
        Self {
            speed_min_m_s,
            speed_max_m_s,
            intervals: 10,
            communication_step_s,
            tolerance: 1e-6,
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        positive("speed_min_m_s", self.speed_min_m_s)?;
        positive("communication_step_s", self.communication_step_s)?;
        positive("tolerance", self.tolerance)?;
        ensure(
            self.speed_max_m_s.is_finite() && self.speed_max_m_s > self.speed_min_m_s,
            "speed_max_m_s",
            format_args!("a finite number above {}", self.speed_min_m_s),
            self.speed_max_m_s,
        )
    }
}

/// Growth at one wind speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GrowthPoint {
    /// Wind speed, m/s.
    pub speed_m_s: f64,
    /// Growth rate of the dominant mode, 1/s; negative when it decays.
    pub growth_rate_per_s: f64,
    /// Its frequency, Hz.
    pub frequency_hz: f64,
}

/// An onset found by stepping.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GrowthOnset {
    /// Wind speed at which the growth rate is zero, m/s.
    pub speed_m_s: f64,
    /// Frequency there, Hz.
    pub frequency_hz: f64,
    /// `|y|/(B|θ|)`, if the FMU has a variable `width`.
    pub mode_ratio: Option<f64>,
    /// Phase of `y` relative to `θ`, degrees in (−180, 180].
    pub phase_deg: f64,
    /// Communication step, s.
    pub communication_step_s: f64,
    /// All speeds that were run, in ascending order.
    pub growth: Vec<GrowthPoint>,
    /// Communication steps done in all.
    pub steps: usize,
}

/// Answer of the search.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SteppedSearch {
    /// The section flutters.
    Onset(Box<GrowthOnset>),
    /// Growth at the lowest speed that was stepped.
    UnstableAtOrBelow(GrowthPoint),
    /// No growth of an oscillation between these speeds.
    StableUpTo(StableRange),
}

impl SteppedSearch {
    /// The onset, if there is one.
    pub fn onset(&self) -> Option<&GrowthOnset> {
        match self {
            Self::Onset(onset) => Some(onset),
            Self::UnstableAtOrBelow(_) | Self::StableUpTo(_) => None,
        }
    }
}
