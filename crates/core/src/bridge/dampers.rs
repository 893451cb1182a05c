//! Tuned mass dampers and viscous links.

use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// A point of the girder, and the motion there that a damper follows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DampedPoint {
    /// Place of the node in [`Bridge::nodes`](super::Bridge::nodes).
    pub node: usize,
    /// The motion.
    pub motion: Dof,
    /// Distance from the axis of the node, m, positive downwind; of vertical motion, to which the rotation adds.
    pub offset_m: f64,
}

/// A tuned mass damper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MassDamper {
    /// Name in tables and descriptions.
    pub name: String,
    /// Where it hangs.
    pub at: DampedPoint,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Natural frequency while the girder is held, Hz.
    pub frequency_hz: f64,
    /// Ratio to critical damping, as well.
    pub damping_ratio: f64,
}

/// A dashpot between two points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViscousLink {
    /// Name in tables and descriptions.
    pub name: String,
    /// One end.
    pub at: DampedPoint,
    /// The other; none for the ground.
    pub to: Option<DampedPoint>,
    /// Force over speed, N·s/m; of rotations N·m·s/rad.
    pub coefficient: f64,
}

/// The dampers of a bridge.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dampers {
    /// Tuned mass dampers, each a coordinate behind those of the modes.
    pub masses: Vec<MassDamper>,
    /// Viscous links.
    pub links: Vec<ViscousLink>,
}

impl Dampers {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.masses.is_empty() && self.links.is_empty()
    }
}
