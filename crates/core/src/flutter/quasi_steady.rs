//! Modes and onset of quasi-steady theory (1.31)–(1.32): at every wind speed the forces are linear about the static
//! equilibrium of that speed, so that the linear model itself changes with the speed.

use super::answer::{FlutterSearch, UnstableStart};
use super::critical_point::{CriticalPoint, OnsetMethod};
use super::curves::{FlutterCurves, empty_branches, trace_modes};
use super::following::{Mode, oscillates};
use super::instability::{ModeAtOnset, classify};
use super::judged::StableRange;
use super::onset::Onset;
use super::search::OnsetSearch;
use super::tracking::{SLOPE_STEP, Tracker};
use crate::aerodynamics::quasi_steady::{LinearQuasiSteady, QuasiSteady};
use crate::aeroelastic::{CoupledSection, EquilibriumEnd, EquilibriumPath, static_equilibria};
use crate::error::{Error, Result};
use crate::section::Structure;
use crate::state_space::{ValueAt, damping_ratio, root};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use serde::Serialize;

/// Reduced velocity below which quasi-steady theory does not hold: ten transits of the deck in a period.
const LEAST_REDUCED_VELOCITY: f64 = 10.0;

/// Reduced frequencies in which single degrees of freedom are searched for an onset of their own.
const SEARCHED: ReducedFrequencyRange = ReducedFrequencyRange::between(
    ReducedFrequency::from_full_width(0.02),
    ReducedFrequency::from_full_width(10.0),
);

/// The first speed looked at, as a part of the first that is asked for.
const NEARLY_STILL: f64 = 1e-3;

/// Answer of quasi-steady theory.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QuasiSteadyOnset {
    /// The lowest onset, or up to where there is none: the highest speed, or the end of the equilibrium.
    pub search: FlutterSearch,
    /// What kind of instability the onset is, if there is one.
    pub mode: Option<ModeAtOnset>,
    /// Where the static equilibrium ends, if it does below the highest speed.
    pub equilibrium_end: Option<EquilibriumEnd>,
}

/// First wind speed at which an oscillation about the static equilibrium of that speed loses its damping.
pub fn quasi_steady_onset(
    name: &str,
    structure: &Structure,
    theory: &QuasiSteady,
    search: &OnsetSearch,
) -> Result<QuasiSteadyOnset> {
    let mut speeds = search.speeds_m_s()?;
    speeds.insert(0, NEARLY_STILL * speeds[0]);
    let path = static_equilibria(structure, theory, &speeds)?;
    let found = |search, mode| QuasiSteadyOnset {
        search,
        mode,
        equilibrium_end: path.end,
    };
    let mut before: Option<ValueAt> = None;
    for point in &path.points {
        let linear = theory.linearised(point.rotation_rad)?;
        let section = CoupledSection::with_model(structure, &linear)?;
        let growth = fastest_growth(&section, point.speed_m_s)?;
        let here = ValueAt::new(point.speed_m_s, growth);
        let Some(before) = before.replace(here) else {
            if growth > 0.0 {
                let start = grows_in_still_air(name, &section, point.speed_m_s)?;
                let start = FlutterSearch::UnstableAtOrBelow(Box::new(start));
                return Ok(found(start, None));
            }
            continue;
        };
        if growth >= 0.0 {
            let speed = root(before, here, |speed| {
                let linear = at_equilibrium(structure, theory, speed)?;
                fastest_growth(&CoupledSection::with_model(structure, &linear)?, speed)
            })?;
            let onset = described(name, structure, theory, speed)?;
            let linear = at_equilibrium(structure, theory, speed)?;
            let mode = classify(structure, &linear, &onset, SEARCHED, search.speed_max_m_s)?;
            let onset = FlutterSearch::Onset(Box::new(onset));
            return Ok(found(onset, Some(mode)));
        }
    }
    let stable_up_to = path.end.map_or(search.speed_max_m_s, |end| end.speed_m_s());
    let stable = FlutterSearch::StableUpTo(StableRange::up_to(stable_up_to));
    Ok(found(stable, None))
}

/// Frequencies and damping over rising wind speeds, about the equilibrium of each; ends with the equilibrium.
pub fn quasi_steady_modes(
    name: &str,
    structure: &Structure,
    theory: &QuasiSteady,
    path: &EquilibriumPath,
) -> Result<FlutterCurves> {
    let mut branches = empty_branches(structure, path.points.len());
    for point in &path.points {
        let linear = theory.linearised(point.rotation_rad)?;
        let section = CoupledSection::with_model(structure, &linear)?;
        let at = trace_modes(name, &section, &[point.speed_m_s])?;
        for (all, one) in branches.iter_mut().zip(at.branches) {
            all.points.extend(one.points);
        }
    }
    Ok(FlutterCurves {
        model: name.to_owned(),
        branches,
        ended: None,
    })
}

fn at_equilibrium(
    structure: &Structure,
    theory: &QuasiSteady,
    speed_m_s: f64,
) -> Result<LinearQuasiSteady> {
    let path = static_equilibria(structure, theory, &[speed_m_s])?;
    let why = format_args!("quasi-steady onset: no equilibrium at {speed_m_s:.3} m/s");
    let point = path.points.first();
    let point = point.ok_or_else(|| Error::Numerical(why.to_string()))?;
    theory.linearised(point.rotation_rad)
}

/// Largest real part of the eigenvalues that oscillate, 1/s; divergence is the end of the equilibrium.
fn fastest_growth(section: &CoupledSection, speed_m_s: f64) -> Result<f64> {
    let all = section.at(speed_m_s)?.eigenvalues()?.into_iter();
    let rates = all.filter(oscillates).map(|z| z.re);
    Ok(rates.fold(f64::NEG_INFINITY, f64::max))
}

fn grows_in_still_air(name: &str, section: &CoupledSection, speed: f64) -> Result<UnstableStart> {
    let mode = least_damped(section, speed)?;
    let structure = section.structure();
    let (method, why) = (OnsetMethod::Eigenvalues, "nearly still air".to_owned());
    let at = CriticalPoint::of_motion(name, method, structure, speed, mode.lambda.im);
    let branch = structure.branch_name(mode.branch);
    Ok(UnstableStart::new(at, mode.lambda.re, branch, why))
}

/// The mode with the least damping, followed from still air at one linearisation.
fn least_damped(section: &CoupledSection, speed_m_s: f64) -> Result<Mode> {
    let modes = Tracker::new(section).at(speed_m_s)?.all.into_iter();
    let least = modes.max_by(|a, b| a.lambda.re.total_cmp(&b.lambda.re));
    let why = format_args!("quasi-steady onset: no mode oscillates at {speed_m_s:.3} m/s");
    least.ok_or_else(|| Error::Numerical(why.to_string()))
}

fn described(name: &str, structure: &Structure, theory: &QuasiSteady, speed: f64) -> Result<Onset> {
    let mode_at = |speed: f64| {
        let linear = at_equilibrium(structure, theory, speed)?;
        least_damped(&CoupledSection::with_model(structure, &linear)?, speed)
    };
    let mode = mode_at(speed)?;
    let nearby = mode_at(speed * (1.0 - SLOPE_STEP))?;
    let method = OnsetMethod::Eigenvalues;
    let at = CriticalPoint::of_motion(name, method, structure, speed, mode.lambda.im);
    let branch = structure.branch_name(mode.branch);
    let mut onset = Onset::new(at, structure, &mode.shape, branch);
    let slope = damping_ratio(mode.lambda) - damping_ratio(nearby.lambda);
    onset.damping_slope_s_m = Some(slope / (speed * SLOPE_STEP));
    let v_star = onset.at.reduced_velocity.v_star();
    if v_star < LEAST_REDUCED_VELOCITY {
        onset.warnings.push(format!(
            "V* {v_star:.2} at this onset is below {LEAST_REDUCED_VELOCITY}: quasi-steady theory does not hold there"
        ));
    }
    Ok(onset)
}
