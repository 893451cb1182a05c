//! Forced-vibration records: sampled motion and self-excited force of a section model.

use crate::error::{Place, Result, ensure, positive};
use crate::plausibility::unusual_air;
use crate::section::Dof;
use crate::signal::{fit_sine, largest_about_mean};
use serde::{Deserialize, Serialize};
use std::fmt::Display;
use std::ops::Range;

/// A stretch of a record with one frequency of motion, from rest to rest: with the ramps at its ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// Frequency of the motion, Hz.
    pub frequency_hz: f64,
    /// First instant, s from the start of the record.
    pub start_s: f64,
    /// Last instant, s from the start of the record.
    pub end_s: f64,
}

/// Run, section, air, wind speed and sampling of a record: everything but its samples.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordHeader {
    /// Name of the run.
    pub name: String,
    /// Degrees of freedom of motion and force, in the order of the channels.
    pub dofs: Vec<Dof>,
    /// Width of the section model, m.
    pub width_m: f64,
    /// Air density, kg/m³.
    pub air_density_kg_m3: f64,
    /// Mean wind speed, m/s.
    pub mean_speed_m_s: f64,
    /// Sampling frequency, Hz.
    pub sampling_hz: f64,
    /// Stretches of harmonic motion, in order; empty when the motion is something else.
    #[serde(default)]
    pub segments: Vec<Segment>,
    /// Where the record comes from.
    pub source: String,
    /// Licence of the data.
    pub licence: String,
}

/// In the middle of a segment, so many periods are looked at …
const PERIODS_LOOKED_AT: f64 = 8.0;
/// … of which a sine of the stated frequency must be this part of the variance: at 5.5 % off it is not.
const OF_ITS_FREQUENCY: f64 = 0.5;

/// Widths of records that differ by no more, relatively, are one.
const SAME_WIDTH: f64 = 1e-6;

impl RecordHeader {
    /// Refuses another width than `width_m`, m, which stands `where_it_stands`.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) at that place.
    pub fn check_width(
        &self,
        width_m: f64,
        place: impl Into<Place>,
        where_it_stands: impl Display,
    ) -> Result<()> {
        let same = (self.width_m / width_m - 1.0).abs() <= SAME_WIDTH;
        let expected = format_args!("{width_m} m, as {where_it_stands}");
        ensure(same, place, expected, format_args!("{} m", self.width_m))
    }

    /// Refuses channels from a sample on that are not those of the header, all of one length.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) naming the record.
    pub fn check_channels(&self, from: usize, are_its_own: bool) -> Result<()> {
        let (name, n) = (&self.name, self.dofs.len());
        let place = format_args!("record {name}, from sample {from}");
        let expected = format_args!("{n} motions and {n} forces of one length");
        let found = "channels of another number or length";
        ensure(are_its_own, place, expected, found)
    }

    /// Refuses segments that do not lie one after the other within `samples`.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) naming the record and the segment.
    pub fn check_ends(&self, samples: usize) -> Result<()> {
        let step_s = 1.0 / self.sampling_hz;
        let (mut free_s, last_s) = (0.0, samples as f64 * step_s);
        for s in &self.segments {
            positive(self.place(s), s.frequency_hz)?;
            let (start, end) = (s.start_s, s.end_s);
            let inside = start >= free_s - step_s && end > start && end <= last_s + step_s;
            let expected = format_args!(
                "a stretch of its own between {free_s} s and the end of the record at {last_s} s"
            );
            let found = format_args!("{start} s to {end} s");
            ensure(inside, self.place(s), expected, found)?;
            free_s = end;
        }
        Ok(())
    }

    /// Refuses segments that do not lie one after the other in the record, or whose frequency is not that of its `motions`.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) naming the record and the segment.
    pub fn check_segments(&self, motions: &[Vec<f64>]) -> Result<()> {
        self.check_ends(motions.first().map_or(0, Vec::len))?;
        self.segments.iter().try_for_each(|s| {
            let middle = |x: &Vec<f64>| x[self.middle(s, x.len())].to_vec();
            let middle: Vec<_> = motions.iter().map(middle).collect();
            self.check_frequency(s, &middle)
        })
    }

    /// The samples, of so many, that tell the frequency of a segment that lies within them.
    pub fn middle(&self, segment: &Segment, samples: usize) -> Range<usize> {
        let centre = 0.5 * (segment.start_s + segment.end_s);
        let half = 0.5 * PERIODS_LOOKED_AT / segment.frequency_hz;
        let at = |t: f64| ((t * self.sampling_hz) as usize).min(samples);
        at((centre - half).max(segment.start_s))..at((centre + half).min(segment.end_s))
    }

    /// Refuses a segment of whose [middle](Self::middle) no motion has the stated frequency.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) naming the record and the segment.
    pub fn check_frequency(&self, segment: &Segment, middle: &[Vec<f64>]) -> Result<()> {
        let moves = middle.iter().filter(|x| largest_about_mean(x) > 0.0);
        let mut moves = moves.peekable();
        let is_stated = |x: &Vec<f64>| {
            let fit = fit_sine(x, 0..x.len(), self.sampling_hz, segment.frequency_hz);
            fit.is_ok_and(|fit| {
                let sine = 0.5 * fit.fundamental().norm_sqr();
                sine >= OF_ITS_FREQUENCY * (sine + fit.residual_rms.powi(2))
            })
        };
        let holds = moves.peek().is_none() || moves.any(is_stated);
        let (place, stated) = (self.place(segment), segment.frequency_hz);
        let found = format_args!("{stated} Hz, which no motion has there");
        ensure(holds, place, "the frequency of the motion, to 5 %", found)
    }

    /// What is odd about the density of the air.
    pub fn odd_air(&self) -> Option<String> {
        let key = format!("record {}: air_density_kg_m3", self.name);
        unusual_air(&key, self.air_density_kg_m3).map(|odd| odd.to_string())
    }

    fn place(&self, Segment { frequency_hz, .. }: &Segment) -> String {
        format!("record {}: segment at {frequency_hz} Hz", self.name)
    }
}

/// Something that yields a record block by block, as often as asked, in bounded memory.
pub trait RecordSource: Sync {
    /// Everything but the samples.
    fn header(&self) -> &RecordHeader;

    /// Calls `f` with consecutive blocks from the first sample to the last: channels of one length, the motions (m, rad) and then the
    /// self-excited forces per unit length (N/m, N·m/m), each in the order of [`RecordHeader::dofs`].
    fn for_each_block(&self, f: &mut dyn FnMut(&[&[f64]]) -> Result<()>) -> Result<()>;
}

/// A record in memory.
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_lab::*; }
/// use aerodeck::files::derivatives::embedded;
/// use aerodeck::section::Dof;
/// use aerodeck::wind_tunnel::TunnelPlan;
///
/// let plan = TunnelPlan { sampling_hz: 50.0, segment_s: 12.0, ..TunnelPlan::default() };
/// let records = plan.records_from_table(&embedded::deck("LN21-5200")?, &Dof::TWO)?;
/// let record = &records[0];
/// assert_eq!(record.header.dofs, Dof::TWO);
/// assert_eq!(record.motion[0].len(), record.force[1].len());
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Everything but the samples.
    pub header: RecordHeader,
    /// Motion, one vector per degree of freedom: m, rad.
    pub motion: Vec<Vec<f64>>,
    /// Self-excited force per unit length, one vector per degree of freedom: N/m, N·m/m.
    pub force: Vec<Vec<f64>>,
}

impl Record {
    /// The degrees of freedom that move.
    pub fn moving(&self) -> impl Iterator<Item = Dof> {
        let channels = self.header.dofs.iter().zip(&self.motion);
        let moving = channels.filter(|(_, motion)| motion.iter().any(|x| *x != 0.0));
        moving.map(|(dof, _)| *dof)
    }

    /// All of a source, in memory.
    pub fn whole(source: &dyn RecordSource) -> Result<Self> {
        let header = source.header().clone();
        let mut motion = vec![Vec::new(); header.dofs.len()];
        let mut force = motion.clone();
        source.for_each_block(&mut |block| {
            for (all, part) in motion.iter_mut().chain(&mut force).zip(block) {
                all.extend_from_slice(part);
            }
            Ok(())
        })?;
        Ok(Self {
            header,
            motion,
            force,
        })
    }
}

impl RecordSource for Record {
    fn header(&self) -> &RecordHeader {
        &self.header
    }

    fn for_each_block(&self, f: &mut dyn FnMut(&[&[f64]]) -> Result<()>) -> Result<()> {
        self.header
            .check_channels(0, self.motion.len() == self.force.len())?;
        let channels = self.motion.iter().chain(&self.force);
        f(&channels.map(Vec::as_slice).collect::<Vec<_>>())
    }
}
