//! Steady harmonic stretches of records, sorted into test points.

use super::result::DerivativeOptions;
use crate::error::{Error, Result, positive};
use crate::section::Dof;
use crate::signal::{
    HarmonicFit, Plateau, fit_harmonics, largest_about_mean, plateau, refine_frequency,
};
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{Record, RecordHeader, RecordSource};
use rayon::prelude::*;

/// Harmonics of a driven motion: a rig is not perfectly linear.
const HARMONICS: usize = 3;
/// A motion below this part of the greatest is cross-talk.
pub(super) const CROSS_TALK: f64 = 0.05;

/// One run at one test point, without dimensions.
pub(super) struct TestRun {
    pub run: String,
    /// The motion that is driven, by its place among the degrees of freedom.
    pub driven: usize,
    pub speed_m_s: f64,
    pub frequency_hz: f64,
    pub k: ReducedFrequency,
    pub periods: usize,
    /// `r_j` and `r_j'/K` at each sample.
    pub motion: Vec<[Vec<f64>; 2]>,
    /// Amplitude of each motion.
    pub amplitude: Vec<f64>,
    /// `q_i` at each sample.
    pub force: Vec<Vec<f64>>,
}

/// All test points.
pub(super) struct TestPoints {
    pub width_m: f64,
    pub dofs: Vec<Dof>,
    pub groups: Vec<Vec<TestRun>>,
    pub warnings: Vec<String>,
}

impl TestPoints {
    /// Largest amplitude of rotation, deg; `None` where no run drives it.
    pub(super) fn rotation_amplitude_deg(&self) -> Option<f64> {
        let torsion = self.dofs.iter().position(|d| *d == Dof::Torsion)?;
        let driven = self.groups.iter().flatten().filter(|s| s.driven == torsion);
        driven
            .map(|s| s.amplitude[torsion].to_degrees())
            .reduce(f64::max)
    }
}

/// Takes the steady stretches of all records and groups them.
pub(super) fn collect(
    records: &[&dyn RecordSource],
    options: &DerivativeOptions,
) -> Result<TestPoints> {
    let first = records
        .first()
        .ok_or_else(|| Error::input("records", "at least one", "none"))?
        .header();
    let mut points = TestPoints {
        width_m: first.width_m,
        dofs: first.dofs.clone(),
        groups: Vec::new(),
        warnings: Vec::new(),
    };
    for record in records {
        let header = record.header();
        check(header, first)?;
        let Record { motion, force, .. } = Record::whole(*record)?;
        let channels: Vec<Vec<f64>> = motion.into_iter().chain(force).collect();
        if !header.segments.is_empty() {
            refuse_gaps(header, &channels)?;
        }
        let segments = (0..header.segments.len()).into_par_iter();
        let stretches = segments.map(|i| stretch(header, &channels, i, options));
        for (i, stretch) in stretches
            .collect::<Result<Vec<_>>>()?
            .into_iter()
            .enumerate()
        {
            match stretch {
                Some(stretch) => insert(&mut points.groups, stretch, options),
                None => points.warnings.push(format!(
                    "record {}: no whole period of steady motion at {:.3} Hz",
                    header.name, header.segments[i].frequency_hz
                )),
            }
        }
    }
    if points.groups.is_empty() {
        let expected = "stretches of harmonic motion (`segment` lines)";
        return Err(Error::input("records", expected, "none"));
    }
    Ok(points)
}

fn check(header: &RecordHeader, first: &RecordHeader) -> Result<()> {
    let place = |key: &str| format!("record {}: {key}", header.name);
    for (key, value) in [
        ("width_m", header.width_m),
        ("air_density_kg_m3", header.air_density_kg_m3),
        ("mean_speed_m_s", header.mean_speed_m_s),
        ("sampling_hz", header.sampling_hz),
    ] {
        positive(place(key), value)?;
    }
    if header.dofs != first.dofs {
        let expected = format!("{}, as in the first record", Dof::names(&first.dofs));
        let found = Dof::names(&header.dofs);
        return Err(Error::input(place("dofs"), expected, found));
    }
    if (header.width_m / first.width_m - 1.0).abs() > 1e-6 {
        let expected = format!("{} m, as in the first record", first.width_m);
        let found = format!("{} m", header.width_m);
        return Err(Error::input(place("width_m"), expected, found));
    }
    Ok(())
}

/// The steady part of one segment; `None` when it has no whole period.
fn stretch(
    header: &RecordHeader,
    channels: &[Vec<f64>],
    segment: usize,
    options: &DerivativeOptions,
) -> Result<Option<TestRun>> {
    let Some(steady) = SteadyMotion::find(header, channels, segment, options)? else {
        return Ok(None);
    };
    let SteadyMotion {
        driven,
        frequency_hz,
        plateau: p,
    } = steady;
    let (n, rate) = (header.dofs.len(), header.sampling_hz);
    let fit = |x: &[f64]| fit_harmonics(x, p.range(), rate, frequency_hz, HARMONICS, &|_| true);
    let fits = channels[..n]
        .iter()
        .map(|x| fit(x))
        .collect::<Result<Vec<HarmonicFit>>>()?;
    let omega = std::f64::consts::TAU * frequency_hz;
    let scale = |j: usize| header.dofs[j].motion_scale(header.width_m);
    let pressure = 0.5 * header.air_density_kg_m3 * header.mean_speed_m_s.powi(2);
    let motion_of = |j: usize| {
        let mut both = [Vec::with_capacity(p.samples), Vec::with_capacity(p.samples)];
        for k in p.range() {
            let (value, rate_of_change) = fits[j].oscillation(k as f64 / rate);
            both[0].push(scale(j) * value);
            both[1].push(scale(j) * rate_of_change / omega);
        }
        both
    };
    let force_of = |i: usize| {
        let factor = 1.0 / (pressure * header.dofs[i].force_scale(header.width_m));
        let force = &channels[n + i][p.range()];
        force.iter().map(|f| f * factor).collect()
    };
    let amplitude_of = |j: usize| scale(j) * fits[j].fundamental().norm();
    Ok(Some(TestRun {
        run: header.name.clone(),
        driven,
        speed_m_s: header.mean_speed_m_s,
        frequency_hz,
        k: ReducedFrequency::from_hertz(frequency_hz, header.width_m, header.mean_speed_m_s),
        periods: p.periods,
        motion: (0..n).map(motion_of).collect(),
        amplitude: (0..n).map(amplitude_of).collect(),
        force: (0..n).map(force_of).collect(),
    }))
}

fn refuse_gaps(header: &RecordHeader, channels: &[Vec<f64>]) -> Result<()> {
    for (c, channel) in channels.iter().enumerate() {
        if let Some(k) = channel.iter().position(|v| !v.is_finite()) {
            let place = format!("record {}, channel {}, sample {k}", header.name, c + 1);
            let found = channel[k].to_string();
            return Err(Error::input(place, "a finite number", found));
        }
    }
    Ok(())
}

/// Whole periods of a driven motion at full amplitude.
struct SteadyMotion {
    /// The motion that is driven, by its place among the degrees of freedom.
    driven: usize,
    frequency_hz: f64,
    plateau: Plateau,
}

impl SteadyMotion {
    /// Those of the greatest motion in a segment; `None` when nothing moves or there is no whole period.
    fn find(
        header: &RecordHeader,
        channels: &[Vec<f64>],
        segment: usize,
        options: &DerivativeOptions,
    ) -> Result<Option<Self>> {
        let (s, rate) = (header.segments[segment], header.sampling_hz);
        let at = |t: f64| ((t * rate).round().max(0.0) as usize).min(channels[0].len());
        let range = at(s.start_s)..at(s.end_s);
        let size = |j: usize| {
            let greatest = largest_about_mean(&channels[j][range.clone()]);
            greatest * header.dofs[j].motion_scale(header.width_m)
        };
        let driven = (0..header.dofs.len()).max_by(|a, b| size(*a).total_cmp(&size(*b)));
        let Some(driven) = driven.filter(|j| size(*j) > 0.0) else {
            return Ok(None);
        };
        let motion = &channels[driven];
        let steady = |f| plateau(motion, range.clone(), rate, f, options.full_amplitude);
        let Some(rough) = steady(s.frequency_hz) else {
            return Ok(None);
        };
        let frequency_hz = refine_frequency(motion, rough.range(), rate, s.frequency_hz)?;
        Ok(steady(frequency_hz).map(|plateau| Self {
            driven,
            frequency_hz,
            plateau,
        }))
    }
}

/// Into the group of the same frequency and the nearest speed, unless that motion is there already: repeated tests are points of their own.
fn insert(groups: &mut Vec<Vec<TestRun>>, stretch: TestRun, options: &DerivativeOptions) {
    let near = |a: f64, b: f64, ratio: f64| (a / b).ln().abs() <= ratio.ln();
    let fits = |group: &&mut Vec<TestRun>| {
        let same = |s: &TestRun| {
            near(s.speed_m_s, stretch.speed_m_s, options.same_speed)
                && near(s.frequency_hz, stretch.frequency_hz, options.same_frequency)
        };
        group.iter().all(same) && group.iter().all(|s| s.driven != stretch.driven)
    };
    let off = |group: &&mut Vec<TestRun>| (group[0].speed_m_s / stretch.speed_m_s).ln().abs();
    let nearest = groups
        .iter_mut()
        .filter(fits)
        .min_by(|a, b| off(a).total_cmp(&off(b)));
    match nearest {
        Some(group) => group.push(stretch),
        None => groups.push(vec![stretch]),
    }
}
