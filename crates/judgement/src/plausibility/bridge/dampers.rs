//! Dampers against the modes that they are to damp, and the girder at which they hang.

use super::super::limits::significant;
use super::super::{Finding, FindingKind};
use crate::bridge::{Bridge, BridgeMode, MassDamper, ViscousLink};
use nalgebra::DVector;
use std::f64::consts::TAU;

/// All masses together over the modal mass that they meet where they hang: 0.005 to 0.05 is built, a tenth and more by nobody.
const MOST_MASS_RATIO: f64 = 0.1;
/// Damping ratio of a mass above which it hardly moves against its point; tuned ones have 0.05 to 0.2.
const MOST_DAMPING: f64 = 0.5;
/// Damping ratio that links may add to a mode.
const MOST_ADDED: f64 = 0.3;
/// Frequency of a mass over that of the nearest mode, either way, above which it is tuned to none.
const DETUNED: f64 = 2.0;
/// Distance from the axis over the width of the girder.
const MOST_OFFSET: f64 = 1.0;
/// Part of the greatest motion of any node below which a point stands still.
const STILL: f64 = 1e-6;

/// What is odd about the dampers of a bridge: of each kind the first that is.
pub(super) fn of_dampers(bridge: &Bridge) -> Vec<Finding> {
    let width_m = bridge.width_m();
    let masses = || bridge.dampers.masses.iter();
    let found = [
        heavy(bridge),
        masses().find_map(overdamped),
        masses().find_map(|d| beyond_girder(d, width_m)),
        detuned(bridge),
        without_motion(bridge),
        strong_link(bridge),
    ];
    found.into_iter().flatten().collect()
}

fn overdamped(damper: &MassDamper) -> Option<Finding> {
    let ratio = damper.damping_ratio;
    let text = "a mass that is damped so much hardly moves against its point";
    let odd = Finding::unit(format!("{}: damping_ratio", damper.name), ratio, text);
    let meant = format!("in per cent it would be {}", significant(ratio / 100.0));
    (ratio > MOST_DAMPING).then(|| odd.otherwise(meant))
}

fn beyond_girder(damper: &MassDamper, width_m: f64) -> Option<Finding> {
    let arm = damper.at.offset_m.abs();
    let key = format!("{}: arm_m", damper.name);
    let odd = Finding::unit(key, arm, "it hangs beside the girder");
    let meant = format!("in millimetres it would be {} m", significant(arm / 1e3));
    (arm > MOST_OFFSET * width_m).then(|| odd.otherwise(meant))
}

/// By unit mass-normalised modes, how much each link is stretched.
fn stretches(bridge: &Bridge) -> impl Iterator<Item = (&ViscousLink, DVector<f64>)> {
    bridge.dampers.links.iter().map(|link| {
        let at = bridge.motion_of(&link.at);
        let to = link.to.as_ref().map(|to| bridge.motion_of(to));
        (link, to.map_or_else(|| at.clone(), |to| &at - to))
    })
}

/// The first damper that no mode moves.
fn without_motion(bridge: &Bridge) -> Option<Finding> {
    let masses = bridge.dampers.masses.iter();
    let masses = masses.map(|d| (&d.name, bridge.motion_of(&d.at)));
    let links = stretches(bridge).map(|(link, stretch)| (&link.name, stretch));
    let least = STILL * greatest_motion(bridge);
    let (name, _) = masses
        .chain(links)
        .find(|(_, motion)| motion.amax() <= least)?;
    let text = "no mode that takes part moves it: it damps nothing";
    Some(Finding::doubt(FindingKind::Contradiction, name, text))
}

/// The first link that damps a mode as no link does.
fn strong_link(bridge: &Bridge) -> Option<Finding> {
    stretches(bridge).find_map(|(link, stretch)| {
        let of_mode = |(m, s): (&BridgeMode, &f64)| s * s / (2.0 * TAU * m.frequency_hz);
        let of_modes = bridge.modes.iter().zip(stretch.iter()).map(of_mode);
        let added = link.coefficient * of_modes.fold(0.0, f64::max);
        let text = format!(
            "it adds a damping ratio of {} to a mode",
            significant(added)
        );
        let key = format!("{}: coefficient", link.name);
        (added > MOST_ADDED).then(|| Finding::unit(key, link.coefficient, text))
    })
}

/// The heaviest damper where all together are too heavy for a mode.
fn heavy(bridge: &Bridge) -> Option<Finding> {
    let masses = bridge.dampers.masses.iter();
    // of each damper over the mass of every mode where it hangs
    let ratios = |d: &MassDamper| bridge.motion_of(&d.at).map(|v| d.mass_kg * v * v);
    let each: Vec<(&MassDamper, DVector<f64>)> = masses.map(|d| (d, ratios(d))).collect();
    let total = |mode: usize| each.iter().map(|(_, of)| of[mode]).sum::<f64>();
    let modes = (0..bridge.modes.len()).map(|mode| (mode, total(mode)));
    let (mode, sum) = modes.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (damper, _) = each.iter().max_by(|a, b| a.1[mode].total_cmp(&b.1[mode]))?;
    (sum > MOST_MASS_RATIO).then(|| {
        let number = bridge.modes[mode].number;
        let text = format!(
            "all dampers together have {} of the mass of mode {number} where they hang, and up to 0.05 is built",
            significant(sum)
        );
        Finding::unit(format!("{}: mass_kg", damper.name), damper.mass_kg, text)
    })
}

/// The first mass whose frequency is that of no mode.
fn detuned(bridge: &Bridge) -> Option<Finding> {
    let distance = |hertz: f64| {
        let all = bridge.modes.iter().map(|m| hertz / m.frequency_hz);
        all.map(|q| q.max(q.recip())).fold(f64::INFINITY, f64::min)
    };
    let mut masses = bridge.dampers.masses.iter();
    let damper = masses.find(|d| distance(d.frequency_hz) > DETUNED)?;
    let hertz = damper.frequency_hz;
    let key = format!("{}: frequency_hz", damper.name);
    let odd = Finding::unit(key, hertz, "it is tuned to no mode that takes part");
    let meant = format!("in rad/s it would be {} Hz", significant(hertz / TAU));
    Some(odd.otherwise(meant).into_note())
}

/// The greatest displacement of any node by a unit mass-normalised mode.
fn greatest_motion(bridge: &Bridge) -> f64 {
    let of_mode = |m: &BridgeMode| {
        let shape = m.shape.iter().flat_map(|s| &s[..2]);
        shape.fold(0.0_f64, |most, x| most.max(x.abs())) / m.generalised_mass.sqrt()
    };
    bridge.modes.iter().map(of_mode).fold(0.0, f64::max)
}
