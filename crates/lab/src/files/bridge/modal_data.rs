//! Nodes and modes as finite-element programs write them, and as the bridge takes them.

use super::axes::Frame;
use crate::bridge::{BridgeMode, Node};
use crate::error::{Error, Result, ensure};
use crate::plausibility::{Finding, FindingKind, of_modes};
use nalgebra::Vector3;

/// Name of each node, and its place in x, y, z of the program, m.
pub(super) type PlacedNodes = Vec<(String, [f64; 3])>;

/// Nodes and modes of a bridge, in vertical, lateral and rotation, before its sections and its damping are known.
#[derive(Debug, Clone, PartialEq)]
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

impl BridgeModes {
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
