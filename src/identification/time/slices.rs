//! A record as a stream of dimensionless slices: checked, scaled, resampled where asked, cut where its chunks end.

use super::spectrum::BandEstimate;
use crate::error::{Error, Result, positive};
use crate::identification::basis::index_of;
use crate::identification::least_squares::BLOCK_ROWS;
use crate::section::Dof;
use crate::signal::Resampler;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::wind_tunnel::{RecordBlock, RecordSource, Segment};

/// A record with the factors that make it dimensionless.
pub(crate) struct Scaled<'a> {
    record: &'a dyn RecordSource,
    /// Channel of each degree of freedom of the model.
    channels: Vec<usize>,
    motion_scale: Vec<f64>,
    force_scale: Vec<f64>,
    /// Subtracted from each dimensionless force.
    offset: Vec<f64>,
    /// `V/B`, 1/s.
    pub rate: f64,
    /// Sampling step, s.
    pub step_s: f64,
}

/// Consecutive samples, at most [`BLOCK_ROWS`], one slice a degree of freedom.
pub(crate) struct Slice<'a> {
    pub motion: Vec<&'a [f64]>,
    pub force: Vec<&'a [f64]>,
    /// Index of the first sample in the (resampled) record.
    pub first: usize,
}

impl Slice<'_> {
    /// Number of samples.
    pub fn rows(&self) -> usize {
        self.motion[0].len()
    }
}

/// What a stream reports.
pub(crate) enum Event<'a> {
    Samples(Slice<'a>),
    /// A boundary has been reached; the end of the record is not one.
    Boundary,
}

/// Checks the headers and finds the degrees of freedom, in the order of every matrix of the crate.
///
/// # Errors
/// [`Error::Input`] naming the record and the value that cannot be, or for records of different degrees of freedom.
pub(crate) fn scale_all<'a>(
    records: &[&'a dyn RecordSource],
) -> Result<(Vec<Dof>, Vec<Scaled<'a>>)> {
    let first = records
        .first()
        .ok_or_else(|| Error::input("records", "at least one", "none"))?;
    let mut dofs = first.header().dofs.clone();
    dofs.sort();
    dofs.dedup();
    let scaled = records
        .iter()
        .map(|r| Scaled::new(*r, &dofs))
        .collect::<Result<_>>()?;
    Ok((dofs, scaled))
}

impl<'a> Scaled<'a> {
    fn new(record: &'a dyn RecordSource, dofs: &[Dof]) -> Result<Self> {
        let header = record.header();
        let place = |key: &str| format!("record {}: {key}", header.name);
        let width = positive(&place("width_m"), header.width_m)?;
        let density = positive(&place("air_density_kg_m3"), header.air_density_kg_m3)?;
        let speed = positive(&place("mean_speed_m_s"), header.mean_speed_m_s)?;
        let sampling = positive(&place("sampling_hz"), header.sampling_hz)?;
        for segment in &header.segments {
            positive(&place("segments: frequency_hz"), segment.frequency_hz)?;
        }
        let channels = dofs
            .iter()
            .map(|d| index_of(&header.dofs, *d, &place("dofs")))
            .collect::<Result<Vec<_>>>()?;
        if header.dofs.len() != dofs.len() || dofs.is_empty() {
            return Err(Error::input(
                place("dofs"),
                format!("{dofs:?}, each once, as in the first record"),
                format!("{:?}", header.dofs),
            ));
        }
        let pressure = 0.5 * density * speed * speed;
        Ok(Self {
            record,
            channels,
            motion_scale: dofs.iter().map(|d| d.motion_scale(width)).collect(),
            force_scale: dofs
                .iter()
                .map(|d| 1.0 / (pressure * d.force_scale(width)))
                .collect(),
            offset: vec![0.0; dofs.len()],
            rate: speed / width,
            step_s: 1.0 / sampling,
        })
    }

    /// Name of the record.
    pub fn name(&self) -> &str {
        &self.record.header().name
    }

    /// Mean wind speed, m/s.
    pub fn mean_speed_m_s(&self) -> f64 {
        self.record.header().mean_speed_m_s
    }

    /// Sampling step in dimensionless time.
    pub fn delta_s(&self) -> f64 {
        self.rate * self.step_s
    }

    /// Stretches of harmonic motion that the record states.
    pub fn segments(&self) -> &'a [Segment] {
        &self.record.header().segments
    }

    /// Instants (s) at which one segment gives way to the next.
    pub fn segment_starts(&self) -> Vec<f64> {
        let segments = &self.record.header().segments;
        segments.iter().skip(1).map(|s| s.start_s).collect()
    }

    /// Reduced frequencies of the segments; for other motions the band that holds their power.
    ///
    /// # Errors
    /// Those of reading.
    pub fn tested_range(&self) -> Result<Option<ReducedFrequencyRange>> {
        let segments = &self.record.header().segments;
        if !segments.is_empty() {
            let k =
                |f: f64| ReducedFrequency::from_full_width(std::f64::consts::TAU * f / self.rate);
            return Ok(ReducedFrequencyRange::spanning(
                segments.iter().map(|s| k(s.frequency_hz)),
            ));
        }
        let mut estimate = BandEstimate::new(self.channels.len());
        self.stream(None, &[], &mut |event| {
            if let Event::Samples(slice) = event {
                estimate.take(&slice);
            }
            Ok(())
        })?;
        let k = |per_sample: f64| ReducedFrequency::from_full_width(per_sample / self.delta_s());
        Ok(estimate
            .band()
            .and_then(|(low, high)| ReducedFrequencyRange::spanning([k(low), k(high)])))
    }

    /// Subtracts the mean of each force over the record from now on; returns the means, dimensionless.
    ///
    /// # Errors
    /// Those of reading.
    pub fn remove_means(&mut self) -> Result<Vec<f64>> {
        let mut sums = vec![0.0; self.channels.len()];
        let mut rows = 0;
        self.stream(None, &[], &mut |event| {
            if let Event::Samples(slice) = event {
                rows += slice.rows();
                for (sum, force) in sums.iter_mut().zip(&slice.force) {
                    *sum += force.iter().sum::<f64>();
                }
            }
            Ok(())
        })?;
        self.offset = sums
            .iter()
            .map(|s| s / f64::max(rows as f64, 1.0))
            .collect();
        Ok(self.offset.clone())
    }

    /// Streams the record at its own step, or at the dimensionless step `delta_s` if that is longer; `boundaries_s`
    /// (increasing, s) are reported between the slices they separate.
    ///
    /// # Errors
    /// Those of reading and of `f`; [`Error::Input`] for channels of different lengths and samples that are not finite.
    pub fn stream(
        &self,
        delta_s: Option<f64>,
        boundaries_s: &[f64],
        f: &mut dyn FnMut(Event<'_>) -> Result<()>,
    ) -> Result<()> {
        let n = self.channels.len();
        let ratio = delta_s.map_or(1.0, |d| d / self.delta_s());
        // a step equal but for rounding is the same step
        let mut resampler = (ratio > 1.0 + 1e-9).then(|| Resampler::new(ratio, 2 * n));
        let step_out = self.step_s * if resampler.is_some() { ratio } else { 1.0 };
        let mut cutter = Cutter {
            boundaries: boundaries_s
                .iter()
                .map(|t| (t / step_out).ceil().max(0.0) as usize)
                .collect(),
            index: 0,
        };
        let mut scaled = vec![Vec::with_capacity(BLOCK_ROWS); 2 * n];
        let mut resampled = vec![Vec::with_capacity(BLOCK_ROWS); 2 * n];
        let mut read = 0;
        self.record.for_each_block(&mut |block| {
            let rows = self.check(&block, read)?;
            let mut at = 0;
            while at < rows {
                let count = (rows - at).min(BLOCK_ROWS);
                self.scale(&block, at, count, read, &mut scaled)?;
                let channels = match &mut resampler {
                    Some(resampler) => {
                        resampler.push(&scaled, &mut resampled);
                        &resampled
                    }
                    None => &scaled,
                };
                cutter.pass_on(channels, f)?;
                at += count;
            }
            read += rows;
            Ok(())
        })
    }

    fn check(&self, block: &RecordBlock<'_>, read: usize) -> Result<usize> {
        let n = self.channels.len();
        let rows = block.motion.first().map_or(0, Vec::len);
        let mut channels = block.motion.iter().chain(block.force);
        if block.motion.len() != n || block.force.len() != n || channels.any(|c| c.len() != rows) {
            return Err(Error::input(
                format!("record {}, from sample {read}", self.name()),
                format!("{n} motions and {n} forces of one length"),
                "channels of another number or length",
            ));
        }
        Ok(rows)
    }

    fn scale(
        &self,
        block: &RecordBlock<'_>,
        at: usize,
        count: usize,
        read: usize,
        out: &mut [Vec<f64>],
    ) -> Result<()> {
        let n = self.channels.len();
        for (i, &channel) in self.channels.iter().enumerate() {
            let (motion, force) = (&block.motion[channel], &block.force[channel]);
            for (to, from, (factor, offset), what) in [
                (i, motion, (self.motion_scale[i], 0.0), "motion"),
                (n + i, force, (self.force_scale[i], self.offset[i]), "force"),
            ] {
                out[to].clear();
                let samples = &from[at..at + count];
                out[to].extend(samples.iter().map(|x| factor * x - offset));
                if let Some(bad) = out[to].iter().position(|x| !x.is_finite()) {
                    return Err(Error::input(
                        format!("record {}, {what}, sample {}", self.name(), read + at + bad),
                        "a finite number",
                        from[at + bad].to_string(),
                    ));
                }
            }
        }
        Ok(())
    }
}

/// Cuts slices at boundaries.
struct Cutter {
    boundaries: Vec<usize>,
    index: usize,
}

impl Cutter {
    fn pass_on(
        &mut self,
        channels: &[Vec<f64>],
        f: &mut dyn FnMut(Event<'_>) -> Result<()>,
    ) -> Result<()> {
        let (motion, force) = channels.split_at(channels.len() / 2);
        let rows = channels[0].len();
        let mut at = 0;
        while at < rows {
            while self.boundaries.first() == Some(&self.index) {
                self.boundaries.remove(0);
                f(Event::Boundary)?;
            }
            let to_boundary = self.boundaries.first().map_or(rows, |b| b - self.index);
            let count = (rows - at).min(to_boundary);
            f(Event::Samples(Slice {
                motion: motion.iter().map(|c| &c[at..at + count]).collect(),
                force: force.iter().map(|c| &c[at..at + count]).collect(),
                first: self.index,
            }))?;
            at += count;
            self.index += count;
        }
        Ok(())
    }
}
