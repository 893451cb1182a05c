//! Nodes and modes as finite-element programs write them, in axes of their own, and as the bridge takes them.

use crate::bridge::{BridgeMode, Node};
use crate::error::{Error, Result, ensure};
use crate::plausibility::{Finding, FindingKind, of_modes};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Directions closer to one line than this (cosine) are no two axes.
const SQUARE: f64 = 1e-6;

/// A direction: `x`, `-y`, `+z`, or three components.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "an axis (`x`, `-y`) or a direction of three numbers"
)]
pub enum Direction {
    /// An axis with its sign.
    Axis(String),
    /// Components, of any length.
    Vector([f64; 3]),
}

/// Up and downwind in the axes of the model; the wind blows square to the girder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WindAxes {
    /// Up.
    pub up: Direction,
    /// Where the wind blows to.
    pub downwind: Direction,
}

/// Takes directions of the model to up, downwind and along the girder, about which a right-handed rotation lifts the windward edge.
pub(super) type Frame = Matrix3<f64>;

impl Direction {
    fn unit(&self, place: &str) -> Result<Vector3<f64>> {
        let vector = match self {
            Self::Vector(v) => *v,
            Self::Axis(name) => {
                let (sign, letter) = match name.strip_prefix('-') {
                    Some(rest) => (-1.0, rest),
                    None => (1.0, name.strip_prefix('+').unwrap_or(name)),
                };
                let index = ["x", "y", "z"].iter().position(|a| *a == letter);
                let index = index.ok_or_else(|| {
                    Error::input(place, "x, y, z, -x, -y or -z", format!("`{name}`"))
                })?;
                let mut v = [0.0; 3];
                v[index] = sign;
                v
            }
        };
        let length = Vector3::from(vector).norm();
        let is_one = length > 0.0 && length.is_finite();
        let expected = "a direction of three finite numbers, not all zero";
        ensure(is_one, place, expected, format_args!("{vector:?}"))?;
        Ok(Vector3::from(vector) / length)
    }
}

impl WindAxes {
    /// The axes as unit vectors.
    ///
    /// # Errors
    /// [`Error::Input`] for directions that are none, or not square to each other.
    pub(super) fn frame(&self) -> Result<Frame> {
        let up = self.up.unit("modes.axes.up")?;
        let downwind = self.downwind.unit("modes.axes.downwind")?;
        let cosine = up.dot(&downwind);
        let (place, expected) = ("modes.axes.downwind", "a direction square to `up`");
        let found = format_args!("an angle with the cosine {cosine:.4}");
        ensure(cosine.abs() <= SQUARE, place, expected, found)?;
        // about a, the windward edge -d moves along a × (-d); that is up for a = up × d
        Ok(Matrix3::from_columns(&[up, downwind, up.cross(&downwind)]).transpose())
    }
}

/// Vertical, lateral displacement and rotation of displacements and rotations along the axes of the model.
pub(super) fn motion(frame: &Frame, u: &[f64; 6]) -> [f64; 3] {
    let [x, y, z, rotation @ ..] = *u;
    let translation = frame * Vector3::new(x, y, z);
    let rotation = frame * Vector3::from(rotation);
    [translation.x, translation.y, rotation.z]
}

/// A mode with displacements and rotations along the axes of the model; its damping is not known.
pub(super) fn mode(
    frame: &Frame,
    number: usize,
    frequency_hz: f64,
    generalised_mass: f64,
    shape: &[[f64; 6]],
) -> BridgeMode {
    BridgeMode {
        number,
        frequency_hz,
        generalised_mass,
        damping_ratio: 0.0,
        shape: shape.iter().map(|u| motion(frame, u)).collect(),
    }
}

/// Name of each node, and its place in x, y, z of the program, m.
pub(super) type PlacedNodes = Vec<(String, [f64; 3])>;

/// Nodes and modes of a bridge, in vertical, lateral and rotation, before its sections and its damping are known.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BridgeModes {
    /// Where they come from, in words.
    pub source: String,
    /// Nodes, rising along the girder.
    pub nodes: Vec<Node>,
    /// Places of the nodes downwind and up, m, from the origin of the file; empty where it knows only places along the girder.
    pub offsets_m: Vec<[f64; 2]>,
    /// Modes; the damping ratio is zero where the file does not state it.
    pub modes: Vec<BridgeMode>,
    /// Modes of the file that are not among those selected.
    pub left_out: Vec<BridgeMode>,
    /// Whether the files have the nodes in the opposite order: places along the girder count along up × downwind.
    pub reversed: bool,
}

impl BridgeModes {
    /// Nodes and modes of a program, with tributary lengths by the trapezoidal rule. Nodes that all run against up × downwind, since
    /// the wind blows from the other side, are taken in the opposite order.
    pub(super) fn in_frame(
        frame: &Frame,
        mut placed: PlacedNodes,
        mut modes: Vec<BridgeMode>,
        source: String,
    ) -> Result<Self> {
        let place = |(_, p): &(String, [f64; 3])| frame * Vector3::from(*p);
        let mut pairs = placed.windows(2);
        let reversed = placed.len() > 1 && pairs.all(|pair| place(&pair[1]).z < place(&pair[0]).z);
        if reversed {
            placed.reverse();
            modes.iter_mut().for_each(|m| m.shape.reverse());
        }
        let places: Vec<_> = placed.iter().map(place).collect();
        let along: Vec<f64> = places.iter().map(|p| p.z).collect();
        let offsets_m = places.iter().map(|p| [p.y, p.x]).collect();
        let lengths = tributary_lengths(&along);
        let nodes = placed.into_iter().zip(along.into_iter().zip(lengths));
        let nodes = nodes.map(|((name, _), (along_m, length_m))| Node {
            name,
            along_m,
            length_m,
        });
        let nodes: Vec<Node> = nodes.collect();
        check_order(&nodes)?;
        Ok(Self {
            source,
            left_out: Vec::new(),
            modes,
            nodes,
            offsets_m,
            reversed,
        })
    }

    /// Takes only every `n`-th node, both ends kept; tributary lengths follow by the trapezoidal rule.
    #[must_use]
    pub fn thinned(&self, n: usize) -> Self {
        let last = self.nodes.len() - 1;
        let kept: Vec<usize> = (0..=last).filter(|i| i % n == 0 || *i == last).collect();
        let along: Vec<f64> = kept.iter().map(|i| self.nodes[*i].along_m).collect();
        let lengths = tributary_lengths(&along);
        let nodes = kept.iter().zip(lengths).map(|(i, length_m)| Node {
            length_m,
            ..self.nodes[*i].clone()
        });
        let modes = self.modes.iter().map(|m| BridgeMode {
            shape: kept.iter().map(|i| m.shape[*i]).collect(),
            ..m.clone()
        });
        let offsets_m = kept.iter().filter_map(|i| self.offsets_m.get(*i).copied());
        Self {
            left_out: Vec::new(),
            source: self.source.clone(),
            nodes: nodes.collect(),
            offsets_m: offsets_m.collect(),
            modes: modes.collect(),
            reversed: self.reversed,
        }
    }

    /// Index of a node by its name; `key` is the place in the bridge file that states it.
    ///
    /// # Errors
    /// [`Error::Input`] for a name that no node has, with the nodes next to it where names are numbers.
    pub fn index_of(&self, key: String, name: &str) -> Result<usize> {
        let index = self.nodes.iter().position(|n| n.name == *name);
        index.ok_or_else(|| {
            let (a, b) = (&self.nodes[0].name, &self.nodes[self.nodes.len() - 1].name);
            let away =
                |n: &Node| Some((n.name.parse::<f64>().ok()? - name.parse::<f64>().ok()?).abs());
            let near = self.nodes.iter();
            let near = near.filter_map(|n| Some((away(n)?, n.name.as_str())));
            let mut near: Vec<(f64, &str)> = near.collect();
            near.sort_by(|a, b| a.0.total_cmp(&b.0));
            let nearest = match near.as_slice() {
                [(_, first), (_, second), ..] => format!("; next to it are {first} and {second}"),
                _ => String::new(),
            };
            let expected = format!("a node of the bridge, {a} to {b}{nearest}");
            Error::input(key, expected, format!("`{name}`"))
        })
    }

    /// What is odd about them.
    pub fn findings(&self) -> Vec<Finding> {
        let mut findings = of_modes(&self.nodes, &self.offsets_m, &self.modes);
        if let (true, [first, .., last]) = (self.reversed, &self.nodes[..]) {
            let text = format!(
                "taken in the opposite order, since places along the girder (wind profile, turbulence) count along \
                 up × downwind: from {} m at node {} to {} m at node {}",
                first.along_m, first.name, last.along_m, last.name
            );
            findings.push(Finding::doubt(FindingKind::Axes, "nodes", text).into_note());
        }
        findings
    }
}

/// Tributary lengths by the trapezoidal rule: half the way to each neighbour. One node alone has none.
pub fn tributary_lengths(along_m: &[f64]) -> Vec<f64> {
    let last = along_m.len().saturating_sub(1);
    (0..along_m.len())
        .map(|i| 0.5 * (along_m[(i + 1).min(last)] - along_m[i.saturating_sub(1)]))
        .collect()
}

/// Refuses nodes that do not rise along the girder, before the tributary lengths complain of it.
pub(super) fn check_order(nodes: &[Node]) -> Result<()> {
    for pair in nodes.windows(2) {
        ensure(
            pair[1].along_m > pair[0].along_m,
            format_args!("node {}", pair[1].name),
            format_args!(
                "a place along the girder beyond {} m, that of node {} before it (nodes in the order of the girder, \
                     along up × downwind)",
                pair[0].along_m, pair[0].name
            ),
            format_args!("{} m", pair[1].along_m),
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes(up: &str, downwind: &str) -> WindAxes {
        WindAxes {
            up: Direction::Axis(up.into()),
            downwind: Direction::Axis(downwind.into()),
        }
    }

    /// Wind along −y, z up: a right-handed rotation about x lifts the edge at +y, which is windward.
    #[test]
    fn the_windward_edge_rises() {
        let frame = axes("z", "-y").frame().unwrap();
        assert_eq!(frame.row(2), Vector3::x().transpose());
        assert_eq!(
            motion(&frame, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            [3.0, -2.0, 4.0]
        );
        let other = axes("z", "y").frame().unwrap();
        assert_eq!(
            motion(&other, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            [3.0, 2.0, -4.0]
        );
    }

    #[test]
    fn directions_that_are_none_are_refused() {
        assert!(
            axes("w", "x")
                .frame()
                .unwrap_err()
                .to_string()
                .contains("x, y, z")
        );
        assert!(
            axes("z", "z")
                .frame()
                .unwrap_err()
                .to_string()
                .contains("square to `up`")
        );
    }
}
