//! Records per unit length from the processed signals of a run.

use super::index;
use super::options::Ramps;
use super::segmentation::HarmonicSegment;
use super::signals::SectionSignals;
use crate::section::Dof;
use crate::wind_tunnel::{RawCampaign, RawRun, Record, RecordHeader, Segment};
use std::ops::Range;

/// One record of the run, or one a segment when ramps are cut.
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
    match ramps {
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
