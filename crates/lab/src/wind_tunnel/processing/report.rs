//! What processing did, in numbers, and what the user should know of a run that could be processed.

use super::body::StillAirInertia;
use super::cells::CellShare;
use super::drift::CellDrift;
use super::low_pass::AppliedLowPass;
use super::options::ProcessingOptions;
use super::rest::{CrossTalk, RemovedMeans};
use super::segmentation::is_near;
use super::signals::{HarmonicSegment, highest_hz};
use super::spikes::{CLIPPED, Replaced};
use super::still_air::{Alignment, RemovedInertia};
use crate::error::{Result, ensure};
use crate::section::Dof;
use crate::wind_tunnel::{RawRun, Rig};
use serde::{Deserialize, Serialize};

/// A stretch in which a channel stood at its limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClippedStretch {
    /// Channel, with the recording it is of.
    pub channel: String,
    /// First sample.
    pub first: usize,
    /// Number of samples.
    pub samples: usize,
}

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
    /// What contradicts what is stated, or another run: nothing may rest on the run before it is cleared.
    #[serde(default)]
    pub doubts: Vec<String>,
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
    /// Every warning with its run, and stated frequencies that no run has.
    pub fn warnings(&self) -> Vec<String> {
        let of_runs = self.of_runs(|r| &r.warnings);
        let found = |f: &f64| {
            let mut segments = self.runs.iter().flat_map(|r| &r.segments);
            segments.any(|s| is_near(s.segment.frequency_hz, *f))
        };
        let stated = self.options.segments.frequencies_hz.iter();
        let lost = stated.filter(|f| !found(f));
        let lost = lost.map(|f| format!("no run moves at the stated {f} Hz"));
        of_runs.into_iter().chain(lost).collect()
    }

    /// Every doubt with its run.
    pub fn doubts(&self) -> Vec<String> {
        self.of_runs(|r| &r.doubts)
    }

    fn of_runs(&self, texts: impl Fn(&RunReport) -> &[String]) -> Vec<String> {
        let of_run = |r: &RunReport, text: &String| format!("run {}: {text}", r.run);
        let runs = self.runs.iter();
        runs.flat_map(|r| texts(r).iter().map(move |text| of_run(r, text)))
            .collect()
    }
}

/// A lag of one run is off that of the campaign when it is this many standard errors and a fiftieth of a sample away.
const LAG_OFF: (f64, f64) = (5.0, 0.02);
/// Phase by which a lag may turn the highest frequency of a run, degrees: beyond the one it is a doubt, beyond the other it is
/// refused, unless the lag is stated.
pub(super) const LAG_TURNS: (f64, f64) = (2.0, 5.0);
/// What is left of the inertia because the motion in still air was another one, over the force that is left: from the first on it is said,
/// from the second on it is a doubt.
const INERTIA_LEFT: [f64; 2] = [0.005, 0.02];

impl RunReport {
    /// Before anything is done, of a run in which `dof` moves.
    pub(super) fn new(run: &RawRun, rig: &Rig, dof: Dof) -> Self {
        let (density, speed) = (run.air_density_kg_m3, run.mean_speed_m_s);
        let sampling_hz = run.in_wind.sampling_hz;
        Self {
            run: run.name.clone(),
            dof,
            sampling_hz,
            samples: run.in_wind.sample_count(),
            cut: [0; 2],
            clipped: Vec::new(),
            segments: Vec::new(),
            still_air: None,
            lag_corrected_s: 0.0,
            alignment: None,
            cells: Vec::new(),
            means: RemovedMeans::default(),
            inertia: RemovedInertia::default(),
            replaced: Vec::new(),
            cell_drift: Vec::new(),
            drift: RemovedDrift::default(),
            low_pass: None,
            cross_talk: CrossTalk::default(),
            signal_to_noise: SignalToNoise::default(),
            dimensionless: DimensionlessFactors {
                speed_m_s: speed,
                air_density_kg_m3: density,
                pressure_pa: 0.5 * density * speed.powi(2),
                delta_s: speed / (rig.model_width_m * sampling_hz),
            },
            levels: Vec::new(),
            warnings: Vec::new(),
            doubts: Vec::new(),
        }
    }

    /// Says where still air moved otherwise than wind, in amplitude or because its clock went otherwise.
    fn say_what_inertia_is_left(&mut self) {
        let [told, grave] = INERTIA_LEFT;
        let left = self.inertia.left_in_force;
        if left <= told {
            return;
        }
        let what = format!(
            "the motion in still air differs by {:.2} % from that in wind (in wind {:.4} times the amplitude): inertia of {:.1} % of the force is \
             left in it",
            100.0 * self.inertia.motion_mismatch,
            self.alignment.map_or(1.0, |a| a.amplitude_ratio),
            100.0 * left
        );
        match left > grave {
            true => self.doubts.push(what),
            false => self.warnings.push(what),
        }
    }

    /// Says what the lag that the inertia of this run shows is: nothing where it is the one that was corrected.
    fn say_lag(&mut self, found: &StillAirInertia, is_stated: bool) -> Result<()> {
        let off = (found.lag_s - self.lag_corrected_s).abs();
        let (errors, samples) = LAG_OFF;
        if off <= errors * found.lag_standard_error_s || off * self.sampling_hz <= samples {
            return Ok(());
        }
        let highest = highest_hz(&self.segments);
        let turned = 360.0 * highest * off;
        let (grave, most) = LAG_TURNS;
        let corrected = 1e3 * self.lag_corrected_s;
        let own = format!(
            "a lag of {:.3} ms, {turned:.1}° of phase off at {highest:.3} Hz",
            1e3 * found.lag_s
        );
        // of one frequency, damping looks like a lag
        let may_be_damping = found.damping.is_none();
        if may_be_damping && turned <= grave {
            return Ok(());
        }
        ensure(
            is_stated || may_be_damping || turned <= most,
            format_args!("run {}, still air", self.run),
            format_args!(
                "the {corrected:.3} ms by which the force channels of all runs lag, to {most}° of phase (or a stated `lag_s`)"
            ),
            &own,
        )?;
        let (or, unless) = match may_be_damping {
            true => (", or damping", "unless that is damping, "),
            false => ("", ""),
        };
        let what = format!("its own inertia says {own}{or}; {corrected:.3} ms were corrected");
        match turned > grave && !(is_stated && may_be_damping) {
            true => self.doubts.push(format!(
                "{what}: {unless}its derivatives are wrong by as much"
            )),
            false => self.warnings.push(what),
        }
        Ok(())
    }
}

/// Warnings from the figures of the report, besides those that are in it.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) naming the run, of a lag that is not that of the others.
pub(super) fn warn(report: &mut RunReport, options: &ProcessingOptions) -> Result<()> {
    let mut warnings = Vec::new();
    if report.segments.is_empty() {
        warnings.push("no stretch of harmonic motion: no test points".into());
    }
    match report.still_air.clone() {
        Some(s) if s.tells_lag(report.sampling_hz) => {
            report.say_lag(&s, options.lag_s.is_some())?;
        }
        // what hides the weight has its own words
        Some(s) if s.hides_weight() => {}
        _ if options.lag_s.is_none() && report.alignment.is_some() => warnings
            .push("the inertia in still air is too small to tell the lag of the channels".into()),
        _ => {}
    }
    report.say_what_inertia_is_left();
    warnings.extend(report.low_pass.as_ref().and_then(|l| l.warning()));
    // what is clipped is said of its channel
    let others = report.replaced.iter().filter(|r| r.reason != CLIPPED);
    for r in others {
        let (first, last) = (r.first, r.first + r.samples - 1);
        let (start_s, reason) = (r.start_s, &r.reason);
        warnings.push(format!(
            "samples {first} to {last} ({start_s:.2} s) replaced: {reason}"
        ));
    }
    report.warnings.extend(warnings);
    Ok(())
}
