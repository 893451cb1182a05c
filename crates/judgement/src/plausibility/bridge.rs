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
use std::ops::RangeInclusive;
pub use turbulence::of_turbulence;

/// Unit-norm shapes of one bridge and a generalised mass of 1: the greatest displacement of a mass-normalised shape of
/// anything as heavy as a bridge is far below this.
const MASS_NORMALISED_AT_MOST: f64 = 0.1;
/// Two modes are one when shapes (as the cosine of their angle, squared), masses and frequencies differ by less than these.
const SAME_SHAPE: f64 = 0.999;
const SAME_MASS: f64 = 0.02;
const SAME_FREQUENCY: f64 = 0.02;
/// Mass per length over that of the air in a square of the width.
const MASS_RATIOS: RangeInclusive<f64> = 2.0..=300.0;
/// Frequency of a vertical mode times the length of its half wave, the least of all modes, m/s: 100 for girders of usual
/// slenderness whatever their span, 50 to 160 for suspended ones.
const WAVE_SPEEDS: RangeInclusive<f64> = 15.0..=250.0;

/// What is odd about modes that take part, by themselves, before sections are known: lengths, axes, modes given twice, rotations in
/// degrees, norms, damping. `offsets_m` are the places of the nodes downwind and up, m; empty where a file knows only places along the
/// girder.
pub fn of_modes(nodes: &[Node], offsets_m: &[[f64; 2]], modes: &[BridgeMode]) -> Vec<Finding> {
    let mut found = of_line(nodes, offsets_m);
    let motion = |mode: &BridgeMode| greatest_displacement(mode).max(greatest(mode, 2));
    let turns_more = |m: &&BridgeMode| greatest(m, 2) > PI && greatest_displacement(m) <= 2.0;
    if let Some(mode) = modes.iter().find(turns_more) {
        let (turns, moves) = (greatest(mode, 2), greatest_displacement(mode));
        let text = format!(
            "it turns by {turns:.3} where it moves by {moves:.3} m at most, and rotations are in radians"
        );
        let meant = significant(turns.to_radians());
        let otherwise = format!("in degrees it would be {meant} rad");
        found.push(Finding::doubt(FindingKind::Unit, place(mode), text).otherwise(otherwise));
    }
    let is_of_another_norm = |m: &&BridgeMode| {
        (m.generalised_mass - 1.0).abs() < 1e-9 && motion(m) > MASS_NORMALISED_AT_MOST
    };
    if let Some(mode) = modes.iter().find(is_of_another_norm) {
        let moves = motion(mode);
        let text = format!(
            "a generalised mass of 1 belongs to a mass-normalised shape, which moves by about 1e-3, and this one moves by up to {moves:.3}"
        );
        let odd = Finding::doubt(FindingKind::Contradiction, place(mode), text);
        let meant = "is the mass that of a shape of another norm?";
        found.push(odd.otherwise(meant.to_owned()));
    }
    found.extend(modes.iter().find(|m| motion(m) == 0.0).map(|mode| {
        Finding::doubt(FindingKind::Contradiction, place(mode), "it moves no node")
            .otherwise("a mode of towers or cables can be left out by modes.select".to_owned())
    }));
    found.extend(twice(nodes, modes));
    let key = "modes.damping_ratio";
    let damping = |m: &BridgeMode| unusual_damping(key, m.damping_ratio, USUAL_DAMPING);
    found.extend(modes.iter().find_map(damping));
    found
}

/// What is odd about a whole bridge beside [`of_modes`]: widths, air, and what modes and sections say of each other.
pub fn of_bridge(bridge: &Bridge) -> Vec<Finding> {
    let air = unusual_air("air_density_kg_m3", bridge.air_density_kg_m3);
    let mut found: Vec<Finding> = air.into_iter().collect();
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
    let missing = |(motion, name): (usize, &str)| {
        let in_file = lowest(bridge, left_out, motion);
        let text = match (in_file, lowest(bridge, &bridge.modes, motion)) {
            (None, None) => return still(bridge, motion, name),
            (None, Some(_)) => return None,
            (Some(out), Some(taken)) if taken.frequency_hz <= out.frequency_hz => return None,
            (Some(out), Some(taken)) => format!(
                "the lowest {name} mode of the file, {} ({:.4} Hz), is left out, the lowest that is taken is {} ({:.4} Hz)",
                out.number, out.frequency_hz, taken.number, taken.frequency_hz
            ),
            (Some(out), None) => format!(
                "none of the modes that are taken is {name}; of the file {} ({:.4} Hz) is the lowest",
                out.number, out.frequency_hz
            ),
        };
        let odd = Finding::doubt(FindingKind::Contradiction, "modes.select", text);
        Some(odd.otherwise("flutter couples a vertical and a torsional mode".to_owned()))
    };
    let motions = [(0, "vertical"), (2, "torsional")];
    motions.into_iter().filter_map(missing).collect()
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

/// The lowest of the modes that move mainly in this way.
fn lowest<'a>(bridge: &Bridge, modes: &'a [BridgeMode], motion: usize) -> Option<&'a BridgeMode> {
    let own = modes.iter();
    let own = own.filter(|m| bridge.main_motion(m) == Some(motion));
    own.min_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz))
}

fn greatest_displacement(mode: &BridgeMode) -> f64 {
    greatest(mode, 0).max(greatest(mode, 1))
}

/// `∫φ_a φ_b` of one motion over the girder.
fn product(nodes: &[Node], a: &BridgeMode, b: &BridgeMode, motion: usize) -> f64 {
    let shapes = a.shape.iter().zip(&b.shape);
    let nodes = nodes.iter().zip(shapes);
    let parts = nodes.map(|(n, (a, b))| n.length_m * a[motion] * b[motion]);
    parts.sum()
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
fn twice(nodes: &[Node], modes: &[BridgeMode]) -> Vec<Finding> {
    let one = |(i, a): (usize, &BridgeMode)| {
        let b = modes[..i].iter().find(|b| is_same_mode(nodes, a, b))?;
        let text = format!(
            "it has the shape and the mass of mode {} ({:.4} and {:.4} Hz), and a mode that is counted twice is twice as easily moved",
            b.number, a.frequency_hz, b.frequency_hz
        );
        let odd = Finding::doubt(FindingKind::Duplicate, place(a), text);
        Some(odd.otherwise("modes.select can leave it out".to_owned()))
    };
    modes.iter().enumerate().filter_map(one).collect()
}

/// Width of the girder over its length, m: whichever section is listed first.
fn mean_width_m(bridge: &Bridge) -> f64 {
    let length =
        |group: &StripGroup| -> f64 { group.nodes.iter().map(|n| bridge.nodes[*n].length_m).sum() };
    let area = |g: &StripGroup| g.width_m * length(g);
    bridge.groups.iter().map(area).sum::<f64>() / bridge.groups.iter().map(length).sum::<f64>()
}

/// Mass and inertia per length: `M/∫φ²` of each mode is no less than they are, since the rest of the mode has mass as well, and
/// equal to them in a mode of one motion. With usual frequencies they say where a flat plate flutters.
fn masses(bridge: &Bridge, frequencies_are_usual: bool) -> Vec<Finding> {
    let least = |motion: usize| {
        let each = bridge.modes.iter().filter_map(|m| {
            let square = product(&bridge.nodes, m, m, motion);
            (square > 0.0).then(|| (m.generalised_mass / square, m))
        });
        let least = each.min_by(|a, b| a.0.total_cmp(&b.0));
        least.filter(|(_, m)| bridge.main_motion(m) == Some(motion))
    };
    let Some((mass, vertical)) = least(0) else {
        return Vec::new();
    };
    let width = mean_width_m(bridge);
    let ratio = mass / (bridge.air_density_kg_m3 * width * width);
    if !MASS_RATIOS.contains(&ratio) {
        let meant = || format!("in t it would be {} kg/m", significant(1e3 * mass));
        let otherwise = MASS_RATIOS.contains(&(1e3 * ratio)).then(meant);
        let (low, high) = MASS_RATIOS.into_inner();
        let key = format!("{}: generalised mass", place(vertical));
        let text = format!(
            "with the shape that is {} kg/m, {} times the air in a square of the width ({low} to {high} is usual)",
            significant(mass),
            significant(ratio)
        );
        return vec![Finding::doubt(FindingKind::Unit, key, text).otherwise(otherwise)];
    }
    let Some((inertia, torsional)) = least(2) else {
        return Vec::new();
    };
    let ratio = (inertia / mass).sqrt() / width;
    let key = format!("{}: rotations", place(torsional));
    let found = unusual_radius(&key, width, ratio).map(|f| {
        let meant = ratio * 1f64.to_degrees();
        match unusual_radius(&key, width, meant) {
            None => f.otherwise(format!(
                "were they in degrees, it would be {meant:.3} widths"
            )),
            Some(_) => f,
        }
    });
    let fast = || fast_bridge(bridge, mass, inertia).filter(|_| frequencies_are_usual);
    found.or_else(fast).into_iter().collect()
}

/// The flat plate of [`fast_plate`] with mass and inertia per length, and the lowest frequencies of the modes.
fn fast_bridge(bridge: &Bridge, mass_kg_m: f64, inertia_kg_m2_m: f64) -> Option<Finding> {
    let lowest = |motion| lowest(bridge, &bridge.modes, motion);
    let (heave, twist) = (lowest(0)?, lowest(2)?);
    let plate = SectionModel::two_dof(
        mean_width_m(bridge),
        bridge.air_density_kg_m3,
        Translation::new(mass_kg_m, heave.frequency_hz, 0.0),
        Rotation::new(inertia_kg_m2_m, twist.frequency_hz, 0.0),
    );
    let found = fast_plate(&plate, heave.frequency_hz, twist.frequency_hz)?;
    Some(Finding {
        place: format!("{}: frequency_hz", place(twist)),
        ..found
    })
}

/// The least product of frequency and half wave of the modes that move mainly up and down.
fn frequencies(bridge: &Bridge, length_m: f64) -> Vec<Finding> {
    let modes = bridge.modes.iter();
    let vertical = modes.filter(|m| bridge.main_motion(m) == Some(0));
    let speed = |m: &BridgeMode| m.frequency_hz * length_m / half_waves(m, 0) as f64;
    let speeds = vertical.map(|m| (speed(m), m));
    let slowest = speeds.min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((speed, mode)) = slowest.filter(|(speed, _)| !WAVE_SPEEDS.contains(speed)) else {
        return Vec::new();
    };
    let hertz = mode.frequency_hz;
    let meant = || format!("in rad/s it would be {} Hz", significant(hertz / TAU));
    let otherwise = WAVE_SPEEDS.contains(&(speed / TAU)).then(meant);
    let usual = |x: f64| significant(x * hertz / speed);
    let (low, high) = WAVE_SPEEDS.into_inner();
    let text = format!(
        "with half waves of {:.0} m {} to {} Hz is usual",
        speed / hertz,
        usual(low),
        usual(high)
    );
    let found = Finding::unit(format!("{}: frequency_hz", place(mode)), hertz, text);
    vec![found.otherwise(otherwise)]
}
