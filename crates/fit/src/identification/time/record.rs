//! A record without dimensions.

use super::driven::{driven_bands, driven_motions};
use super::signals::Signals;
use crate::error::{Error, Result, ensure, positive};
use crate::identification::basis::index_of;
use crate::identification::least_squares::BLOCK_ROWS;
use crate::identification::own::StaticTerm;
use crate::identification::report::StaticReport;
use crate::numbered::numbered;
use crate::section::Dof;
use crate::signal::resampled;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::wind_tunnel::{RecordHeader, RecordSource};
use std::f64::consts::TAU;

/// A motion counts as still while it is closer to its first value than this fraction of its largest departure from it:
/// the rest of a rig is not perfectly quiet.
const STILL: f64 = 0.01;
/// Samples of a motion that are looked at together.
const LOOKED_AT: usize = 64;
/// The departure has to grow by this ratio to be noticed.
const GROWTH: f64 = 1.01;

/// A record whose numbers have been checked, with degrees of freedom in the order of every matrix of the crate.
pub(crate) struct DimensionlessRecord {
    pub header: RecordHeader,
    pub signals: Signals,
    /// Reduced frequencies at which each motion was driven: those of the segments, of other motions the band that holds its power.
    pub driven: Vec<Vec<ReducedFrequencyRange>>,
    /// `V/B`, 1/s.
    pub rate: f64,
    /// Sampling step, s.
    pub step_s: f64,
}

/// The records of one fit.
pub(crate) struct Records {
    /// Degrees of freedom, in the order of every matrix.
    pub dofs: Vec<Dof>,
    pub each: Vec<DimensionlessRecord>,
    /// Means of the forces that were taken away.
    pub removed_means: Vec<StaticReport>,
}

impl Records {
    /// Reads all records, and removes the means of their forces where the static term says so.
    ///
    /// # Errors
    /// [`Error::Input`] naming the record and the value that cannot be, for records of different degrees of freedom, channels
    /// of different lengths and samples that are not finite.
    pub(crate) fn read(records: &[&dyn RecordSource], static_term: StaticTerm) -> Result<Self> {
        let none = || Error::input("records", "at least one", "none");
        let first = records.first().ok_or_else(none)?;
        let mut dofs = first.header().dofs.clone();
        dofs.sort();
        dofs.dedup();
        let mut heads = records.iter().map(|r| r.header());
        heads.try_for_each(|head| check_header(head, &dofs))?;
        let read = |r: usize| DimensionlessRecord::read(records[r], &dofs);
        let mut each = numbered(records.len(), &|_, _| (), read)?;
        let mut removed_means = Vec::new();
        let without_mean = each.iter_mut();
        for record in without_mean.filter(|_| static_term == StaticTerm::Removed) {
            for (value, &force) in record.remove_means()?.into_iter().zip(&dofs) {
                removed_means.push(StaticReport {
                    force,
                    record: Some(record.header.name.to_owned()),
                    value,
                    standard_error: None,
                });
            }
        }
        Ok(Self {
            dofs,
            each,
            removed_means,
        })
    }

    /// Reduced frequencies at which any motion was driven.
    pub(crate) fn spanned_range(&self) -> Result<ReducedFrequencyRange> {
        let all = self.each.iter().flat_map(|record| &record.driven);
        ReducedFrequencyRange::covering(all.flatten().copied())
            .ok_or_else(|| Error::input("records", "a motion", "none that moves"))
    }

    /// Reduced frequencies at which every motion was driven.
    pub(crate) fn tested_range(&self) -> Result<ReducedFrequencyRange> {
        let of = |motion: usize| {
            let driven = self.each.iter().flat_map(|record| &record.driven[motion]);
            let driven = ReducedFrequencyRange::covering(driven.copied());
            let name = self.dofs[motion].name();
            driven.ok_or_else(|| Error::input("records", format!("a {name} motion"), "none"))
        };
        let all: Vec<_> = (0..self.dofs.len()).map(of).collect::<Result<_>>()?;
        ReducedFrequencyRange::common(all).unwrap_or_else(|| self.spanned_range())
    }

    /// Numbers of a transfer function that the tests determine: two for each frequency and speed at which one degree of freedom
    /// was moved; no end of them where records move a whole band.
    pub(crate) fn rows_of_tests(&self) -> usize {
        let segments = self.each.iter().map(|record| record.header.segments.len());
        if segments.clone().any(|count| count == 0) {
            return usize::MAX;
        }
        2 * segments.sum::<usize>() / self.dofs.len().max(1)
    }

    /// What is odd about the air of a record, once for all that are odd.
    pub(crate) fn odd_air(&self) -> Vec<String> {
        let odd = self.each.iter().find_map(|record| record.header.odd_air());
        odd.into_iter().collect()
    }

    /// The longest dimensionless step, to which the discrete model resamples all records.
    pub(crate) fn longest_step(&self) -> f64 {
        let steps = self.each.iter().map(DimensionlessRecord::delta_s);
        steps.fold(0.0, f64::max)
    }
}

/// Refuses what has to be positive and is not.
pub(crate) fn check_numbers(header: &RecordHeader) -> Result<()> {
    for (key, value) in [
        ("width_m", header.width_m),
        ("air_density_kg_m3", header.air_density_kg_m3),
        ("mean_speed_m_s", header.mean_speed_m_s),
        ("sampling_hz", header.sampling_hz),
    ] {
        positive(format!("record {}: {key}", header.name), value)?;
    }
    Ok(())
}

fn check_header(header: &RecordHeader, dofs: &[Dof]) -> Result<()> {
    let place = |key: &str| format!("record {}: {key}", header.name);
    check_numbers(header)?;
    for dof in dofs {
        index_of(&header.dofs, *dof, &place("dofs"))?;
    }
    ensure(
        header.dofs.len() == dofs.len() && !dofs.is_empty(),
        place("dofs"),
        format_args!("{}, each once, as in the first record", Dof::names(dofs)),
        Dof::names(&header.dofs),
    )
}

impl DimensionlessRecord {
    fn read(record: &dyn RecordSource, dofs: &[Dof]) -> Result<Self> {
        let header = record.header();
        let (width, speed) = (header.width_m, header.mean_speed_m_s);
        let pressure = 0.5 * header.air_density_kg_m3 * speed * speed;
        let mut signals = Signals::new(dofs.len());
        record.for_each_block(&mut |block| {
            let (read, n) = (signals.len(), dofs.len());
            let is_whole = block.len() == 2 * n && block.iter().all(|c| c.len() == block[0].len());
            header.check_channels(read, is_whole)?;
            let (mut motions, mut forces) = (Vec::new(), Vec::new());
            for dof in dofs {
                let channel = index_of(&header.dofs, *dof, "dofs")?;
                let force_scale = 1.0 / (pressure * dof.force_scale(width));
                motions.push((block[channel], dof.motion_scale(width)));
                forces.push((block[n + channel], force_scale));
            }
            for (motion, force) in motions.iter().zip(&forces) {
                for ((from, factor), what) in [(motion, "motion"), (force, "force")] {
                    let finite = |x: &f64| (factor * x).is_finite();
                    // all at once, and one by one only where there is one to be named
                    let all = from.iter().fold(true, |all, x| all & finite(x));
                    if !all && let Some(bad) = from.iter().position(|x| !finite(x)) {
                        return Err(Error::input(
                            format!("record {}, {what}, sample {}", header.name, read + bad),
                            "a finite number",
                            from[bad].to_string(),
                        ));
                    }
                }
            }
            let channels = [motions, forces].concat();
            signals.extend(channels[0].0.len(), |c, k| channels[c].1 * channels[c].0[k])
        })?;
        let signals = signals.finish()?;
        header.check_ends(signals.len())?;
        let (rate, step_s) = (speed / width, 1.0 / header.sampling_hz);
        let mut driven = vec![Vec::new(); dofs.len()];
        for segment in &header.segments {
            let middle = signals.range(header.middle(segment, signals.len()))?;
            let motions = &middle[..dofs.len()];
            header.check_frequency(segment, motions)?;
            let k = ReducedFrequency::from_full_width(TAU * segment.frequency_hz / rate);
            for motion in driven_motions(motions) {
                driven[motion].push(ReducedFrequencyRange::between(k, k));
            }
        }
        if header.segments.is_empty() {
            driven = driven_bands(&signals, rate * step_s)?;
        }
        signals.check_clipping(&header.name, dofs)?;
        Ok(Self {
            header: header.clone(),
            signals,
            driven,
            rate,
            step_s,
        })
    }

    /// Sampling step in dimensionless time.
    pub(crate) fn delta_s(&self) -> f64 {
        self.rate * self.step_s
    }

    /// Subtracts the mean of each force over the record; returns the means, dimensionless.
    fn remove_means(&mut self) -> Result<Vec<f64>> {
        let (dofs, rows) = (self.signals.dofs(), self.signals.len());
        let mut means = vec![0.0; dofs];
        self.signals.for_each_block(|block| {
            for (sum, force) in means.iter_mut().zip(&block.channels[dofs..]) {
                let parts = force.chunks(BLOCK_ROWS).map(|c| c.iter().sum::<f64>());
                *sum = parts.fold(*sum, |sum, part| sum + part);
            }
            Ok(())
        })?;
        let count = f64::max(rows as f64, 1.0);
        means.iter_mut().for_each(|m| *m /= count);
        self.signals.change(|block| {
            for (mean, force) in means.iter().zip(&mut block.channels[dofs..]) {
                force.iter_mut().for_each(|x| *x -= mean);
            }
        })?;
        Ok(means)
    }

    /// The signals at the dimensionless step `delta_s` where that is longer than the record's own, and the step of either in
    /// seconds.
    pub(crate) fn at_step(&self, delta_s: Option<f64>) -> Result<(Option<Signals>, f64)> {
        let ratio = delta_s.map_or(1.0, |d| d / self.delta_s());
        // a step equal but for rounding is the same step
        if ratio <= 1.0 + 1e-9 {
            return Ok((None, self.step_s));
        }
        let channels = self.signals.range(0..self.signals.len())?;
        let channels: Vec<Vec<f64>> = channels.iter().map(|c| resampled(c, ratio)).collect();
        let mut signals = Signals::new(self.signals.dofs());
        signals.extend(channels[0].len(), |c, k| channels[c][k])?;
        Ok((Some(signals.finish()?), self.step_s * ratio))
    }
}

impl Signals {
    /// Number of samples before any motion starts; all of them when none ever does.
    pub(crate) fn still_samples(&self) -> Result<usize> {
        let mut first: Option<Vec<f64>> = None;
        let mut largest = 0.0;
        let mut growing = Vec::new();
        self.for_each_block(|block| {
            let motions = &block.channels[..self.dofs()];
            let first = first.get_or_insert_with(|| motions.iter().map(|m| m[0]).collect());
            for from in (0..block.rows()).step_by(LOOKED_AT) {
                let part = from..block.rows().min(from + LOOKED_AT);
                let limit = GROWTH * largest;
                let grows = motions.iter().zip(&*first).map(|(m, x)| {
                    let beyond = |any, m: &f64| any | ((m - x).abs() > limit);
                    m[part.clone()].iter().fold(false, beyond)
                });
                // nearly all parts are passed over here
                if !grows.fold(false, |any, one| any | one) {
                    continue;
                }
                for k in part {
                    let each = motions.iter().zip(&*first).map(|(m, x)| (m[k] - x).abs());
                    let now = each.fold(0.0, f64::max);
                    if now > GROWTH * largest {
                        largest = now;
                        growing.push((block.first + k, now));
                    }
                }
            }
            Ok(())
        })?;
        let start = growing.iter().find(|(_, d)| *d > STILL * largest);
        Ok(start.map_or(self.len(), |(sample, _)| *sample))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signals(motion: Vec<Vec<f64>>) -> Signals {
        let mut writer = Signals::new(motion.len());
        let value = |c, k| motion.get(c).map_or(0.0, |m: &Vec<f64>| m[k]);
        writer.extend(motion[0].len(), value).unwrap();
        writer.finish().unwrap()
    }

    fn still(motion: Vec<Vec<f64>>) -> usize {
        signals(motion).still_samples().unwrap()
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
