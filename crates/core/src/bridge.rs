//! The whole bridge: nodes along the girder, modes, and strips of one section in one wind.
//!
//! A mode `m` has a generalised mass `M_m`, a frequency, a damping ratio and the shape `φ_m(i) = (vertical, lateral, rotation)` at
//! node `i`, signs as everywhere in this crate. With the tributary length `w_i`, the section and the wind `p_i V` of node `i` the
//! self-excited force on the modal coordinates `η` is
//!
//! ```text
//! Q = Σ_i w_i Φ_iᵀ ½ρ(p_i V)² diag(B, B, B²) G(ωB/(p_i V)) diag(1/B, 1/B, 1) Φ_i η
//! ```
//!
//! Nodes of one section in one wind are a group; for a group the sums over nodes are done once, and what follows
//! (`modal`) is a structure in generalised coordinates with a force model of as many rows: coupling, flutter, response and
//! FMU treat it as they treat a section. A section is the bridge of one node of unit length with unit shapes
//! ([`Bridge::of_section`]).

mod banks;
mod damped;
mod dampers;
mod modal;

pub use dampers::{DampedPoint, Dampers, MassDamper, ViscousLink};
pub use modal::ModalForces;

use crate::aerodynamics::Transfer;
use crate::error::{Error, Result, counted, ensure, finite, non_negative, positive};
use crate::section::SectionModel;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A point of the girder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Node {
    /// Name in the model it comes from, usually a number.
    pub name: String,
    /// Place along the girder, m, rising from node to node.
    pub along_m: f64,
    /// Length of girder whose wind forces act at this node, m.
    pub length_m: f64,
}

/// A natural mode of the structure without wind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BridgeMode {
    /// Number in the model it comes from.
    pub number: usize,
    /// Natural frequency, Hz.
    pub frequency_hz: f64,
    /// Generalised mass that belongs to the shape as it is scaled, kg (kg·m² for shapes scaled by a rotation).
    pub generalised_mass: f64,
    /// Ratio to critical damping.
    pub damping_ratio: f64,
    /// Vertical (up), lateral (downwind) displacement and rotation (nose-up) at each node, per unit of the modal coordinate.
    pub shape: Vec<[f64; 3]>,
}

/// Wind somewhere over the wind speed of the bridge at most: the top of a tower or a ridge has less, per cent are more.
pub const MOST_WIND_FACTOR: f64 = 3.0;

/// Nodes of one section in one wind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StripGroup<Forces = Arc<dyn Transfer>> {
    /// Name of the section.
    pub name: String,
    /// Width `B`, m.
    pub width_m: f64,
    /// Wind speed there over the wind speed of the bridge.
    pub wind_factor: f64,
    /// Places of the nodes in [`Bridge::nodes`].
    pub nodes: Vec<usize>,
    /// Self-excited forces, about the axis of rotation of the nodes; in files their place among those of the bridge.
    pub forces: Forces,
}

impl<Forces> StripGroup<Forces> {
    /// The same nodes in other forces.
    pub fn with_forces<Others>(&self, forces: Others) -> StripGroup<Others> {
        StripGroup {
            name: self.name.clone(),
            width_m: self.width_m,
            wind_factor: self.wind_factor,
            nodes: self.nodes.clone(),
            forces,
        }
    }
}

/// A bridge in the wind.
#[derive(Debug, Clone)]
pub struct Bridge {
    /// Name in tables and figures.
    pub name: String,
    /// Air density `ρ`, kg/m³.
    pub air_density_kg_m3: f64,
    /// Nodes along the girder.
    pub nodes: Vec<Node>,
    /// Modes that take part.
    pub modes: Vec<BridgeMode>,
    /// Groups of nodes; each node is in one group at most, and without forces outside of them.
    pub groups: Vec<StripGroup>,
    /// Dampers, see [`Bridge::with_dampers`].
    pub dampers: Dampers,
}

impl Bridge {
    /// A bridge after checking it.
    ///
    /// # Errors
    /// [`Error::Input`] for nodes that are not ordered, shapes that do not match the nodes, modes without mass or with a
    /// frequency that is not positive, groups that claim one node twice, and wind that blows nowhere.
    pub fn new(
        name: impl Into<String>,
        air_density_kg_m3: f64,
        nodes: Vec<Node>,
        modes: Vec<BridgeMode>,
        groups: Vec<StripGroup>,
    ) -> Result<Self> {
        let bridge = Self {
            name: name.into(),
            air_density_kg_m3,
            nodes,
            modes,
            groups,
            dampers: Dampers::default(),
        };
        positive("air_density_kg_m3", air_density_kg_m3)?;
        check_nodes(&bridge.nodes)?;
        let has_modes = !bridge.modes.is_empty();
        ensure(has_modes, "modes", "at least one mode", "none")?;
        for mode in &bridge.modes {
            check_mode(mode, bridge.nodes.len())?;
        }
        bridge.check_groups()?;
        Ok(bridge)
    }

    /// The section as a bridge of one node of a metre with unit shapes.
    ///
    /// # Errors
    /// [`Error::Input`] for a section that is wrong, or whose axis or centre of mass is off mid-chord: its motions are no
    /// modes.
    pub fn of_section(section: &SectionModel, forces: Arc<dyn Transfer>) -> Result<Self> {
        let s = section.structure()?;
        ensure(
            s.axis_offset_m == 0.0 && section.static_coupling() == 0.0,
            "section",
            "motions that are its modes",
            "an offset of axis or mass",
        )?;
        let mode = |i: usize| {
            let (m, k) = (s.mass[(i, i)], s.stiffness[(i, i)]);
            let mut shape = [0.0; 3];
            shape[s.dofs[i] as usize] = 1.0;
            BridgeMode {
                number: i + 1,
                frequency_hz: (k / m).sqrt() / TAU,
                generalised_mass: m,
                damping_ratio: s.damping[(i, i)] / (2.0 * (k * m).sqrt()),
                shape: vec![shape],
            }
        };
        let group = StripGroup {
            name: "section".to_owned(),
            width_m: s.width_m,
            wind_factor: 1.0,
            nodes: vec![0],
            forces,
        };
        let node = Node {
            name: "1".to_owned(),
            along_m: 0.0,
            length_m: 1.0,
        };
        let modes = (0..s.dofs.len()).map(mode).collect();
        let (nodes, groups) = (vec![node], vec![group]);
        Self::new("section", s.air_density_kg_m3, nodes, modes, groups)
    }

    /// Width to which reduced frequencies of the bridge refer: that of the first group, m.
    pub fn width_m(&self) -> f64 {
        self.groups[0].width_m
    }

    /// Names of the coordinates: `mode 23`, then those of dampers.
    pub fn mode_names(&self) -> Vec<String> {
        let modes = self.modes.iter().map(|m| format!("mode {}", m.number));
        let masses = self.dampers.masses.iter().map(|d| d.name.clone());
        modes.chain(masses).collect()
    }

    /// Displacements and rotations of the mass-normalised modes at some nodes: three rows per node, one column per coordinate; those of
    /// dampers move no node.
    pub fn shapes_at(&self, nodes: &[usize]) -> DMatrix<f64> {
        DMatrix::from_fn(3 * nodes.len(), self.coordinates(), |row, m| {
            self.modes.get(m).map_or(0.0, |mode| {
                mode.shape[nodes[row / 3]][row % 3] / mode.generalised_mass.sqrt()
            })
        })
    }

    fn check_groups(&self) -> Result<()> {
        let has_groups = !self.groups.is_empty();
        ensure(has_groups, "section", "at least one section", "none")?;
        let mut owner: Vec<Option<&str>> = vec![None; self.nodes.len()];
        for group in &self.groups {
            let place = format!("section {}", group.name);
            positive(format!("{place}: width_m"), group.width_m)?;
            non_negative(format!("{place}: wind factor"), group.wind_factor)?;
            ensure(
                group.wind_factor <= MOST_WIND_FACTOR,
                format_args!("{place}: wind factor"),
                format_args!("at most {MOST_WIND_FACTOR}"),
                group.wind_factor,
            )?;
            for &node in &group.nodes {
                let claimed = owner.get_mut(node).ok_or_else(|| {
                    Error::input(&place, "nodes of the bridge", format!("node {node}"))
                })?;
                if let Some(other) = claimed.replace(&group.name) {
                    return Err(Error::input(
                        place,
                        "each node in one section",
                        format!("node {} also in section {other}", self.nodes[node].name),
                    ));
                }
            }
        }
        let blown = |g: &StripGroup| g.wind_factor > 0.0 && !g.nodes.is_empty();
        let (wind, expected) = (
            self.groups.iter().any(blown),
            "wind somewhere along the bridge",
        );
        ensure(wind, "wind profile", expected, "zero everywhere")
    }

    /// The motion that carries the largest part of a mode's sum of squares: 0 vertical, 1 lateral, 2 rotation, which
    /// counts with half the width; `None` of a shape that is zero everywhere.
    pub fn main_motion(&self, mode: &BridgeMode) -> Option<usize> {
        let scale = [1.0, 1.0, 0.5 * self.width_m()];
        let parts: [f64; 3] = std::array::from_fn(|i| {
            let nodes = self.nodes.iter().zip(&mode.shape);
            let squares = nodes.map(|(node, s)| node.length_m * (scale[i] * s[i]).powi(2));
            squares.sum()
        });
        let moving = (0..3).filter(|i| parts[*i] > 0.0);
        moving.max_by(|a, b| parts[*a].total_cmp(&parts[*b]))
    }
}

fn check_nodes(nodes: &[Node]) -> Result<()> {
    ensure(!nodes.is_empty(), "nodes", "at least one node", "none")?;
    let mut before: Option<&Node> = None;
    for node in nodes {
        let place = format!("node {}", node.name);
        finite(format!("{place}: place along the bridge"), node.along_m)?;
        positive(format!("{place}: tributary length"), node.length_m)?;
        if let Some(b) = before.filter(|b| b.along_m >= node.along_m) {
            return Err(Error::input(
                place,
                format!(
                    "a place along the bridge beyond {} m, that of node {}",
                    b.along_m, b.name
                ),
                format!("{} m", node.along_m),
            ));
        }
        before = Some(node);
    }
    Ok(())
}

fn check_mode(mode: &BridgeMode, nodes: usize) -> Result<()> {
    let place = format_args!("mode {}", mode.number);
    positive(format!("{place}: frequency_hz"), mode.frequency_hz)?;
    positive(format!("{place}: generalised mass"), mode.generalised_mass)?;
    non_negative(format!("{place}: damping_ratio"), mode.damping_ratio)?;
    ensure(
        mode.shape.len() == nodes,
        place,
        format_args!("a shape at {}", counted(nodes, "node")),
        counted(mode.shape.len(), "node"),
    )?;
    ensure(
        mode.shape.iter().flatten().all(|x| x.is_finite()),
        place,
        "finite displacements",
        "one that is not",
    )
}
