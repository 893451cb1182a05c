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
    let of_length = beyond("nodes: length", length, &LENGTH);
    let mut found: Vec<Finding> = of_length.into_iter().chain(tributary(nodes)).collect();
    if offsets_m.len() != nodes.len() {
        return found;
    }
    // the chord from the first node to the last: unlike a regression it is the same however dense the nodes are
    let (first, last) = (offsets_m[0], offsets_m[offsets_m.len() - 1]);
    let [slope, rise] = [0, 1].map(|i| (last[i] - first[i]) / length);
    found.extend(skew(slope));
    if rise.abs() > STEEPEST {
        let text = format!(
            "the line of the nodes rises by {:.0} % of its length",
            100.0 * rise
        );
        let odd = Finding::doubt(FindingKind::Axes, "modes.axes.up", text);
        found.push(odd.otherwise("is another axis up?".to_owned()));
    }
    let distance = |(node, o): (&Node, &[f64; 2])| {
        let beside = o[0] - first[0] - slope * (node.along_m - nodes[0].along_m);
        beside.abs() / slope.mul_add(slope, 1.0).sqrt()
    };
    let distances = nodes.iter().zip(offsets_m).map(distance);
    found.extend(curve(distances.fold(0.0, f64::max), length));
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
    let odd = Finding::doubt(FindingKind::Contradiction, "nodes", text);
    Some(odd.otherwise("nodes of cables and towers are no part of the girder".to_owned()))
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
    let odd = Finding::doubt(FindingKind::Contradiction, "nodes", text);
    Some(odd.otherwise("wind forces grow with the lengths".to_owned()))
}

/// What is odd about a wind profile that is stated at the places `along_m`: none of them may say anything of the girder.
pub fn of_profile(along_m: &[f64], nodes: &[Node]) -> Option<Finding> {
    let ([a, .., b] | [a @ b]) = along_m else {
        return None;
    };
    let (first, last) = nodes.first().zip(nodes.last())?;
    if *b >= first.along_m && *a <= last.along_m {
        return None;
    }
    let text = format!(
        "it is stated from {a} to {b} m along the girder, wholly beyond the girder from {} to {} m",
        significant(first.along_m),
        significant(last.along_m)
    );
    let odd = Finding::doubt(FindingKind::Contradiction, "wind.profile", text);
    Some(odd.otherwise("the factor of its nearest point is taken everywhere".to_owned()))
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
    let found = Finding::doubt(FindingKind::Axes, "modes.axes.downwind", text);
    Some(found.otherwise(otherwise).into_note_if(angle.abs() < doubt))
}

/// Nodes of which one lies as far from the chord.
fn curve(farthest_m: f64, length_m: f64) -> Option<Finding> {
    let part = farthest_m / length_m;
    let (note, doubt) = CURVED;
    if part < note {
        return None;
    }
    let text = format!(
        "the nodes leave a straight line in plan by {farthest_m:.2} m, {:.1} % of its length: a curved girder is answered as a straight \
         one, with wind square to its chord and motions along the same axes everywhere",
        100.0 * part
    );
    let found = Finding::doubt(FindingKind::Axes, "nodes", text);
    Some(found.into_note_if(part < doubt))
}
