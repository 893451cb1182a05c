//! What may be chosen in processing, and the defaults with their reasons.

use crate::error::{Result, ensure, finite, non_negative, positive};
use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// How raw runs become records.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ProcessingOptions {
    /// Degrees of freedom of the records; left out, heave and rotation, and sway too when a run moves it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dofs: Option<Vec<Dof>>,
    /// Lag of the force channels behind the motion, s. Left out it is estimated from the inertia in still air, one value
    /// for the campaign, since it is a property of the wiring; 0 switches the correction off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lag_s: Option<f64>,
    /// Degree of the polynomial that is taken for drift over a whole recording; default 4: half a wave over the
    /// recording to 1e-3 of its height, and nothing that could take a period of the slowest motion away.
    pub drift_degree: usize,
    /// A motion that nobody drives is set to zero when its RMS is below this part of the driven one, both without dimensions;
    /// default 0.01: it is noise of the sensor, or too little to learn from.
    pub negligible_motion: f64,
    /// The low-pass; left out, the default.
    pub low_pass: LowPassOptions,
    /// Finding the stretches of harmonic motion.
    pub segments: SegmentOptions,
    /// Finding spikes.
    pub spikes: SpikeOptions,
}

/// Zero-phase Butterworth low-pass, the same on motion and force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LowPassOptions {
    /// Order of one passage, as in NTNU's processing 6; 0 for no filter.
    pub order: usize,
    /// Cut-off, Hz; left out, 2.8 times the highest frequency of motion (7 Hz at 2.5 Hz, as in NTNU's processing): what
    /// is lost at that frequency, 2e-6, is lost by motion and force alike.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cutoff_hz: Option<f64>,
}

/// What becomes of the ramps of a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ramps {
    /// One record per run, from rest to rest: models with memory see how every motion began.
    Keep,
    /// One record per segment, whole periods at full amplitude.
    Cut,
}

/// Segmentation by the frequency of excitation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SegmentOptions {
    /// Frequencies that were driven, Hz; a stretch at any other (more than 5 % off) is no test point. Empty: every steady
    /// frequency found in the motion is one.
    pub frequencies_hz: Vec<f64>,
    /// A period belongs to the steady part when its amplitude is at least this part of the typical one; default 0.99.
    pub full_amplitude: f64,
    /// Whether ramps stay in the records; default [`Ramps::Keep`].
    pub ramps: Ramps,
}

/// Spikes in the residual from what follows the motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SpikeOptions {
    /// A sample is an outlier when its residual exceeds this many robust standard deviations (of the segment), default 6: of
    /// 40 000 normal samples none is; 0 switches the search off.
    pub deviations: f64,
    /// … and this part of the greatest force that follows the motion in the segment, default 0.25: the ramps of a force with
    /// memory are no spikes in a noiseless record.
    pub least_part: f64,
    /// Time before and after an outlier that goes with it, s; default 0.1: the model rings for a while after a knock.
    pub guard_s: f64,
}

impl Default for ProcessingOptions {
    fn default() -> Self {
        Self {
            dofs: None,
            lag_s: None,
            drift_degree: 4,
            negligible_motion: 0.01,
            low_pass: LowPassOptions::default(),
            segments: SegmentOptions::default(),
            spikes: SpikeOptions::default(),
        }
    }
}

impl Default for LowPassOptions {
    fn default() -> Self {
        Self {
            order: 6,
            cutoff_hz: None,
        }
    }
}

impl Default for SegmentOptions {
    fn default() -> Self {
        Self {
            frequencies_hz: Vec::new(),
            full_amplitude: 0.99,
            ramps: Ramps::Keep,
        }
    }
}

impl Default for SpikeOptions {
    fn default() -> Self {
        Self {
            deviations: 6.0,
            least_part: 0.25,
            guard_s: 0.1,
        }
    }
}

/// Highest degree of the drift: beyond it a polynomial follows the slow motions.
const DRIFT_DEGREE_AT_MOST: usize = 12;

impl ProcessingOptions {
    /// Checks every number.
    pub fn validate(&self) -> Result<()> {
        if let Some(dofs) = &self.dofs {
            let once = (1..dofs.len()).all(|i| !dofs[..i].contains(&dofs[i]));
            let found = match dofs.is_empty() {
                true => "none".to_owned(),
                false => Dof::names(dofs),
            };
            let any_once = once && !dofs.is_empty();
            let expected = "each at most once, at least one";
            ensure(any_once, "processing.dofs", expected, found)?;
        }
        finite("processing.lag_s", self.lag_s.unwrap_or(0.0))?;
        let degree = self.drift_degree;
        let expected = format_args!("at most {DRIFT_DEGREE_AT_MOST}");
        let fits = degree <= DRIFT_DEGREE_AT_MOST;
        ensure(fits, "processing.drift_degree", expected, degree)?;
        if let Some(cutoff) = self.low_pass.cutoff_hz {
            positive("processing.low_pass.cutoff_hz", cutoff)?;
        }
        for f in &self.segments.frequencies_hz {
            positive("processing.segments.frequencies_hz", *f)?;
        }
        let share = self.segments.full_amplitude;
        let place = "processing.segments.full_amplitude";
        ensure(share > 0.0 && share < 1.0, place, "between 0 and 1", share)?;
        let s = &self.spikes;
        for (key, value) in [
            ("negligible_motion", self.negligible_motion),
            ("spikes.deviations", s.deviations),
            ("spikes.least_part", s.least_part),
            ("spikes.guard_s", s.guard_s),
        ] {
            non_negative(format_args!("processing.{key}"), value)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_numbers_name_their_key() {
        let mut options = ProcessingOptions::default();
        assert!(options.validate().is_ok());
        options.low_pass.cutoff_hz = Some(-1.0);
        let message = options.validate().unwrap_err().to_string();
        assert!(
            message.starts_with("processing.low_pass.cutoff_hz"),
            "{message}"
        );
        options = ProcessingOptions::default();
        options.dofs = Some(vec![Dof::Torsion, Dof::Torsion]);
        assert!(options.validate().is_err());
        options = ProcessingOptions::default();
        options.segments.full_amplitude = 1.0;
        assert!(options.validate().is_err());
    }
}
