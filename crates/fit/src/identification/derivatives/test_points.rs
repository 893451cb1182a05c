//! Steady harmonic stretches of records, sorted into test points.

use super::result::DerivativeOptions;
use crate::error::{Result, ensure};
use crate::identification::time::record::check_numbers;
use crate::identification::time::signals::Signals;
use crate::numbered::numbered;
use crate::section::Dof;
use crate::signal::{HarmonicFit, fit_harmonics, largest_about_mean, plateau, refine_frequency};
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{RecordHeader, RecordSource};
use std::ops::Range;
use std::sync::Arc;

/// Harmonics of a driven motion at most: a rig is not perfectly linear …
const HARMONICS: usize = 3;
/// … and up to this part of the sampling frequency: at half of it a harmonic has no phase, beyond it is another one.
const HARMONICS_OVER_SAMPLING: f64 = 0.45;
/// Samples of a period at least: below, the third harmonic of the rig shows as the motion itself.
const SAMPLES_AT_LEAST: f64 = 4.0;
/// Fewer samples of a period are said.
const SAMPLES_ENOUGH: f64 = 8.0;
/// A motion below this part of the greatest is cross-talk.
pub(super) const CROSS_TALK: f64 = 0.05;

/// One run at one test point, without dimensions.
pub(super) struct TestRun {
    /// The motion that is driven, by its place among the degrees of freedom.
    pub driven: usize,
    pub frequency_hz: f64,
    pub k: ReducedFrequency,
    pub periods: usize,
    /// Amplitude of each motion.
    pub amplitude: Vec<f64>,
    pub header: RecordHeader,
    /// The whole record in its own units, and the samples of the run in it.
    signals: Arc<Signals>,
    samples: Range<usize>,
    /// Harmonics of each motion, over the time from the first sample of the run.
    fits: Vec<HarmonicFit>,
}

impl TestRun {
    /// A warning of a motion that is sampled so rarely that its harmonics, or those of the force, show as one another.
    fn few_samples(&self) -> Option<String> {
        let samples = self.header.sampling_hz / self.frequency_hz;
        (samples < SAMPLES_ENOUGH).then(|| {
            format!(
                "run {} at {:.3} Hz has {samples:.1} samples in a period: harmonics of the motion are not told from it",
                self.header.name, self.frequency_hz
            )
        })
    }

    /// Its motions at each sample without dimensions, `r_j` and `r_j'/K`: their harmonics, which alone are free of noise.
    pub(super) fn motions(&self) -> Vec<[Vec<f64>; 2]> {
        let header = &self.header;
        let omega = std::f64::consts::TAU * self.frequency_hz;
        let motion_of = |j: usize| {
            let scale = header.dofs[j].motion_scale(header.width_m);
            let time = (0..self.samples.len()).map(|k| k as f64 / header.sampling_hz);
            let moves = time.map(|t| self.fits[j].oscillation(t));
            let scaled = moves.map(|(value, slope)| (scale * value, scale * slope / omega));
            let (value, slope): (Vec<f64>, Vec<f64>) = scaled.unzip();
            [value, slope]
        };
        (0..header.dofs.len()).map(motion_of).collect()
    }

    /// Its forces at each sample without dimensions, `q_i`.
    ///
    /// # Errors
    /// [`Error::Io`] for long records whose file cannot be read any more.
    pub(super) fn forces(&self) -> Result<Vec<Vec<f64>>> {
        let header = &self.header;
        let pressure = 0.5 * header.air_density_kg_m3 * header.mean_speed_m_s.powi(2);
        let mut channels = self.signals.range(self.samples.clone())?;
        let mut forces = channels.split_off(header.dofs.len());
        for (dof, force) in header.dofs.iter().zip(&mut forces) {
            let factor = 1.0 / (pressure * dof.force_scale(header.width_m));
            force.iter_mut().for_each(|f| *f *= factor);
        }
        Ok(forces)
    }
}

/// Largest amplitude of rotation, deg; `None` where no run drives it.
pub(super) fn rotation_amplitude_deg(dofs: &[Dof], groups: &[Vec<TestRun>]) -> Option<f64> {
    let torsion = dofs.iter().position(|d| *d == Dof::Torsion)?;
    let driven = groups.iter().flatten().filter(|s| s.driven == torsion);
    let amplitudes = driven.map(|s| s.amplitude[torsion].to_degrees());
    amplitudes.reduce(f64::max)
}

/// The test points: steady stretches of all records, which are to be like the `first`, in groups.
pub(super) fn collect(
    records: &[&dyn RecordSource],
    first: &RecordHeader,
    options: &DerivativeOptions,
    warnings: &mut Vec<String>,
) -> Result<Vec<Vec<TestRun>>> {
    let mut groups = Vec::new();
    let each = numbered(records.len(), &|_, _| (), |r| {
        let header = records[r].header();
        check(header, first)?;
        let signals = Arc::new(Signals::from_record(records[r])?);
        check_forces(header, &signals)?;
        signals.check_clipping(&header.name, &header.dofs)?;
        numbered(header.segments.len(), &|_, _| (), |i| {
            stretch(header, &signals, i, options)
        })
    })?;
    for (record, stretches) in records.iter().zip(each) {
        let header = record.header();
        for (stretch, segment) in stretches.into_iter().zip(&header.segments) {
            match stretch {
                Some(stretch) => {
                    warnings.extend(stretch.few_samples());
                    insert(&mut groups, stretch, options);
                }
                None => warnings.push(format!(
                    "record {}: no whole period of steady motion at {:.3} Hz",
                    header.name, segment.frequency_hz
                )),
            }
        }
    }
    ensure(
        !groups.is_empty(),
        "records",
        "stretches of harmonic motion (`segment` lines)",
        "none",
    )?;
    Ok(groups)
}

fn check(header: &RecordHeader, first: &RecordHeader) -> Result<()> {
    let place = |key: &str| format!("record {}: {key}", header.name);
    check_numbers(header)?;
    ensure(
        header.dofs == first.dofs,
        place("dofs"),
        format_args!("{}, as in the first record", Dof::names(&first.dofs)),
        Dof::names(&header.dofs),
    )?;
    header.check_width(first.width_m, place("width_m"), "in the first record")
}

/// Refuses a record of no force at all: derivatives of zero look like results.
fn check_forces(header: &RecordHeader, signals: &Signals) -> Result<()> {
    let mut acts = false;
    signals.for_each_block(|block| {
        let mut forces = block.channels[header.dofs.len()..].iter().flatten();
        acts = acts || forces.any(|f| *f != 0.0);
        Ok(())
    })?;
    ensure(
        acts,
        format_args!("record {}", header.name),
        "a force",
        "none: all channels are zero throughout",
    )
}

/// The steady part of one segment; `None` when it has no whole period.
fn stretch(
    header: &RecordHeader,
    signals: &Arc<Signals>,
    segment: usize,
    options: &DerivativeOptions,
) -> Result<Option<TestRun>> {
    let (s, rate) = (header.segments[segment], header.sampling_hz);
    let (name, samples) = (&header.name, rate / s.frequency_hz);
    ensure(
        samples >= SAMPLES_AT_LEAST,
        format_args!("record {name}: segment at {:.3} Hz", s.frequency_hz),
        format_args!("at least {SAMPLES_AT_LEAST} samples in a period"),
        format_args!("{samples:.2} ({rate} Hz)"),
    )?;
    let at = |t: f64| ((t * rate).round().max(0.0) as usize).min(signals.len());
    let start = at(s.start_s);
    let mut channels = signals.range(start..at(s.end_s))?;
    channels.truncate(header.dofs.len());
    let Some(driven) = driven_motion(header, &channels) else {
        return Ok(None);
    };
    let motion = &channels[driven];
    let steady = |f| plateau(motion, 0..motion.len(), rate, f, options.full_amplitude);
    let Some(rough) = steady(s.frequency_hz) else {
        return Ok(None);
    };
    let frequency_hz = refine_frequency(motion, rough.range(), rate, s.frequency_hz)?;
    let Some(p) = steady(frequency_hz) else {
        return Ok(None);
    };
    let harmonics = HARMONICS.min((HARMONICS_OVER_SAMPLING * rate / frequency_hz) as usize);
    let fit = |x: &Vec<f64>| {
        let run = &x[p.range()];
        fit_harmonics(run, 0..p.samples, rate, frequency_hz, harmonics, &|_| true)
    };
    let fits = channels.iter().map(fit).collect::<Result<Vec<_>>>()?;
    let amplitudes = header.dofs.iter().zip(&fits);
    let amplitudes =
        amplitudes.map(|(dof, fit)| dof.motion_scale(header.width_m) * fit.fundamental().norm());
    Ok(Some(TestRun {
        driven,
        frequency_hz,
        k: ReducedFrequency::from_hertz(frequency_hz, header.width_m, header.mean_speed_m_s),
        periods: p.periods,
        amplitude: amplitudes.collect(),
        header: header.clone(),
        signals: Arc::clone(signals),
        samples: start + p.first..start + p.range().end,
        fits,
    }))
}

/// The greatest motion, by its place among the degrees of freedom; `None` when nothing moves.
fn driven_motion(header: &RecordHeader, motions: &[Vec<f64>]) -> Option<usize> {
    let size = |j: usize| {
        let greatest = largest_about_mean(&motions[j]);
        greatest * header.dofs[j].motion_scale(header.width_m)
    };
    let greatest = (0..header.dofs.len()).max_by(|a, b| size(*a).total_cmp(&size(*b)));
    greatest.filter(|j| size(*j) > 0.0)
}

/// Into the group of the same frequency and the nearest speed, unless that motion is there already: repeated tests are points of their own.
fn insert(groups: &mut Vec<Vec<TestRun>>, stretch: TestRun, options: &DerivativeOptions) {
    let speed = |run: &TestRun| run.header.mean_speed_m_s;
    let near = |a: f64, b: f64, ratio: f64| (a / b).ln().abs() <= ratio.ln();
    let fits = |group: &&mut Vec<TestRun>| {
        let same = |s: &TestRun| {
            near(speed(s), speed(&stretch), options.same_speed)
                && near(s.frequency_hz, stretch.frequency_hz, options.same_frequency)
        };
        group.iter().all(same) && group.iter().all(|s| s.driven != stretch.driven)
    };
    let off = |group: &&mut Vec<TestRun>| (speed(&group[0]) / speed(&stretch)).ln().abs();
    let fitting = groups.iter_mut().filter(fits);
    match fitting.min_by(|a, b| off(a).total_cmp(&off(b))) {
        Some(group) => group.push(stretch),
        None => groups.push(vec![stretch]),
    }
}
