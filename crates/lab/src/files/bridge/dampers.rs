//! `[[damper]]` of a bridge file: tuned mass dampers, and viscous links between nodes or to the ground.

use super::modal_data::BridgeModes;
use crate::bridge::{DampedPoint, Dampers, MassDamper, ViscousLink};
use crate::error::{Error, Result, non_negative, positive};
use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// A damper at a node: a mass with `mass_kg`, `frequency_hz` and `damping_ratio`, or a link with `coefficient`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DamperBlock {
    /// Name of the node.
    pub node: String,
    /// What it acts against. A mass against `torsion` is a pair: half of it on either side, each moving up and down.
    pub motion: Dof,
    /// Distance of the halves of a pair from the axis of the node, m.
    pub arm_m: Option<f64>,
    /// Mass, of a pair both together, kg.
    pub mass_kg: Option<f64>,
    /// Natural frequency while the girder is held, Hz.
    pub frequency_hz: Option<f64>,
    /// Ratio to critical damping.
    pub damping_ratio: Option<f64>,
    /// Force of a link over its speed, N·s/m; against torsion N·m·s/rad.
    pub coefficient: Option<f64>,
    /// Name of the node at the other end of a link; left out, the ground.
    pub to: Option<String>,
}

impl DamperBlock {
    pub(super) fn validate(&self, place: &str) -> Result<()> {
        let is_link = self.coefficient.is_some();
        let is_pair = !is_link && self.motion == Dof::Torsion;
        let refused = |key: &str, expected: &str, is_there: bool| {
            let found = if is_there { "one" } else { "none" };
            Err(Error::input(format!("{place}.{key}"), expected, found))
        };
        let of_mass = [
            ("mass_kg", self.mass_kg),
            ("frequency_hz", self.frequency_hz),
            ("damping_ratio", self.damping_ratio),
        ];
        if let Some((key, value)) = of_mass.iter().find(|(_, v)| v.is_some() == is_link) {
            let expected = match is_link {
                true => "none beside the `coefficient` of a link",
                false => "mass_kg, frequency_hz and damping_ratio, or the `coefficient` of a link",
            };
            return refused(key, expected, value.is_some());
        }
        if self.to.is_some() && !is_link {
            let expected = "none: only links, of a `coefficient`, have two ends";
            return refused("to", expected, true);
        }
        if self.arm_m.is_some() != is_pair {
            let expected = match is_pair {
                true => "the distance of both halves of the mass from the axis",
                false => "none: only a mass against torsion has two halves",
            };
            return refused("arm_m", expected, !is_pair);
        }
        let key = |of: &str| format!("{place}.{of}");
        for (of, value) in [of_mass[0], of_mass[1], ("arm_m", self.arm_m)] {
            value.map(|x| positive(key(of), x)).transpose()?;
        }
        for (of, value) in [of_mass[2], ("coefficient", self.coefficient)] {
            value.map(|x| non_negative(key(of), x)).transpose()?;
        }
        Ok(())
    }

    /// Adds what the block stands for; `place` is that of the block.
    pub(super) fn add(&self, place: &str, modes: &BridgeModes, all: &mut Dampers) -> Result<()> {
        let point = |key: &str, name: &str, motion: Dof, offset_m: f64| {
            let node = modes.index_of(format!("{place}.{key}"), name)?;
            Ok::<_, Error>(DampedPoint {
                node,
                motion,
                offset_m,
            })
        };
        if let Some(coefficient) = self.coefficient {
            let other = self.to.as_ref();
            let to = other.map(|name| point("to", name, self.motion, 0.0));
            let to = to.transpose()?;
            let end = other.map_or("the ground".to_owned(), |n| format!("node {n}"));
            let (number, node) = (all.links.len() + 1, &self.node);
            all.links.push(ViscousLink {
                name: format!("link {number} from node {node} to {end}"),
                at: point("node", node, self.motion, 0.0)?,
                to,
                coefficient,
            });
            return Ok(());
        }
        let (motion, offsets) = match self.arm_m {
            Some(arm) => (Dof::Vertical, vec![-arm, arm]),
            None => (self.motion, vec![0.0]),
        };
        let given = |value: Option<f64>| value.unwrap_or(f64::NAN);
        for offset_m in &offsets {
            all.masses.push(MassDamper {
                name: format!("damper {} at node {}", all.masses.len() + 1, self.node),
                at: point("node", &self.node, motion, *offset_m)?,
                mass_kg: given(self.mass_kg) / offsets.len() as f64,
                frequency_hz: given(self.frequency_hz),
                damping_ratio: given(self.damping_ratio),
            });
        }
        Ok(())
    }
}
