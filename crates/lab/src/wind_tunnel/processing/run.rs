//! One run through all stages.

use super::coherent::{Parts, Regressors};
use super::options::ProcessingOptions;
use super::prepare::PreparedRun;
use super::report::{RemovedDrift, RunReport, SignalToNoise, StageLevels};
use super::rest::{RemovedMeans, remove_means, rest, still_the_rest};
use super::signals::{HarmonicSegment, SectionSignals};
use super::still_air::RemovedInertia;
use super::{cells, drift, index, low_pass, report, signals, spikes, still_air};
use crate::Error;
use crate::error::Result;
use crate::section::Dof;
use crate::signal::{ButterworthLowPass, delayed, extremes, largest_magnitude, root_mean_square};
use crate::wind_tunnel::{RawCampaign, RawRecording, Record, Rig};
use std::ops::Range;

/// Drag coefficient below which a drag upwind is no sign: thrust of a moving plate, rounding, a shift of the zero.
const LEAST_DRAG: f64 = 0.005;

/// Takes a prepared run through all stages: one record, or one per segment when ramps are cut, what was done, and the signals after each
/// stage.
pub(super) fn process_run(
    prepared: PreparedRun<'_>,
    campaign: &RawCampaign,
    dofs: &[Dof],
    lag_s: f64,
    options: &ProcessingOptions,
) -> Result<(Vec<Record>, RunReport, Vec<SectionSignals>)> {
    let raw = prepared.run;
    let mut run = RunInProgress::in_step(prepared, &campaign.rig, lag_s, options)?;
    run.remove_means();
    run.subtract_still_air()?;
    run.clean_and_filter()?;
    let (dof, segments) = (run.report.dof, &run.report.segments);
    let (width, negligible) = (campaign.rig.model_width_m, options.negligible_motion);
    run.report.cross_talk = still_the_rest(&mut run.signals, dof, segments, width, negligible);
    report::warn(&mut run.report, options)?;
    let (segments, ramps) = (&run.report.segments, options.segments.ramps);
    let records = signals::records(campaign, dofs, &run.signals, segments, raw, ramps);
    Ok((records, run.report, run.stages))
}

/// A run on its way: every stage changes the signals and enters in the report what it did.
struct RunInProgress<'a> {
    rig: &'a Rig,
    options: &'a ProcessingOptions,
    signals: SectionSignals,
    still_air: SectionSignals,
    /// Clipped stretches of both recordings.
    clipped: Vec<Range<usize>>,
    report: RunReport,
    stages: Vec<SectionSignals>,
}

impl<'a> RunInProgress<'a> {
    /// Stages 3 to 6: lag, drift of the cells, alignment, axes, cells. Both recordings in step, in global axes, about the centre of
    /// rotation.
    fn in_step(
        prepared: PreparedRun<'_>,
        rig: &'a Rig,
        lag_s: f64,
        options: &'a ProcessingOptions,
    ) -> Result<Self> {
        let (run, mut report) = (prepared.run, prepared.report);
        let dof = report.dof;
        let ready = |recording: &RawRecording, segments: &[HarmonicSegment], what: &str| {
            let mut recording = without_lag(recording, lag_s);
            let motion = still_air::from_rest(&recording.motion[index(dof)]);
            let rotation = motion_or_zeros(&recording, Dof::Torsion);
            let degree = options.drift_degree;
            let drift =
                drift::remove_cell_drift(&mut recording, rig, &motion, &rotation, segments, degree)
                    .map_err(|e| of_recording(e, &run.name, what))?;
            Ok::<_, Error>((recording, drift))
        };
        let (mut wind, cell_drift) = ready(&run.in_wind, &report.segments, "in wind")?;
        let (mut covered, mut still) = (0..wind.sample_count(), None);
        if let Some(recording) = &run.still_air {
            let (recording, _) = ready(recording, &prepared.still_segments, "still air")?;
            let (aligned, both, found) = still_air::align(&run.name, &wind, &recording, dof)?;
            (covered, report.alignment) = (both, Some(found));
            let within = |x: &[f64]| x[covered.clone()].to_vec();
            wind = wind.map(within);
            still = Some(aligned.map(within));
        }
        let (signals, cells) = on_the_model(&wind, rig);
        let still_air = match still {
            Some(still) => on_the_model(&still, rig).0,
            None => SectionSignals {
                force: signals.force.each_ref().map(|f| vec![0.0; f.len()]),
                ..signals.clone()
            },
        };
        let segments = report.covered_segments(&covered)?;
        let mut pairs = segments.iter().zip(&report.segments);
        if pairs.any(|(used, all)| used.plateau.samples < all.plateau.samples) {
            let Range { start, end } = covered;
            report.warnings.push(format!(
                "still air covers samples {start} to {end} of the motion in wind: only the whole periods in these are used"
            ));
        }
        report.cut = [covered.start, report.samples - covered.end];
        report.lag_corrected_s = lag_s;
        (report.segments, report.cells, report.cell_drift) = (segments, cells, cell_drift);
        let mut under_way = Self {
            rig,
            options,
            signals,
            still_air,
            clipped: report.clipped_ranges(&covered),
            report,
            stages: Vec::new(),
        };
        under_way.done("sum of the cells");
        Ok(under_way)
    }

    /// Levels and signals after a stage.
    fn done(&mut self, stage: &str) {
        let force = self.signals.force.each_ref();
        self.report.levels.push(StageLevels {
            stage: stage.to_owned(),
            peak: force.map(|f| largest_magnitude(f)),
            rms: force.map(|f| root_mean_square(f)),
        });
        self.stages.push(self.signals.clone());
    }

    /// Stage 7.
    fn remove_means(&mut self) {
        let (samples, at_rest) = rest(&self.report.segments, &self.signals);
        let in_wind = remove_means(&mut self.signals, &samples);
        let still_air = remove_means(&mut self.still_air, &samples);
        let static_wind = std::array::from_fn(|d| in_wind[d] - still_air[d]);
        let area = self.report.dimensionless.pressure_pa * self.rig.model_length_m;
        let width = self.rig.model_width_m;
        let coefficient = |d: usize| static_wind[d] / (area * Dof::THREE[d].force_scale(width));
        let drag = index(Dof::Lateral);
        // the cells may drift from one recording to the other as within one
        let drift = self.report.cell_drift.iter();
        let drift = drift.map(|c| c.range[..3].iter().fold(0.0, |m: f64, x| m.max(*x)));
        if -static_wind[drag] > drift.sum() && coefficient(drag) < -LEAST_DRAG {
            self.report.doubts.push(format!(
                "the wind pushes the model upwind, drag coefficient {:.3}: positive sway and drag are downwind",
                coefficient(drag)
            ));
        }
        self.report.means = RemovedMeans {
            in_wind,
            still_air,
            static_wind,
            static_coefficients: std::array::from_fn(coefficient),
            samples,
            at_rest,
        };
        self.done("means removed");
    }

    /// Stage 8.
    fn subtract_still_air(&mut self) -> Result<()> {
        let (signals, still_air) = (&mut self.signals, &self.still_air);
        let (segments, dof) = (&self.report.segments, index(self.report.dof));
        let mismatch = match self.report.alignment {
            Some(_) => still_air::mismatch(signals, still_air, segments, dof)?,
            None => RemovedInertia::default(),
        };
        self.report.inertia = still_air::subtract(signals, still_air, mismatch);
        self.done("still air subtracted");
        Ok(())
    }

    /// Stages 9 and 10, with what follows the motion over what is left on either side of the filter.
    fn clean_and_filter(&mut self) -> Result<()> {
        let RunReport { run, segments, .. } = &self.report;
        let rate = self.signals.sampling_hz;
        let designed = low_pass::design(run, &self.options.low_pass, segments, rate)?;
        let (filter, applied) = designed.unzip();
        let parts = self.clean(filter.as_ref())?;
        let ratio = |run: &Self| noise_ratio(&run.signals, &parts, &run.report.segments);
        let before_low_pass_db = ratio(self);
        if let Some(filter) = filter {
            let SectionSignals { motion, force, .. } = &mut self.signals;
            for channel in motion.iter_mut().chain(force) {
                *channel = filter.zero_phase(channel)?;
            }
            self.done("low-pass");
        }
        self.report.low_pass = applied;
        self.report.signal_to_noise = SignalToNoise {
            before_low_pass_db,
            after_low_pass_db: ratio(self),
        };
        Ok(())
    }

    /// Stage 9: spikes replaced, drift removed; what of the forces follows the motion.
    fn clean(&mut self, filter: Option<&ButterworthLowPass>) -> Result<[Parts; 3]> {
        let degree = self.options.drift_degree;
        let regressors = Regressors::new(
            &self.signals.motion[index(self.report.dof)],
            self.signals.sampling_hz,
            &self.report.segments,
            degree,
        );
        let (parts, replaced) = spikes::remove_spikes(
            &mut self.signals,
            &regressors,
            filter,
            &self.options.spikes,
            self.rig.model_width_m,
            &self.clipped,
        )
        .map_err(|e| of_recording(e, &self.report.run, "in wind"))?;
        self.report.replaced = replaced;
        self.done("spikes replaced");
        let range = std::array::from_fn(|d| {
            let drift = &parts[d].drift;
            let force = &mut self.signals.force[d];
            force.iter_mut().zip(drift).for_each(|(f, x)| *f -= x);
            let (low, high) = extremes(drift.iter().copied());
            high - low
        });
        self.report.drift = RemovedDrift { degree, range };
        self.done("drift removed");
        Ok(parts)
    }
}

/// An error of a computation, with the recording that it is of.
fn of_recording(error: Error, run: &str, what: &str) -> Error {
    match error {
        Error::Numerical(text) => Error::Numerical(format!("run {run}, {what}: {text}")),
        other => other,
    }
}

/// Force channels earlier by the lag.
fn without_lag(recording: &RawRecording, lag_s: f64) -> RawRecording {
    let earlier = -lag_s * recording.sampling_hz;
    let mut corrected = recording.clone();
    for channel in corrected.cells.iter_mut().flatten() {
        *channel = delayed(channel, earlier);
    }
    corrected
}

/// A motion of the model at each sample; zero where nobody measured it.
fn motion_or_zeros(recording: &RawRecording, dof: Dof) -> Vec<f64> {
    let x = &recording.motion[index(dof)];
    match x.is_empty() {
        true => vec![0.0; recording.sample_count()],
        false => x.clone(),
    }
}

/// Motion and force on the whole model, and the means of the cells.
fn on_the_model(recording: &RawRecording, rig: &Rig) -> (SectionSignals, Vec<cells::CellShare>) {
    let motion = Dof::THREE.map(|d| motion_or_zeros(recording, d));
    let rotation = &motion[index(Dof::Torsion)];
    let global = cells::to_global(recording, rig, rotation);
    let force = cells::sum_about_centre(&global, rig, rotation);
    let shares = cells::shares(&global, rig);
    let signals = SectionSignals {
        sampling_hz: recording.sampling_hz,
        motion,
        force,
    };
    (signals, shares)
}

/// Part that follows the motion over what is left, in the steady parts, dB.
fn noise_ratio(
    signals: &SectionSignals,
    parts: &[Parts; 3],
    segments: &[HarmonicSegment],
) -> [f64; 3] {
    std::array::from_fn(|d| {
        let steady = || segments.iter().flat_map(|s| s.plateau.range());
        let coherent: Vec<f64> = steady().map(|k| parts[d].coherent[k]).collect();
        let rest: Vec<f64> = steady()
            .map(|k| signals.force[d][k] - parts[d].coherent[k])
            .collect();
        let (signal, noise) = (root_mean_square(&coherent), root_mean_square(&rest));
        if signal > 0.0 && noise > 0.0 {
            20.0 * (signal / noise).log10()
        } else {
            0.0
        }
    })
}
