//! Forces on the whole section in place of load cells, as a computation has them.

use super::channel::{CellChannel, ChannelRef};
use crate::section::Dof;
use crate::wind_tunnel::{CELL_CHANNELS, LoadCell};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Name of the cell that stands for them.
pub(super) const CELL: &str = "section";
/// Its channels that are measured, the force in each, and its sign: the nose-up moment is one about −z.
const CHANNELS: [(&str, Dof, f64); 3] = [
    ("fx", Dof::Lateral, 1.0),
    ("fy", Dof::Vertical, 1.0),
    ("mz", Dof::Torsion, -1.0),
];

/// Forces of the wind on the section, without inertia, about the centre of rotation; at least one.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SectionForces {
    /// Lift, positive up.
    pub lift: Option<ChannelRef>,
    /// Drag, positive downwind.
    pub drag: Option<ChannelRef>,
    /// Pitching moment, positive nose-up.
    pub moment: Option<ChannelRef>,
}

impl SectionForces {
    /// The cell that measures them: global axes, at the centre of rotation.
    pub(super) fn cell() -> LoadCell {
        LoadCell {
            name: CELL.to_owned(),
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            position_m: [0.0; 3],
            turns_with_model: false,
        }
    }

    fn channel(&self, dof: Dof) -> Option<&ChannelRef> {
        match dof {
            Dof::Vertical => self.lift.as_ref(),
            Dof::Lateral => self.drag.as_ref(),
            Dof::Torsion => self.moment.as_ref(),
        }
    }

    /// Degrees of freedom whose force there is.
    pub(crate) fn dofs(&self) -> Vec<Dof> {
        let has = |d: &Dof| self.channel(*d).is_some();
        Dof::THREE.into_iter().filter(has).collect()
    }

    /// The channels of that cell.
    pub(super) fn channels(&self) -> BTreeMap<String, CellChannel> {
        let measured = |key: &str| {
            let (_, dof, sign) = CHANNELS.iter().find(|(name, ..)| *name == key)?;
            let own = self.channel(*dof)?.clone();
            let scale = sign * own.scale;
            Some(CellChannel::Measured(ChannelRef { scale, ..own }))
        };
        let channel = |key: &str| {
            let channel = measured(key).unwrap_or(CellChannel::NotMeasured);
            (key.to_owned(), channel)
        };
        CELL_CHANNELS.into_iter().map(channel).collect()
    }

    /// The key of the campaign file behind a channel of that cell.
    pub(super) fn key(channel: &str) -> String {
        let named = CHANNELS.iter().find(|(name, ..)| *name == channel);
        let dof = named.map_or(Dof::Torsion, |(_, dof, _)| *dof);
        format!("channels.section.{}", dof.force_name())
    }
}
