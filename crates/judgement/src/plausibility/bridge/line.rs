//! The line of the nodes against the girder axis, which follows from the axes that are stated.

use crate::bridge::Node;
use crate::plausibility::limits::{Limits, beyond, significant};
use crate::plausibility::{Finding, FindingKind};

/// Length from the first to the last node.
pub(super) const LENGTH: Limits = Limits {
    unit: "m",
    usual: (5.0, 10_000.0),
    meant: &[("mm", 1e-3), ("cm", 1e-2), ("km", 1e3)],
};

/// Angle between the line of the nodes in plan and the girder axis: worth a note (0.06 % of a length), and a doubt (0.4 %), degrees.
const SKEW_DEG: (f64, f64) = (2.0, 5.0);
/// Difference of the lengths at the nodes from the length of their line, as a part of it, that needs no word.
const LENGTHS_WITHIN: f64 = 0.05;
/// Rise of the line of the nodes over its length that no road has.
const STEEPEST: f64 = 0.12;
/// Height between neighbours that a girder may have beside what a road rises, m.
const STEP_M: f64 = 1.0;
/// Distance of a node from the straight line in plan over the length: the ends of a circular arc then turn by 1° and by 4.6°.
const CURVED: (f64, f64) = (0.005, 0.02);

/// Length from the first to the last node along the girder, m.
pub(super) fn length_m(nodes: &[Node]) -> f64 {
    match nodes {
        [first, .., last] => last.along_m - first.along_m,
        _ => 0.0,
    }
}

/// What is odd about where the nodes are.
pub(super) fn of_line(nodes: &[Node], offsets_m: &[[f64; 2]]) -> Vec<Finding> {
    if nodes.len() < 2 {
        return Vec::new();
    }
    let length = length_m(nodes);
    let along: Vec<f64> = nodes.iter().map(|n| n.along_m).collect();
    let mut found: Vec<Finding> = beyond("nodes: length", length, &LENGTH)
        .into_iter()
        .collect();
    found.extend(tributary(nodes));
    if offsets_m.len() != nodes.len() {
        return found;
    }
    let [in_plan, in_elevation] =
        [0, 1].map(|i| straight(&along, offsets_m.iter().map(|o| o[i]).collect()));
    found.extend(skew(in_plan.slope));
    if in_elevation.slope.abs() > STEEPEST {
        let text = format!(
            "the line of the nodes rises by {:.0} % of its length",
            100.0 * in_elevation.slope
        );
        found.push(
            Finding::doubt(FindingKind::Axes, "modes.axes.up", text)
                .otherwise("is another axis up?".to_owned()),
        );
    }
    found.extend(curve(&in_plan, length));
    found.extend(step(nodes, offsets_m));
    found
}

/// A node above or below its neighbours, as nodes of cables and towers are.
fn step(nodes: &[Node], offsets_m: &[[f64; 2]]) -> Option<Finding> {
    let heights = nodes.iter().zip(offsets_m);
    let places: Vec<[f64; 2]> = heights.map(|(n, o)| [n.along_m, o[1]]).collect();
    let steps = places.windows(3).zip(&nodes[1..]);
    let odd = steps.filter_map(|(three, node)| {
        let [[x0, z0], [x, z], [x1, z1]] = [three[0], three[1], three[2]];
        let beside = z - z0 - (z1 - z0) * (x - x0) / (x1 - x0);
        (beside.abs() > STEP_M + STEEPEST * (x1 - x0)).then_some((node, beside))
    });
    let (node, beside) = odd.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    let text = format!(
        "node {} lies {:.1} m {} the line between its neighbours",
        node.name,
        beside.abs(),
        if beside > 0.0 { "above" } else { "below" }
    );
    Some(
        Finding::doubt(FindingKind::Contradiction, "nodes", text)
            .otherwise("nodes of cables and towers are no part of the girder".to_owned()),
    )
}

/// Lengths on which the wind acts against the places of their nodes: half of them would be half the wind forces.
fn tributary(nodes: &[Node]) -> Option<Finding> {
    let [first, second, .., before, last] = nodes else {
        return None;
    };
    let length = length_m(nodes);
    let sum: f64 = nodes.iter().map(|n| n.length_m).sum();
    // a girder may end half a spacing beyond its nodes, or before them
    let ends = 0.5 * (second.along_m - first.along_m + last.along_m - before.along_m);
    if (sum - length).abs() <= LENGTHS_WITHIN * length + ends {
        return None;
    }
    let text = format!(
        "lengths of girder at the nodes (length_m) add up to {} m, where their places (along_m) reach over {} m",
        significant(sum),
        significant(length)
    );
    Some(
        Finding::doubt(FindingKind::Contradiction, "nodes", text)
            .otherwise("wind forces grow with the lengths".to_owned()),
    )
}

/// What is odd about a wind profile that is stated at the places `along_m`: none of them may say anything of the girder.
pub fn of_profile(along_m: &[f64], nodes: &[Node]) -> Option<Finding> {
    let ([a, .., b] | [a @ b]) = along_m else {
        return None;
    };
    let (Some(first), Some(last)) = (nodes.first(), nodes.last()) else {
        return None;
    };
    if *b >= first.along_m && *a <= last.along_m {
        return None;
    }
    let text = format!(
        "it is stated from {a} to {b} m along the girder, wholly beyond the girder from {} to {} m",
        significant(first.along_m),
        significant(last.along_m)
    );
    Some(
        Finding::doubt(FindingKind::Contradiction, "wind.profile", text)
            .otherwise("the factor of its nearest point is taken everywhere".to_owned()),
    )
}

fn skew(slope: f64) -> Option<Finding> {
    let angle = slope.atan().to_degrees();
    let (note, doubt) = SKEW_DEG;
    if angle.abs() < note {
        return None;
    }
    let text = format!(
        "the line of the nodes is turned by {angle:.1}° from the girder axis up × downwind, so that lengths are taken {:.1} % too \
         short and motions of the girder are mixed",
        100.0 * (1.0 - slope.atan().cos())
    );
    let otherwise = format!(
        "the wind square to the nodes blows {:.1}° from the stated direction",
        angle.abs()
    );
    let found = Finding::doubt(FindingKind::Axes, "modes.axes.downwind", text).otherwise(otherwise);
    Some(if angle.abs() < doubt {
        found.into_note()
    } else {
        found
    })
}

fn curve(line: &Straight, length_m: f64) -> Option<Finding> {
    let part = line.farthest_m / length_m;
    let (note, doubt) = CURVED;
    if part < note {
        return None;
    }
    let text = format!(
        "the nodes leave a straight line in plan by {:.2} m, {:.1} % of its length: a curved girder is answered as a straight one, \
         with wind square to its chord and motions along the same axes everywhere",
        line.farthest_m,
        100.0 * part
    );
    let found = Finding::doubt(FindingKind::Axes, "nodes", text);
    Some(if part < doubt {
        found.into_note()
    } else {
        found
    })
}

/// Nodes against the straight line from the first to the last.
struct Straight {
    slope: f64,
    /// Greatest distance of a node from it, m.
    farthest_m: f64,
}

/// The chord: unlike a regression it is the same however dense the nodes are.
fn straight(along: &[f64], off: Vec<f64>) -> Straight {
    let (Some((a0, a1)), Some((o0, o1))) = (ends(along), ends(&off)) else {
        return Straight {
            slope: 0.0,
            farthest_m: 0.0,
        };
    };
    let slope = (o1 - o0) / (a1 - a0);
    let square = slope.mul_add(slope, 1.0).sqrt();
    let distance = |(a, o): (&f64, &f64)| (o - o0 - slope * (a - a0)).abs() / square;
    let farthest_m = along.iter().zip(&off).map(distance).fold(0.0, f64::max);
    Straight { slope, farthest_m }
}

fn ends(values: &[f64]) -> Option<(f64, f64)> {
    Some((*values.first()?, *values.last()?))
}
