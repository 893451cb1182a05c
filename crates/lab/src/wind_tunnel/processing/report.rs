//! What processing did, in numbers, and what the user should know of a run that could be processed.

use super::body::StillAirInertia;
use super::cells::CellShare;
use super::check::ClippedStretch;
use super::drift::CellDrift;
use super::low_pass::AppliedLowPass;
use super::options::ProcessingOptions;
use super::rest::{CrossTalk, RemovedMeans};
use super::signals::{HarmonicSegment, Level, SectionSignals, level};
use super::spikes::Replaced;
use super::still_air::{Alignment, RemovedInertia};
use crate::section::Dof;
use crate::wind_tunnel::{RawRun, Rig};
use serde::{Deserialize, Serialize};

/// Force on the whole model after a stage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageLevels {
    /// What has been done.
    pub stage: String,
    /// Greatest absolute lift (N), drag (N), moment (N·m).
    pub peak: [f64; 3],
    /// Root mean square of the same.
    pub rms: [f64; 3],
}

impl StageLevels {
    pub(super) fn new(stage: &str, signals: &SectionSignals) -> Self {
        let levels: [Level; 3] = std::array::from_fn(|d| level(&signals.force[d]));
        Self {
            stage: stage.to_owned(),
            peak: levels.map(|l| l.peak),
            rms: levels.map(|l| l.rms),
        }
    }
}

/// What drift was taken for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct RemovedDrift {
    /// Degree of the polynomial.
    pub degree: usize,
    /// Greatest minus least value over the recording: N, N, N·m.
    pub range: [f64; 3],
}

/// Force that follows the motion against what is left, over the steady parts of the segments, dB: lift, drag, moment.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct SignalToNoise {
    /// Before the low-pass.
    pub before_low_pass_db: [f64; 3],
    /// Behind the low-pass.
    pub after_low_pass_db: [f64; 3],
}

/// Factors of the dimensionless form.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DimensionlessFactors {
    /// Mean wind speed V, m/s.
    pub speed_m_s: f64,
    /// Air density ρ, kg/m³.
    pub air_density_kg_m3: f64,
    /// `½ρV²`, Pa.
    pub pressure_pa: f64,
    /// `Δs = VΔt/B` of the record.
    pub delta_s: f64,
}

impl DimensionlessFactors {
    pub(super) fn new(run: &RawRun, rig: &Rig) -> Self {
        Self {
            speed_m_s: run.mean_speed_m_s,
            air_density_kg_m3: run.air_density_kg_m3,
            pressure_pa: 0.5 * run.air_density_kg_m3 * run.mean_speed_m_s.powi(2),
            delta_s: run.mean_speed_m_s / (rig.model_width_m * run.in_wind.sampling_hz),
        }
    }
}

/// Everything that was done to one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunReport {
    /// Name of the run.
    pub run: String,
    /// Degree of freedom that moved.
    pub dof: Dof,
    /// Sampling frequency, Hz.
    pub sampling_hz: f64,
    /// Samples of the recording in wind.
    pub samples: usize,
    /// Samples at its beginning and end that the still-air recording does not cover.
    pub cut: [usize; 2],
    /// Stretches at the limit of a channel.
    pub clipped: Vec<ClippedStretch>,
    /// Test points found in the motion.
    pub segments: Vec<HarmonicSegment>,
    /// Lag and inertia found in still air; `None` when nothing tells them.
    pub still_air: Option<StillAirInertia>,
    /// Lag that was corrected, s.
    pub lag_corrected_s: f64,
    /// Alignment of the still-air recording; `None` without one.
    pub alignment: Option<Alignment>,
    /// Means of the cells in wind, global axes.
    pub cells: Vec<CellShare>,
    /// Means that were removed.
    pub means: RemovedMeans,
    /// What the still-air recording took away.
    pub inertia: RemovedInertia,
    /// Samples replaced, with place and reason.
    pub replaced: Vec<Replaced>,
    /// Drift that was removed from the cells in wind, in their own axes.
    pub cell_drift: Vec<CellDrift>,
    /// What drift was left and removed from the whole.
    pub drift: RemovedDrift,
    /// The low-pass, if any.
    pub low_pass: Option<AppliedLowPass>,
    /// Motions that nobody drives.
    pub cross_talk: CrossTalk,
    /// Signal and noise.
    pub signal_to_noise: SignalToNoise,
    /// Factors of the dimensionless form.
    pub dimensionless: DimensionlessFactors,
    /// Force after each stage.
    pub levels: Vec<StageLevels>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// What processing did to a campaign.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProcessingReport {
    /// Name of the section.
    pub section: String,
    /// Choices that were made.
    pub options: ProcessingOptions,
    /// Lag of the force channels that was corrected in all runs, s.
    pub lag_s: f64,
    /// Its standard error, s; `None` when it was stated, or could not be estimated.
    pub lag_standard_error_s: Option<f64>,
    /// Longest `Δs`, to which a discrete model resamples.
    pub common_delta_s: f64,
    /// The runs, in the order of the campaign.
    pub runs: Vec<RunReport>,
}

impl ProcessingReport {
    /// Every warning with its run.
    pub fn warnings(&self) -> Vec<String> {
        self.runs
            .iter()
            .flat_map(|r| {
                r.warnings
                    .iter()
                    .map(move |w| format!("run {}: {w}", r.run))
            })
            .collect()
    }
}

/// A lag of one run is off that of the campaign when it is this many standard errors and a fiftieth of a sample away.
const LAG_OFF: (f64, f64) = (5.0, 0.02);
/// Amplitudes in wind and in still air may differ by this fraction without a warning.
const SAME_AMPLITUDE: f64 = 0.01;

/// Warnings from the figures of the report, besides those that are in it.
pub(super) fn warn(report: &mut RunReport, options: &ProcessingOptions) {
    let mut warnings = Vec::new();
    if report.segments.is_empty() {
        warnings.push("no stretch of harmonic motion: no test points".into());
    }
    let rate = report.sampling_hz;
    match &report.still_air {
        Some(s) if s.tells_lag(rate) => {
            let off = (s.lag_s - report.lag_corrected_s).abs();
            let (errors, samples) = LAG_OFF;
            if off > errors * s.lag_standard_error_s && off * rate > samples {
                warnings.push(format!(
                    "its own inertia says a lag of {:.3} ms, {:.3} ms were corrected",
                    1e3 * s.lag_s,
                    1e3 * report.lag_corrected_s
                ));
            }
        }
        _ if options.lag_s.is_none() && report.alignment.is_some() => warnings
            .push("the inertia in still air is too small to tell the lag of the channels".into()),
        _ => {}
    }
    let ratio = report.alignment.map_or(1.0, |a| a.amplitude_ratio);
    if (ratio - 1.0).abs() > SAME_AMPLITUDE {
        warnings.push(format!(
            "the motion in wind is {ratio:.4} times that in still air: inertia is not removed exactly"
        ));
    }
    warnings.extend(report.low_pass.as_ref().and_then(|l| l.warning()));
    for r in &report.replaced {
        warnings.push(format!(
            "samples {} to {} ({:.2} s) replaced: {}",
            r.first,
            r.first + r.samples - 1,
            r.start_s,
            r.reason
        ));
    }
    report.warnings.extend(warnings);
}
