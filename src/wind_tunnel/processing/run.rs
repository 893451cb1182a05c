//! One run through all stages.

use super::check::{Findings, check_run};
use super::coherent::Regressors;
use super::lag::{StillAirInertia, still_air_inertia};
use super::means::{RemovedMeans, remove_means, rest};
use super::options::{ProcessingOptions, Ramps};
use super::report::{DimensionlessFactors, RemovedDrift, RunReport, SignalToNoise, StageLevels};
use super::segmentation::{HarmonicSegment, find_segments, moving_dof};
use super::signals::{SectionSignals, peak_and_rms};
use super::{alignment, axes, cells, index, inertia, low_pass, spikes};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::signal::delayed;
use crate::wind_tunnel::{RawCampaign, RawRecording, RawRun, Record, RecordHeader, Rig, Segment};
use std::ops::Range;

/// A lag of one run is off that of the campaign when it is this many standard errors and a fiftieth of a sample away.
const LAG_OFF: (f64, f64) = (5.0, 0.02);
/// Amplitudes in wind and in still air may differ by this fraction without a warning.
const SAME_AMPLITUDE: f64 = 0.01;

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
pub struct ProcessedRun {
    /// One record, or one a segment when ramps are cut.
    pub records: Vec<Record>,
    /// What was done.
    pub report: RunReport,
    /// Signals after each stage.
    pub stages: Vec<StageSignals>,
}

/// A run that has been checked, with its test points and its lag.
pub(super) struct Prepared<'a> {
    run: &'a RawRun,
    pub dof: Dof,
    findings: Findings,
    segments: Vec<HarmonicSegment>,
    pub still_air: Option<StillAirInertia>,
}

impl<'a> Prepared<'a> {
    pub fn new(run: &'a RawRun, rig: &Rig, options: &ProcessingOptions) -> Result<Self> {
        let findings = check_run(run, rig)?;
        let width = rig.model_width_m;
        let moving = |r: &RawRecording, what: &str| {
            let place = format!("run {}, {what}", run.name);
            moving_dof(&r.motion, width)
                .ok_or_else(|| Error::input(place, "a motion", "none that moves"))
        };
        let dof = moving(&run.in_wind, "in wind")?;
        let in_still_air = moving(&run.still_air, "still air")?;
        if in_still_air != dof {
            return Err(Error::input(
                format!("run {}, still air", run.name),
                format!("the {} motion of the recording in wind", dof.name()),
                format!("a {} motion", in_still_air.name()),
            ));
        }
        let find = |r: &RawRecording| {
            find_segments(&r.motion[index(dof)], r.sampling_hz, &options.segments)
        };
        let segments = find(&run.in_wind);
        let still_air =
            still_air_inertia(&run.name, &run.still_air, rig, dof, &find(&run.still_air))?;
        Ok(Self {
            run,
            dof,
            findings,
            segments,
            still_air,
        })
    }

    pub fn process(
        self,
        campaign: &RawCampaign,
        dofs: &[Dof],
        lag_s: f64,
        options: &ProcessingOptions,
    ) -> Result<ProcessedRun> {
        let rig = &campaign.rig;
        let run = self.run;
        let rate = run.in_wind.sampling_hz;
        let wind = without_lag(&run.in_wind, lag_s);
        let aligned = alignment::align(
            &run.name,
            &wind,
            &without_lag(&run.still_air, lag_s),
            self.dof,
        )?;
        let covered = aligned.covered.clone();
        let segments = self.covered_segments(&covered)?;
        let (mut signals, shares) = on_the_model(&cut(&wind, &covered), rig);
        let (mut still, _) = on_the_model(&cut(&aligned.still_air, &covered), rig);
        let mut stages = Stages::default();
        stages.add("sum of the cells", &signals);
        let (range, at_rest) = rest(&segments, &signals);
        let in_wind = remove_means(&mut signals, &range);
        let still_air = remove_means(&mut still, &range);
        stages.add("means removed", &signals);
        let inertia = inertia::subtract(&mut signals, &still);
        stages.add("still air subtracted", &signals);
        let filter = low_pass::design(&run.name, &options.low_pass, &segments, rate)?;
        let regressors = Regressors::new(
            &signals.motion[index(self.dof)],
            rate,
            &segments,
            options.drift_degree,
        );
        let cleaned = spikes::remove_spikes(
            &mut signals,
            &regressors,
            filter.as_ref().map(|f| &f.0),
            &options.spikes,
            rig.model_width_m,
            &self.clipped(&covered, aligned.alignment.offset_samples),
        )?;
        stages.add("spikes replaced", &signals);
        let mut drift = RemovedDrift {
            degree: options.drift_degree,
            range: [0.0; 3],
        };
        for (d, part) in cleaned.parts.iter().enumerate() {
            let ends = part
                .drift
                .iter()
                .fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(*x), b.max(*x)));
            drift.range[d] = ends.1 - ends.0;
            let force = &mut signals.force[d];
            force.iter_mut().zip(&part.drift).for_each(|(f, x)| *f -= x);
        }
        stages.add("drift removed", &signals);
        let before = noise_ratio(&signals, &cleaned.parts, &segments);
        if let Some((filter, _)) = &filter {
            low_pass::apply(&mut signals, filter)?;
            stages.add("low-pass", &signals);
        }
        let after = noise_ratio(&signals, &cleaned.parts, &segments);
        let speed = run.mean_speed_m_s;
        let pressure = 0.5 * run.air_density_kg_m3 * speed * speed;
        let static_wind = std::array::from_fn(|d| in_wind[d] - still_air[d]);
        let coefficient = |d: usize| {
            let area = pressure * rig.model_length_m;
            static_wind[d] / (area * Dof::THREE[d].force_scale(rig.model_width_m))
        };
        let mut report = RunReport {
            run: run.name.clone(),
            dof: self.dof,
            sampling_hz: rate,
            samples: run.in_wind.len(),
            cut: [covered.start, run.in_wind.len() - covered.end],
            clipped: [
                self.findings.clipped_in_wind.clone(),
                self.findings.clipped_still_air.clone(),
            ]
            .concat(),
            segments: segments.clone(),
            still_air: self.still_air.clone(),
            lag_corrected_s: lag_s,
            alignment: aligned.alignment,
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
            replaced: cleaned.replaced,
            drift,
            low_pass: filter.map(|f| f.1),
            signal_to_noise: SignalToNoise {
                before_low_pass_db: before,
                after_low_pass_db: after,
            },
            dimensionless: DimensionlessFactors {
                speed_m_s: speed,
                air_density_kg_m3: run.air_density_kg_m3,
                pressure_pa: pressure,
                delta_s: speed / (rig.model_width_m * rate),
            },
            levels: stages.levels,
            warnings: self.findings.warnings.clone(),
        };
        self.warn(&mut report, options);
        let records = self.records(campaign, dofs, &signals, &segments, options);
        Ok(ProcessedRun {
            records,
            report,
            stages: stages.signals,
        })
    }

    /// Segments counted from the first covered sample.
    fn covered_segments(&self, covered: &Range<usize>) -> Result<Vec<HarmonicSegment>> {
        let rate = self.run.in_wind.sampling_hz;
        let shift_s = covered.start as f64 / rate;
        let last_s = covered.len() as f64 / rate;
        self.segments
            .iter()
            .map(|s| {
                let p = s.plateau.range();
                if p.start < covered.start || p.end > covered.end {
                    return Err(Error::input(
                        format!("run {}, still air", self.run.name),
                        format!(
                            "a recording as long as the motion at {:.3} Hz (samples {} to {})",
                            s.segment.frequency_hz, p.start, p.end
                        ),
                        format!(
                            "one that covers samples {} to {}",
                            covered.start, covered.end
                        ),
                    ));
                }
                let mut moved = *s;
                moved.plateau.first -= covered.start;
                moved.segment.start_s = (s.segment.start_s - shift_s).max(0.0);
                moved.segment.end_s = (s.segment.end_s - shift_s).min(last_s);
                Ok(moved)
            })
            .collect()
    }

    /// Clipped stretches of both recordings in samples from the first covered one.
    fn clipped(&self, covered: &Range<usize>, offset: f64) -> Vec<Range<usize>> {
        let wind = self.findings.clipped_in_wind.iter().map(|c| (c, 0.0));
        let still = self.findings.clipped_still_air.iter().map(|c| (c, offset));
        let place = |x: f64| (x.max(0.0) as usize).min(covered.len());
        wind.chain(still)
            .map(|(c, late)| {
                let first = c.first as f64 - late - covered.start as f64;
                place(first.floor())..place((first + c.samples as f64).ceil())
            })
            .filter(|r| !r.is_empty())
            .collect()
    }

    fn warn(&self, report: &mut RunReport, options: &ProcessingOptions) {
        let warnings = &mut report.warnings;
        if self.segments.is_empty() {
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
            _ if options.lag_s.is_none() => warnings.push(
                "the inertia in still air is too small to tell the lag of the channels".into(),
            ),
            _ => {}
        }
        let ratio = report.alignment.amplitude_ratio;
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
    }

    fn records(
        &self,
        campaign: &RawCampaign,
        dofs: &[Dof],
        signals: &SectionSignals,
        segments: &[HarmonicSegment],
        options: &ProcessingOptions,
    ) -> Vec<Record> {
        let run = self.run;
        let length = campaign.rig.model_length_m;
        let header = |name: String, segments: Vec<Segment>| RecordHeader {
            name,
            dofs: dofs.to_vec(),
            width_m: campaign.rig.model_width_m,
            air_density_kg_m3: run.air_density_kg_m3,
            mean_speed_m_s: run.mean_speed_m_s,
            sampling_hz: signals.sampling_hz,
            segments,
            source: campaign.source.clone(),
            licence: campaign.licence.clone(),
        };
        let part = |range: Range<usize>, header: RecordHeader| Record {
            motion: dofs
                .iter()
                .map(|d| signals.motion[index(*d)][range.clone()].to_vec())
                .collect(),
            force: dofs
                .iter()
                .map(|d| {
                    let force = &signals.force[index(*d)][range.clone()];
                    force.iter().map(|f| f / length).collect()
                })
                .collect(),
            header,
        };
        match options.segments.ramps {
            Ramps::Keep => {
                let all = segments.iter().map(|s| s.segment).collect();
                vec![part(0..signals.len(), header(run.name.clone(), all))]
            }
            Ramps::Cut => segments
                .iter()
                .map(|s| {
                    let whole = Segment {
                        frequency_hz: s.segment.frequency_hz,
                        start_s: 0.0,
                        end_s: s.plateau.samples as f64 / signals.sampling_hz,
                    };
                    let name = format!("{}-{:.3}Hz", run.name, s.segment.frequency_hz);
                    part(s.plateau.range(), header(name, vec![whole]))
                })
                .collect(),
        }
    }
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

fn cut(recording: &RawRecording, covered: &Range<usize>) -> RawRecording {
    let part = |x: &Vec<f64>| {
        if x.is_empty() {
            Vec::new()
        } else {
            x[covered.clone()].to_vec()
        }
    };
    RawRecording {
        source: recording.source.clone(),
        sampling_hz: recording.sampling_hz,
        motion: std::array::from_fn(|d| part(&recording.motion[d])),
        cells: recording
            .cells
            .iter()
            .map(|c| std::array::from_fn(|i| part(&c[i])))
            .collect(),
        wind_speed_m_s: part(&recording.wind_speed_m_s),
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
    let global = axes::to_global(recording, rig, rotation);
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
    parts: &[super::coherent::Parts; 3],
    segments: &[HarmonicSegment],
) -> [f64; 3] {
    std::array::from_fn(|d| {
        let steady = || segments.iter().flat_map(|s| s.plateau.range());
        let coherent: Vec<f64> = steady().map(|k| parts[d].coherent[k]).collect();
        let rest: Vec<f64> = steady()
            .map(|k| signals.force[d][k] - parts[d].coherent[k])
            .collect();
        let (signal, noise) = (peak_and_rms(&coherent).1, peak_and_rms(&rest).1);
        if signal > 0.0 && noise > 0.0 {
            20.0 * (signal / noise).log10()
        } else {
            0.0
        }
    })
}
