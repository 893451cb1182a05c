//! One run through all stages.

use super::cells::CellShare;
use super::coherent::{Parts, Regressors};
use super::drift::CellDrift;
use super::low_pass::AppliedLowPass;
use super::options::ProcessingOptions;
use super::prepare::Prepared;
use super::report::{DimensionlessFactors, RemovedDrift, RunReport, SignalToNoise, StageLevels};
use super::rest::{RemovedMeans, Rest, remove_means, rest, still_the_rest};
use super::signals::{HarmonicSegment, SectionSignals, level};
use super::still_air::Alignment;
use super::{cells, drift, index, low_pass, report, signals, spikes, still_air};
use crate::error::Result;
use crate::section::Dof;
use crate::signal::{ButterworthLowPass, delayed, extremes};
use crate::wind_tunnel::{RawCampaign, RawRecording, Record, Rig};
use std::ops::Range;

/// Force on the whole model after a stage, for figures.
#[derive(Debug, Clone, PartialEq)]
pub struct StageSignals {
    /// What has been done.
    pub stage: String,
    /// The signals.
    pub signals: SectionSignals,
}

/// One run, processed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ProcessedRun {
    /// One record, or one a segment when ramps are cut.
    pub records: Vec<Record>,
    /// What was done.
    pub report: RunReport,
    /// Signals after each stage.
    pub stages: Vec<StageSignals>,
}

/// Both recordings in step, in global axes, about the centre of rotation.
struct InStep {
    wind: SectionSignals,
    still_air: SectionSignals,
    shares: Vec<CellShare>,
    covered: Range<usize>,
    /// `None` without a recording in still air.
    alignment: Option<Alignment>,
    cell_drift: Vec<CellDrift>,
}

/// Takes a prepared run through all stages.
pub(super) fn process_run(
    prepared: &Prepared<'_>,
    campaign: &RawCampaign,
    dofs: &[Dof],
    lag_s: f64,
    options: &ProcessingOptions,
) -> Result<ProcessedRun> {
    let (run, rig) = (prepared.run, &campaign.rig);
    let InStep {
        wind: mut signals,
        still_air: mut still,
        shares,
        covered,
        alignment,
        cell_drift,
    } = in_step(prepared, rig, lag_s, options.drift_degree)?;
    let segments = prepared.covered_segments(&covered)?;
    let mut stages = Stages::default();
    stages.add("sum of the cells", &signals);
    let Rest {
        samples: range,
        at_rest,
    } = rest(&segments, &signals);
    let in_wind = remove_means(&mut signals, &range);
    let still_air = remove_means(&mut still, &range);
    stages.add("means removed", &signals);
    let inertia = still_air::subtract(&mut signals, &still);
    stages.add("still air subtracted", &signals);
    let rate = signals.sampling_hz;
    let filter = low_pass::design(&run.name, &options.low_pass, &segments, rate)?;
    let (parts, replaced, drift) = clean(
        &mut signals,
        &mut stages,
        Cleaning {
            driven: prepared.dof,
            segments: &segments,
            filter: filter.as_ref(),
            width_m: rig.model_width_m,
            clipped: &prepared.clipped(&covered, alignment.map_or(0.0, |a| a.offset_samples)),
            options,
        },
    )?;
    let before_low_pass_db = noise_ratio(&signals, &parts, &segments);
    if let Some((filter, _)) = &filter {
        low_pass::apply(&mut signals, filter)?;
        stages.add("low-pass", &signals);
    }
    let after_low_pass_db = noise_ratio(&signals, &parts, &segments);
    let cross_talk = still_the_rest(
        &mut signals,
        prepared.dof,
        &segments,
        rig.model_width_m,
        options.negligible_motion,
    );
    let pressure = 0.5 * run.air_density_kg_m3 * run.mean_speed_m_s.powi(2);
    let static_wind = std::array::from_fn(|d| in_wind[d] - still_air[d]);
    let coefficient = |d: usize| {
        let area = pressure * rig.model_length_m;
        static_wind[d] / (area * Dof::THREE[d].force_scale(rig.model_width_m))
    };
    let findings = &prepared.findings;
    let mut report = RunReport {
        run: run.name.clone(),
        dof: prepared.dof,
        sampling_hz: rate,
        samples: run.in_wind.len(),
        cut: [covered.start, run.in_wind.len() - covered.end],
        clipped: [
            findings.clipped_in_wind.clone(),
            findings.clipped_still_air.clone(),
        ]
        .concat(),
        segments: segments.clone(),
        still_air: prepared.still_air.clone(),
        lag_corrected_s: lag_s,
        alignment,
        cells: shares,
        means: RemovedMeans {
            in_wind,
            still_air,
            static_wind,
            static_coefficients: std::array::from_fn(coefficient),
            samples: range,
            at_rest,
        },
        inertia,
        replaced,
        cell_drift,
        drift,
        low_pass: filter.map(|f| f.1),
        cross_talk,
        signal_to_noise: SignalToNoise {
            before_low_pass_db,
            after_low_pass_db,
        },
        dimensionless: DimensionlessFactors {
            speed_m_s: run.mean_speed_m_s,
            air_density_kg_m3: run.air_density_kg_m3,
            pressure_pa: pressure,
            delta_s: run.mean_speed_m_s / (rig.model_width_m * rate),
        },
        levels: stages.levels,
        warnings: findings.warnings.clone(),
    };
    report::warn(&mut report, options);
    Ok(ProcessedRun {
        records: signals::records(
            campaign,
            dofs,
            &signals,
            &segments,
            run,
            options.segments.ramps,
        ),
        report,
        stages: stages.signals,
    })
}

/// Stages 3 to 6: lag, drift of the cells, alignment, axes, cells.
fn in_step(prepared: &Prepared<'_>, rig: &Rig, lag_s: f64, degree: usize) -> Result<InStep> {
    let run = prepared.run;
    let ready = |recording: &RawRecording, segments: &[HarmonicSegment]| {
        let mut recording = without_lag(recording, lag_s);
        let motion = still_air::from_rest(&recording.motion[index(prepared.dof)]);
        let rotation = rotation(&recording);
        let drift =
            drift::remove_cell_drift(&mut recording, rig, &motion, &rotation, segments, degree)?;
        Ok::<_, crate::Error>((recording, drift))
    };
    let (wind, cell_drift) = ready(&run.in_wind, &prepared.segments)?;
    let Some(still) = &run.still_air else {
        let (wind, shares) = on_the_model(&wind, rig);
        let nothing = wind.force.each_ref().map(|f| vec![0.0; f.len()]);
        return Ok(InStep {
            still_air: SectionSignals {
                force: nothing,
                ..wind.clone()
            },
            covered: 0..wind.len(),
            wind,
            shares,
            alignment: None,
            cell_drift,
        });
    };
    let (still, _) = ready(still, &prepared.still_segments)?;
    let aligned = still_air::align(&run.name, &wind, &still, prepared.dof)?;
    let covered = aligned.covered;
    let (wind, shares) = on_the_model(&wind.map(|x| x[covered.clone()].to_vec()), rig);
    let (still_air, _) = on_the_model(&aligned.still_air.map(|x| x[covered.clone()].to_vec()), rig);
    Ok(InStep {
        wind,
        still_air,
        shares,
        covered,
        alignment: Some(aligned.alignment),
        cell_drift,
    })
}

/// What the search for spikes and drift needs besides the signals.
struct Cleaning<'a> {
    driven: Dof,
    segments: &'a [HarmonicSegment],
    filter: Option<&'a (ButterworthLowPass, AppliedLowPass)>,
    width_m: f64,
    clipped: &'a [Range<usize>],
    options: &'a ProcessingOptions,
}

/// Stage 9: spikes replaced, drift removed.
fn clean(
    signals: &mut SectionSignals,
    stages: &mut Stages,
    how: Cleaning<'_>,
) -> Result<([Parts; 3], Vec<spikes::Replaced>, RemovedDrift)> {
    let degree = how.options.drift_degree;
    let regressors = Regressors::new(
        &signals.motion[index(how.driven)],
        signals.sampling_hz,
        how.segments,
        degree,
    );
    let cleaned = spikes::remove_spikes(
        signals,
        &regressors,
        how.filter.map(|f| &f.0),
        &how.options.spikes,
        how.width_m,
        how.clipped,
    )?;
    stages.add("spikes replaced", signals);
    let range = std::array::from_fn(|d| {
        let drift = &cleaned.parts[d].drift;
        let force = &mut signals.force[d];
        force.iter_mut().zip(drift).for_each(|(f, x)| *f -= x);
        let (low, high) = extremes(drift.iter().copied());
        high - low
    });
    stages.add("drift removed", signals);
    Ok((
        cleaned.parts,
        cleaned.replaced,
        RemovedDrift { degree, range },
    ))
}

/// Levels and signals after each stage.
#[derive(Default)]
struct Stages {
    levels: Vec<StageLevels>,
    signals: Vec<StageSignals>,
}

impl Stages {
    fn add(&mut self, stage: &str, signals: &SectionSignals) {
        self.levels.push(StageLevels::of(stage, signals));
        self.signals.push(StageSignals {
            stage: stage.to_owned(),
            signals: signals.clone(),
        });
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

/// Rotation of the model at each sample, rad; zero where nobody measured it.
fn rotation(recording: &RawRecording) -> Vec<f64> {
    let x = &recording.motion[index(Dof::Torsion)];
    if x.is_empty() {
        vec![0.0; recording.len()]
    } else {
        x.clone()
    }
}

/// Motion and force on the whole model, and the means of the cells.
fn on_the_model(recording: &RawRecording, rig: &Rig) -> (SectionSignals, Vec<cells::CellShare>) {
    let count = recording.len();
    let motion: [Vec<f64>; 3] = std::array::from_fn(|d| {
        let x = &recording.motion[d];
        if x.is_empty() {
            vec![0.0; count]
        } else {
            x.clone()
        }
    });
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
        let (signal, noise) = (level(&coherent).rms, level(&rest).rms);
        if signal > 0.0 && noise > 0.0 {
            20.0 * (signal / noise).log10()
        } else {
            0.0
        }
    })
}
