//! Shapes from node to node: a girder bends and twists smoothly, and its nodes have to be near enough to say how.

use crate::bridge::{Bridge, BridgeMode};
use crate::plausibility::{Finding, FindingKind};

/// Nodes that never turn, as a part of all: supports that hold a girder against torsion are fewer.
const UNTURNED: f64 = 0.1;
/// Distance of a shape at a node from the straight line between its neighbours, over its greatest value: that of three nodes a half
/// wave is 0.5.
const JUMP: f64 = 0.6;
/// Greatest distance of neighbours over the half wave of a mode.
const SPACING: f64 = 0.5;
/// Motion at an end over the greatest of a mode: of one that ends where it moves most, and of one that is held.
const ENDS_HIGH: f64 = 0.9;
const ENDS_HELD: f64 = 0.2;
/// Slope at an end times the length, over the greatest motion.
const ENDS_LEVEL: f64 = 0.5;

/// What is odd about the shapes of the modes: of each kind the first.
pub(super) fn of_shapes(bridge: &Bridge, length_m: f64) -> Vec<Finding> {
    let found = [
        unturned(bridge),
        jump(bridge),
        sparse(bridge, length_m),
        cut(bridge, length_m),
    ];
    found.into_iter().flatten().collect()
}

fn contradiction(place: impl Into<String>, text: impl Into<String>) -> Finding {
    Finding::doubt(FindingKind::Contradiction, place, text)
}

/// Nodes without rotations among others with them, as programs export nodes of trusses, cables and hangers.
fn unturned(bridge: &Bridge) -> Option<Finding> {
    let moves =
        |node: usize, motion: usize| bridge.modes.iter().any(|m| m.shape[node][motion] != 0.0);
    let unturned = |n: &usize| !moves(*n, 2) && (moves(*n, 0) || moves(*n, 1));
    let still: Vec<usize> = (0..bridge.nodes.len()).filter(unturned).collect();
    let (count, all) = (still.len(), bridge.nodes.len());
    if count == all || (count as f64) <= UNTURNED * all as f64 {
        return None;
    }
    let text = format!(
        "{count} of {all} nodes, the first of them {}, turn in no mode, so that no moment acts on what belongs to them",
        bridge.nodes[still[0]].name
    );
    let otherwise = "nodes of trusses, cables and hangers have no rotations".to_owned();
    Some(contradiction("modes", text).otherwise(otherwise))
}

/// A mode whose main motion jumps from node to node.
fn jump(bridge: &Bridge) -> Option<Finding> {
    bridge.modes.iter().find_map(|mode| {
        let motion = bridge.main_motion(mode)?;
        let (node, part) = greatest_jump(bridge, mode, motion)?;
        let text = format!(
            "at node {} the shape lies {:.0} % of its greatest value beside the line between its neighbours",
            bridge.nodes[node].name,
            100.0 * part
        );
        let otherwise = "a sign, a unit or a node of another part of the bridge".to_owned();
        (part > JUMP).then(|| contradiction(place(mode), text).otherwise(otherwise))
    })
}

/// The inner node at which a motion is farthest from the line between its neighbours, over the greatest value of that motion.
fn greatest_jump(bridge: &Bridge, mode: &BridgeMode, motion: usize) -> Option<(usize, f64)> {
    let largest = greatest(mode, motion);
    let inner = 1..bridge.nodes.len().saturating_sub(1);
    let beside = inner.map(|i| {
        let at = |i: usize| (bridge.nodes[i].along_m, mode.shape[i][motion]);
        let ((x0, y0), (x, y), (x1, y1)) = (at(i - 1), at(i), at(i + 1));
        let line = y0 + (y1 - y0) * (x - x0) / (x1 - x0);
        (i, (y - line).abs() / largest)
    });
    beside.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// A mode with so short half waves that the nodes do not tell its shape.
fn sparse(bridge: &Bridge, length_m: f64) -> Option<Finding> {
    let gaps = bridge.nodes.windows(2).map(|w| w[1].along_m - w[0].along_m);
    let widest = gaps.fold(0.0, f64::max);
    let short = |mode: &&BridgeMode| {
        let motion = bridge.main_motion(mode).unwrap_or(0);
        widest > SPACING * length_m / half_waves(mode, motion) as f64
    };
    let mode = bridge.modes.iter().find(short)?;
    let text = format!(
        "neighbouring nodes are up to {widest:.0} m apart on a girder of {length_m:.0} m, which does not tell the shape of {}",
        place(mode)
    );
    Some(contradiction("nodes", text).otherwise("more nodes have to be exported".to_owned()))
}

/// A vertical mode that ends where it moves most, level: half of a girder. The free end of a cantilever slopes by 1.38 of its motion over
/// the length or more, and the other end of either is held.
fn cut(bridge: &Bridge, length_m: f64) -> Option<Finding> {
    let last = bridge.nodes.len().checked_sub(2)?;
    let is_cut = |mode: &&BridgeMode| {
        let (at, largest) = (|i: usize| mode.shape[i][0], greatest(mode, 0));
        [(0, 1, last + 1), (last + 1, last, 0)]
            .into_iter()
            .any(|(end, next, other)| {
                let gap = (bridge.nodes[end].along_m - bridge.nodes[next].along_m).abs();
                let slope = (at(end) - at(next)).abs() / gap * length_m;
                bridge.main_motion(mode) == Some(0)
                    && at(end).abs() > ENDS_HIGH * largest
                    && at(other).abs() < ENDS_HELD * largest
                    && slope < ENDS_LEVEL * largest
            })
    };
    let mode = bridge.modes.iter().find(is_cut)?;
    let text = "it ends at the last node of the girder level and where it moves most";
    let otherwise = "are these the nodes of half a girder, with masses of the whole?".to_owned();
    Some(contradiction(place(mode), text).otherwise(otherwise))
}

pub(super) fn place(mode: &BridgeMode) -> String {
    format!("mode {}", mode.number)
}

pub(super) fn greatest(mode: &BridgeMode, motion: usize) -> f64 {
    let sizes = mode.shape.iter().map(|s| s[motion].abs());
    sizes.fold(0.0, f64::max)
}

/// Half waves of one motion over the whole girder.
pub(super) fn half_waves(mode: &BridgeMode, motion: usize) -> usize {
    let least = 0.05 * greatest(mode, motion);
    let values = mode.shape.iter().map(|s| s[motion]);
    let large = values.filter(|s| s.abs() > least);
    let signs: Vec<bool> = large.map(|s| s > 0.0).collect();
    1 + signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}
