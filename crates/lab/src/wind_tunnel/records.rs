//! Forced-vibration records: sampled motion and self-excited force of a section model.

use crate::error::{Place, Result, ensure};
use crate::section::Dof;
use serde::{Deserialize, Serialize};
use std::fmt::Display;

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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
}

/// A run of samples, one slice per channel in the order of [`RecordHeader::dofs`], all of one length.
#[derive(Debug, Clone, Copy)]
pub struct RecordBlock<'a> {
    /// Motion: m, rad.
    pub motion: &'a [Vec<f64>],
    /// Self-excited force per unit length: N/m, N·m/m.
    pub force: &'a [Vec<f64>],
}

/// Something that yields a record block by block, as often as asked, in bounded memory.
pub trait RecordSource: Sync {
    /// Everything but the samples.
    fn header(&self) -> &RecordHeader;

    /// Calls `f` with consecutive blocks from the first sample to the last.
    fn for_each_block(&self, f: &mut dyn FnMut(RecordBlock<'_>) -> Result<()>) -> Result<()>;
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
    /// All of a source, in memory.
    pub fn whole(source: &dyn RecordSource) -> Result<Self> {
        let header = source.header().clone();
        let mut motion = vec![Vec::new(); header.dofs.len()];
        let mut force = motion.clone();
        source.for_each_block(&mut |block| {
            let parts = block.motion.iter().chain(block.force);
            for (all, part) in motion.iter_mut().chain(&mut force).zip(parts) {
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

    fn for_each_block(&self, f: &mut dyn FnMut(RecordBlock<'_>) -> Result<()>) -> Result<()> {
        f(RecordBlock {
            motion: &self.motion,
            force: &self.force,
        })
    }
}
