//! Bridges: the line of the nodes, modes against each other, masses and frequencies against what a span and a width suggest.

mod dampers;
mod line;
mod shapes;
mod turbulence;

use super::limits::{DECK_WIDTH, beyond, significant};
use super::section::{USUAL_DAMPING, fast_plate, unusual_air, unusual_damping, unusual_radius};
use super::{Finding, FindingKind};
use crate::bridge::{Bridge, BridgeMode, Node, StripGroup};
use crate::section::{Dof, Rotation, SectionModel, Translation};
use dampers::of_dampers;
pub use line::of_profile;
use line::{LENGTH, length_m, of_line};
use shapes::{greatest, half_waves, of_shapes, place};
use std::f64::consts::{PI, TAU};
pub use turbulence::{TurbulenceFigures, of_turbulence};

/// Unit-norm shapes of one bridge and a generalised mass of 1: the greatest displacement of a mass-normalised shape of
/// anything as heavy as a bridge is far below this.
const MASS_NORMALISED_AT_MOST: f64 = 0.1;
/// Two modes are one when shapes (as the cosine of their angle, squared), masses and frequencies differ by less than these.
const SAME_SHAPE: f64 = 0.999;
const SAME_MASS: f64 = 0.02;
const SAME_FREQUENCY: f64 = 0.02;
/// Mass per length over that of the air in a square of the width.
const MASS_RATIOS: (f64, f64) = (2.0, 300.0);
/// Frequency of a vertical mode times the length of its half wave, the least of all modes, m/s: 100 for girders of usual
/// slenderness whatever their span, 50 to 160 for suspended ones.
const WAVE_SPEEDS: (f64, f64) = (15.0, 250.0);

/// Nodes and modes as they were read, before sections are known.
#[derive(Debug, Clone, Copy)]
pub struct Girder<'a> {
    /// Nodes along the girder.
    pub nodes: &'a [Node],
    /// Places of the nodes downwind and up, m; empty where the file knows only places along the girder.
    pub offsets_m: &'a [[f64; 2]],
    /// Modes that take part.
    pub modes: &'a [BridgeMode],
}

/// What is odd about modes by themselves: lengths, axes, modes given twice, rotations in degrees, norms, damping.
pub fn of_modes(girder: &Girder<'_>) -> Vec<Finding> {
    let modes = girder.modes;
    let mut found = of_line(girder.nodes, girder.offsets_m);
    if let Some(mode) = modes.iter().find(|m| moves_less_than_it_turns(m)) {
        let (turns, moves) = (greatest(mode, 2), greatest_displacement(mode));
        let text = format!(
            "it turns by {turns:.3} where it moves by {moves:.3} m at most, and rotations are in radians"
        );
        let otherwise = format!(
            "in degrees it would be {} rad",
            significant(turns.to_radians())
        );
        found.push(Finding::doubt(FindingKind::Unit, place(mode), text).otherwise(otherwise));
    }
    if let Some(mode) = modes.iter().find(|m| is_of_another_norm(m)) {
        let moves = greatest_displacement(mode).max(greatest(mode, 2));
        let text = format!(
            "a generalised mass of 1 belongs to a mass-normalised shape, which moves by about 1e-3, and this one moves by up to {moves:.3}"
        );
        found.push(
            Finding::doubt(FindingKind::Contradiction, place(mode), text)
                .otherwise("is the mass that of a shape of another norm?".to_owned()),
        );
    }
    let is_null = |m: &&BridgeMode| greatest_displacement(m).max(greatest(m, 2)) == 0.0;
    found.extend(modes.iter().find(is_null).map(|mode| {
        Finding::doubt(FindingKind::Contradiction, place(mode), "it moves no node")
            .otherwise("a mode of towers or cables can be left out by modes.select".to_owned())
    }));
    found.extend(twice(girder));
    let damping = modes
        .iter()
        .find_map(|m| unusual_damping("modes.damping_ratio", m.damping_ratio, USUAL_DAMPING));
    found.extend(damping);
    found
}

/// What is odd about a whole bridge beside [`of_modes`]: widths, air, and what modes and sections say of each other.
pub fn of_bridge(bridge: &Bridge) -> Vec<Finding> {
    let density = bridge.air_density_kg_m3;
    let mut found: Vec<Finding> = unusual_air("air_density_kg_m3", density)
        .into_iter()
        .collect();
    let mut named: Vec<&str> = Vec::new();
    for group in &bridge.groups {
        if !named.contains(&group.name.as_str()) {
            named.push(&group.name);
            let key = format!("section {}: width_m", group.name);
            found.extend(beyond(&key, group.width_m, &DECK_WIDTH));
        }
    }
    let length = length_m(&bridge.nodes);
    let scale_is_usual = found.is_empty() && beyond("", length, &LENGTH).is_none();
    if scale_is_usual {
        found.extend(of_dampers(bridge));
    }
    if scale_is_usual && bridge.nodes.len() > 2 {
        let of_frequencies = frequencies(bridge, length);
        found.extend(masses(bridge, of_frequencies.is_empty()));
        found.extend(of_frequencies);
        found.extend(of_shapes(bridge, length));
    }
    found
}

/// Modes of the file without which the answer may be that of another bridge: the lowest that bends the girder, and the lowest that
/// twists it; and whether the file has any motion of either kind.
pub fn of_modes_left_out(bridge: &Bridge, left_out: &[BridgeMode]) -> Vec<Finding> {
    let lowest = |modes: &[BridgeMode], motion: usize| {
        let own = modes
            .iter()
            .filter(|m| bridge.main_motion(m) == Some(motion));
        let lowest = own.min_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        lowest.map(|m| (m.number, m.frequency_hz))
    };
    let missing = |(motion, name): (usize, &str)| {
        let text = match (lowest(left_out, motion), lowest(&bridge.modes, motion)) {
            (None, None) => return still(bridge, motion, name),
            (None, Some(_)) => return None,
            (Some((_, hertz)), Some((_, taken_hertz))) if taken_hertz <= hertz => return None,
            (Some((number, hertz)), Some((taken, taken_hertz))) => format!(
                "the lowest {name} mode of the file, {number} ({hertz:.4} Hz), is left out, the lowest that is taken is {taken} \
                 ({taken_hertz:.4} Hz)"
            ),
            (Some((number, hertz)), None) => format!(
                "none of the modes that are taken is {name}; of the file {number} ({hertz:.4} Hz) is the lowest"
            ),
        };
        let kind = FindingKind::Contradiction;
        Some(
            Finding::doubt(kind, "modes.select", text)
                .otherwise("flutter couples a vertical and a torsional mode".to_owned()),
        )
    };
    [(0, "vertical"), (2, "torsional")]
        .into_iter()
        .filter_map(missing)
        .collect()
}

/// That no mode moves mainly in this way, in which forces act: nothing can flutter then, which looks like a bridge that is safe in
/// every wind.
fn still(bridge: &Bridge, motion: usize, name: &str) -> Option<Finding> {
    let acts = |group: &StripGroup| group.forces.dofs().contains(&Dof::THREE[motion]);
    if !bridge.groups.iter().any(acts) {
        return None;
    }
    let text = format!("none of the modes is mainly {name}");
    let otherwise = match motion {
        2 => "more of them may have to be exported, rotations with them, in radians",
        _ => "more of them may have to be exported, vertical displacements with them, in m",
    };
    let found = Finding::doubt(FindingKind::Contradiction, "modes", text);
    Some(found.otherwise(otherwise.to_owned()))
}

fn greatest_displacement(mode: &BridgeMode) -> f64 {
    greatest(mode, 0).max(greatest(mode, 1))
}

fn moves_less_than_it_turns(mode: &BridgeMode) -> bool {
    greatest(mode, 2) > PI && greatest_displacement(mode) <= 2.0
}

fn is_of_another_norm(mode: &BridgeMode) -> bool {
    let moves = greatest_displacement(mode).max(greatest(mode, 2));
    (mode.generalised_mass - 1.0).abs() < 1e-9 && moves > MASS_NORMALISED_AT_MOST
}

/// `∫φ_a φ_b` of one motion over the girder.
fn product(nodes: &[Node], a: &BridgeMode, b: &BridgeMode, motion: usize) -> f64 {
    let shapes = a.shape.iter().zip(&b.shape);
    let parts = nodes.iter().zip(shapes);
    parts
        .map(|(n, (a, b))| n.length_m * a[motion] * b[motion])
        .sum()
}

/// Whether two modes are one: see [`of_modes`].
pub fn is_same_mode(nodes: &[Node], a: &BridgeMode, b: &BridgeMode) -> bool {
    let all =
        |a: &BridgeMode, b: &BridgeMode| -> f64 { (0..3).map(|i| product(nodes, a, b, i)).sum() };
    let near = |a: f64, b: f64, part: f64| (a / b - 1.0).abs() < part;
    let (aa, bb, ab) = (all(a, a), all(b, b), all(a, b));
    near(a.frequency_hz, b.frequency_hz, SAME_FREQUENCY)
        && ab * ab / (aa * bb) > SAME_SHAPE
        && near(a.generalised_mass / aa, b.generalised_mass / bb, SAME_MASS)
}

/// Modes that are one mode: the same shape with the same mass at the same frequency. Modes of cables may share a frequency or the
/// shape of the girder, never both and the mass.
fn twice(girder: &Girder<'_>) -> Vec<Finding> {
    let mut found = Vec::new();
    for (i, a) in girder.modes.iter().enumerate() {
        for b in &girder.modes[..i] {
            if is_same_mode(girder.nodes, a, b) {
                let text = format!(
                    "it has the shape and the mass of mode {} ({:.4} and {:.4} Hz), and a mode that is counted twice is twice as \
                     easily moved",
                    b.number, a.frequency_hz, b.frequency_hz
                );
                found.push(
                    Finding::doubt(FindingKind::Duplicate, place(a), text)
                        .otherwise("modes.select can leave it out".to_owned()),
                );
                break;
            }
        }
    }
    found
}

/// Width of the girder over its length, m: whichever section is listed first.
fn mean_width_m(bridge: &Bridge) -> f64 {
    let length =
        |group: &StripGroup| -> f64 { group.nodes.iter().map(|n| bridge.nodes[*n].length_m).sum() };
    let parts = bridge
        .groups
        .iter()
        .map(|g| (g.width_m * length(g), length(g)));
    let (areas, lengths) = parts.fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
    areas / lengths
}

/// Mass and inertia per length: `M/∫φ²` of each mode is no less than they are, since the rest of the mode has mass as well, and
/// equal to them in a mode of one motion. With usual frequencies they say where a flat plate flutters.
fn masses(bridge: &Bridge, frequencies_are_usual: bool) -> Vec<Finding> {
    let least = |motion: usize| {
        let each = bridge.modes.iter().enumerate().filter_map(|(i, m)| {
            let square = product(&bridge.nodes, m, m, motion);
            (square > 0.0).then(|| (m.generalised_mass / square, i))
        });
        each.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let Some((mass, vertical)) =
        least(0).filter(|(_, i)| bridge.main_motion(&bridge.modes[*i]) == Some(0))
    else {
        return Vec::new();
    };
    let width = mean_width_m(bridge);
    let ratio = mass / (bridge.air_density_kg_m3 * width * width);
    let (low, high) = MASS_RATIOS;
    if !(low..=high).contains(&ratio) {
        let thousand = (low..=high).contains(&(1e3 * ratio));
        let otherwise =
            thousand.then(|| format!("in t it would be {} kg/m", significant(1e3 * mass)));
        let key = format!("{}: generalised mass", place(&bridge.modes[vertical]));
        let text = format!(
            "with the shape that is {} kg/m, {} times the air in a square of the width ({low} to {high} is usual)",
            significant(mass),
            significant(ratio)
        );
        return vec![Finding::doubt(FindingKind::Unit, key, text).otherwise(otherwise)];
    }
    let Some((inertia, torsional)) =
        least(2).filter(|(_, i)| bridge.main_motion(&bridge.modes[*i]) == Some(2))
    else {
        return Vec::new();
    };
    let ratio = (inertia / mass).sqrt() / width;
    let key = format!("{}: rotations", place(&bridge.modes[torsional]));
    let found = unusual_radius(&key, width, ratio).map(|f| {
        let in_radians = ratio * 1f64.to_degrees();
        match unusual_radius(&key, width, in_radians) {
            None => f.otherwise(format!(
                "were they in degrees, it would be {in_radians:.3} widths"
            )),
            Some(_) => f,
        }
    });
    let fast = || fast_bridge(bridge, mass, inertia).filter(|_| frequencies_are_usual);
    found.or_else(fast).into_iter().collect()
}

/// The flat plate of [`fast_plate`] with mass and inertia per length, and the lowest frequencies of the modes.
fn fast_bridge(bridge: &Bridge, mass_kg_m: f64, inertia_kg_m2_m: f64) -> Option<Finding> {
    let lowest = |motion: usize| {
        let own = bridge.modes.iter();
        let own = own.filter(|m| bridge.main_motion(m) == Some(motion));
        own.min_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz))
    };
    let (heave, twist) = (lowest(0)?, lowest(2)?);
    let plate = SectionModel::two_dof(
        mean_width_m(bridge),
        bridge.air_density_kg_m3,
        Translation::new(mass_kg_m, heave.frequency_hz, 0.0),
        Rotation::new(inertia_kg_m2_m, twist.frequency_hz, 0.0),
    );
    let found = fast_plate(&plate, heave.frequency_hz, twist.frequency_hz)?;
    let key = format!("{}: frequency_hz", place(twist));
    Some(Finding {
        place: key,
        ..found
    })
}

/// The least product of frequency and half wave of the modes that move mainly up and down.
fn frequencies(bridge: &Bridge, length_m: f64) -> Vec<Finding> {
    let vertical =
        (0..bridge.modes.len()).filter(|m| bridge.main_motion(&bridge.modes[*m]) == Some(0));
    let speeds = vertical.map(|i| {
        let mode = &bridge.modes[i];
        (
            mode.frequency_hz * length_m / half_waves(mode, 0) as f64,
            mode,
        )
    });
    let Some((speed, mode)) = speeds.min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Vec::new();
    };
    let (low, high) = WAVE_SPEEDS;
    let is_usual = |x: f64| (low..=high).contains(&x);
    if is_usual(speed) {
        return Vec::new();
    }
    let hertz = mode.frequency_hz;
    let otherwise = is_usual(speed / TAU)
        .then(|| format!("in rad/s it would be {} Hz", significant(hertz / TAU)));
    let usual = |x: f64| significant(x * hertz / speed);
    let text = format!(
        "with half waves of {:.0} m {} to {} Hz is usual",
        speed / hertz,
        usual(low),
        usual(high)
    );
    let found = Finding::unit(format!("{}: frequency_hz", place(mode)), hertz, text);
    vec![found.otherwise(otherwise)]
}
