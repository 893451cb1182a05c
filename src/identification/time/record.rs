//! A record without dimensions, in memory: an hour at 200 Hz of two motions and their forces is 23 MB.

use super::spectrum::band;
use crate::error::{Error, Result, positive};
use crate::identification::basis::index_of;
use crate::identification::least_squares::BLOCK_ROWS;
use crate::section::Dof;
use crate::signal::resampled;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::wind_tunnel::{RecordBlock, RecordHeader, RecordSource, Segment};
use std::borrow::Cow;

/// A motion counts as still while it is closer to its first value than this fraction of its largest departure from it:
/// the rest of a rig is not perfectly quiet.
const STILL: f64 = 0.01;
/// The departure has to grow by this ratio to be noticed.
const GROWTH: f64 = 1.01;

/// A record whose numbers have been checked, with degrees of freedom in the order of every matrix of the crate.
pub(crate) struct DimensionlessRecord {
    header: RecordHeader,
    pub signals: Signals,
    /// `V/B`, 1/s.
    pub rate: f64,
    /// Sampling step, s.
    pub step_s: f64,
}

/// Dimensionless motions and forces, one vector a degree of freedom, all of one length.
#[derive(Clone)]
pub(crate) struct Signals {
    pub motion: Vec<Vec<f64>>,
    pub force: Vec<Vec<f64>>,
}

/// Reads all records and finds their degrees of freedom.
///
/// # Errors
/// [`Error::Input`] naming the record and the value that cannot be, for records of different degrees of freedom, channels
/// of different lengths and samples that are not finite.
pub(crate) fn read_all(
    records: &[&dyn RecordSource],
) -> Result<(Vec<Dof>, Vec<DimensionlessRecord>)> {
    let first = records
        .first()
        .ok_or_else(|| Error::input("records", "at least one", "none"))?;
    let mut dofs = first.header().dofs.clone();
    dofs.sort();
    dofs.dedup();
    let heads = records.iter().map(|r| check_header(r.header(), &dofs));
    heads.collect::<Result<Vec<_>>>()?;
    let read = records.iter().map(|r| DimensionlessRecord::read(*r, &dofs));
    let read = read.collect::<Result<_>>()?;
    Ok((dofs, read))
}

fn check_header(header: &RecordHeader, dofs: &[Dof]) -> Result<()> {
    let place = |key: &str| format!("record {}: {key}", header.name);
    positive(&place("width_m"), header.width_m)?;
    positive(&place("air_density_kg_m3"), header.air_density_kg_m3)?;
    positive(&place("mean_speed_m_s"), header.mean_speed_m_s)?;
    positive(&place("sampling_hz"), header.sampling_hz)?;
    for segment in &header.segments {
        positive(&place("segments: frequency_hz"), segment.frequency_hz)?;
    }
    for dof in dofs {
        index_of(&header.dofs, *dof, &place("dofs"))?;
    }
    if header.dofs.len() != dofs.len() || dofs.is_empty() {
        return Err(Error::input(
            place("dofs"),
            format!("{dofs:?}, each once, as in the first record"),
            format!("{:?}", header.dofs),
        ));
    }
    Ok(())
}

impl DimensionlessRecord {
    fn read(record: &dyn RecordSource, dofs: &[Dof]) -> Result<Self> {
        let header = record.header();
        let (width, speed) = (header.width_m, header.mean_speed_m_s);
        let pressure = 0.5 * header.air_density_kg_m3 * speed * speed;
        let mut signals = Signals {
            motion: vec![Vec::new(); dofs.len()],
            force: vec![Vec::new(); dofs.len()],
        };
        record.for_each_block(&mut |block| {
            let read = signals.len();
            check_lengths(&header.name, &block, dofs.len(), read)?;
            for (i, dof) in dofs.iter().enumerate() {
                let channel = index_of(&header.dofs, *dof, "dofs")?;
                let force_scale = 1.0 / (pressure * dof.force_scale(width));
                for (to, from, factor, what) in [
                    (
                        &mut signals.motion[i],
                        &block.motion[channel],
                        dof.motion_scale(width),
                        "motion",
                    ),
                    (
                        &mut signals.force[i],
                        &block.force[channel],
                        force_scale,
                        "force",
                    ),
                ] {
                    to.extend(from.iter().map(|x| factor * x));
                    if let Some(bad) = to[read..].iter().position(|x| !x.is_finite()) {
                        return Err(Error::input(
                            format!("record {}, {what}, sample {}", header.name, read + bad),
                            "a finite number",
                            from[bad].to_string(),
                        ));
                    }
                }
            }
            Ok(())
        })?;
        let channels = signals.motion.iter_mut().chain(&mut signals.force);
        channels.for_each(Vec::shrink_to_fit);
        Ok(Self {
            header: header.clone(),
            signals,
            rate: speed / width,
            step_s: 1.0 / header.sampling_hz,
        })
    }

    /// Name of the record.
    pub(crate) fn name(&self) -> &str {
        &self.header.name
    }

    /// Mean wind speed, m/s.
    pub(crate) fn mean_speed_m_s(&self) -> f64 {
        self.header.mean_speed_m_s
    }

    /// Sampling step in dimensionless time.
    pub(crate) fn delta_s(&self) -> f64 {
        self.rate * self.step_s
    }

    /// Stretches of harmonic motion that the record states.
    pub(crate) fn segments(&self) -> &[Segment] {
        &self.header.segments
    }

    /// Instants (s) at which one segment gives way to the next.
    pub(crate) fn segment_starts(&self) -> Vec<f64> {
        self.segments().iter().skip(1).map(|s| s.start_s).collect()
    }

    /// Reduced frequencies of the segments; for other motions the band that holds their power.
    pub(crate) fn tested_range(&self) -> Option<ReducedFrequencyRange> {
        let k = |per_sample: f64| ReducedFrequency::from_full_width(per_sample / self.delta_s());
        if self.segments().is_empty() {
            let (low, high) = band(&self.signals.motion)?;
            return ReducedFrequencyRange::spanning([k(low), k(high)]);
        }
        let of_hertz =
            |f: f64| ReducedFrequency::from_full_width(std::f64::consts::TAU * f / self.rate);
        ReducedFrequencyRange::spanning(self.segments().iter().map(|s| of_hertz(s.frequency_hz)))
    }

    /// Subtracts the mean of each force over the record; returns the means, dimensionless.
    pub(crate) fn remove_means(&mut self) -> Vec<f64> {
        let rows = f64::max(self.signals.len() as f64, 1.0);
        let remove = |force: &mut Vec<f64>| {
            let sums = force.chunks(BLOCK_ROWS).map(|c| c.iter().sum::<f64>());
            let mean = sums.sum::<f64>() / rows;
            force.iter_mut().for_each(|x| *x -= mean);
            mean
        };
        self.signals.force.iter_mut().map(remove).collect()
    }

    /// The signals at the record's own step, or at the dimensionless step `delta_s` if that is longer, and that step in
    /// seconds.
    pub(crate) fn at_step(&self, delta_s: Option<f64>) -> (Cow<'_, Signals>, f64) {
        let ratio = delta_s.map_or(1.0, |d| d / self.delta_s());
        // a step equal but for rounding is the same step
        if ratio <= 1.0 + 1e-9 {
            return (Cow::Borrowed(&self.signals), self.step_s);
        }
        let at_ratio =
            |channels: &[Vec<f64>]| channels.iter().map(|c| resampled(c, ratio)).collect();
        let signals = Signals {
            motion: at_ratio(&self.signals.motion),
            force: at_ratio(&self.signals.force),
        };
        (Cow::Owned(signals), self.step_s * ratio)
    }
}

fn check_lengths(name: &str, block: &RecordBlock<'_>, n: usize, read: usize) -> Result<()> {
    let rows = block.motion.first().map_or(0, Vec::len);
    let mut channels = block.motion.iter().chain(block.force);
    if block.motion.len() != n || block.force.len() != n || channels.any(|c| c.len() != rows) {
        return Err(Error::input(
            format!("record {name}, from sample {read}"),
            format!("{n} motions and {n} forces of one length"),
            "channels of another number or length",
        ));
    }
    Ok(())
}

impl Signals {
    /// Number of samples.
    pub(crate) fn len(&self) -> usize {
        self.motion[0].len()
    }

    /// Number of samples before any motion starts; all of them when none ever does.
    pub(crate) fn still_samples(&self) -> usize {
        let departure = |k: usize| {
            let each = self.motion.iter().map(|m| (m[k] - m[0]).abs());
            each.fold(0.0, f64::max)
        };
        let mut largest = 0.0;
        let mut growing = Vec::new();
        for k in 0..self.len() {
            let now = departure(k);
            if now > GROWTH * largest {
                largest = now;
                growing.push((k, now));
            }
        }
        let start = growing.iter().find(|(_, d)| *d > STILL * largest);
        start.map_or(self.len(), |(sample, _)| *sample)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn still(motion: Vec<Vec<f64>>) -> usize {
        let force = Vec::new();
        Signals { motion, force }.still_samples()
    }

    /// Noise of 0.2 % in both channels and an offset; the sine starts at sample 300 and passes 1 % of its amplitude there.
    #[test]
    fn noise_and_offsets_are_still() {
        let noise = |k: usize| 0.002 * (12.9898 * k as f64).sin();
        let moving = |k: usize| 3.0 + noise(k) + (0.3 * (k as f64 - 300.0).max(0.0)).sin();
        let idle: Vec<f64> = (0..2000).map(noise).collect();
        assert_eq!(still(vec![(0..2000).map(moving).collect(), idle]), 301);
        assert_eq!(still(vec![vec![0.5; 100]]), 100);
        assert_eq!(still(vec![vec![0.0, 1.0, -1.0]]), 1);
    }
}
