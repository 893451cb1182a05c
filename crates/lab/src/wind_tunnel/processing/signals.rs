//! Motion and force of the section as they go through the stages, and the records that they become.

use super::options::Ramps;
use crate::section::Dof;
use crate::signal::Plateau;
use crate::wind_tunnel::{RawCampaign, RawRun, Record, RecordHeader, Segment};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Place of a degree of freedom in the arrays of a [`SectionSignals`], that of [`Dof::THREE`].
pub fn index(dof: Dof) -> usize {
    dof as usize
}

/// A stretch with one frequency, and its steady part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HarmonicSegment {
    /// Frequency, first and last instant, ramps included.
    pub segment: Segment,
    /// Whole periods at full amplitude.
    pub plateau: Plateau,
}

impl HarmonicSegment {
    /// Name of the record of this segment alone, of a run.
    pub fn record_name(&self, run: &str) -> String {
        format!("{run}-{:.3}Hz", self.segment.frequency_hz)
    }

    /// Samples of the whole segment in a recording of `count` samples.
    pub(crate) fn range(&self, sampling_hz: f64, count: usize) -> Range<usize> {
        let at = |t: f64| ((t * sampling_hz).round().max(0.0) as usize).min(count);
        at(self.segment.start_s)..at(self.segment.end_s)
    }
}

/// The highest frequency of segments, Hz; zero of none.
pub(super) fn highest_hz(segments: &[HarmonicSegment]) -> f64 {
    let frequencies = segments.iter().map(|s| s.segment.frequency_hz);
    frequencies.fold(0.0, f64::max)
}

/// Motion of the section and force on the cells by the whole model, each vertical, lateral, torsion; of one length.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionSignals {
    /// Sampling frequency, Hz.
    pub sampling_hz: f64,
    /// Motion: m, m, rad; zeros where it was not recorded.
    pub motion: [Vec<f64>; 3],
    /// Force: N, N, N·m.
    pub force: [Vec<f64>; 3],
}

impl SectionSignals {
    /// Number of samples.
    pub(crate) fn len(&self) -> usize {
        self.force[0].len()
    }
}

/// One record of the run, or one per segment when ramps are cut.
pub(super) fn records(
    campaign: &RawCampaign,
    dofs: &[Dof],
    signals: &SectionSignals,
    segments: &[HarmonicSegment],
    run: &RawRun,
    ramps: Ramps,
) -> Vec<Record> {
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
    let part = |range: Range<usize>, header: RecordHeader| {
        let of = |all: &[Vec<f64>; 3]| -> Vec<Vec<f64>> {
            let channels = dofs.iter().map(|d| &all[index(*d)]);
            channels.map(|x| x[range.clone()].to_vec()).collect()
        };
        let (motion, mut force) = (of(&signals.motion), of(&signals.force));
        force.iter_mut().flatten().for_each(|f| *f /= length);
        Record {
            header,
            motion,
            force,
        }
    };
    match ramps {
        Ramps::Keep => {
            let all = segments.iter().map(|s| s.segment).collect();
            vec![part(0..signals.len(), header(run.name.clone(), all))]
        }
        Ramps::Cut => {
            let record = |s: &HarmonicSegment| {
                let whole = Segment {
                    frequency_hz: s.segment.frequency_hz,
                    start_s: 0.0,
                    end_s: s.plateau.samples as f64 / signals.sampling_hz,
                };
                let header = header(s.record_name(&run.name), vec![whole]);
                part(s.plateau.range(), header)
            };
            segments.iter().map(record).collect()
        }
    }
}
