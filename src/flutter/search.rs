//! Onset by the eigenvalues of the coupled state matrix.

use super::curves::damping_ratio;
use super::onset::{FlutterSearch, Onset, OnsetMethod, choose};
use super::tracking::{TrackedMode, Tracker, branch_name, mode_shape, oscillates};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, positive};
use crate::section::Dof;
use crate::units::ReducedFrequencyRange;
use nalgebra::Complex;
use serde::{Deserialize, Serialize};

/// Relative width of the bracket at which the root search stops: rounding of the eigenvalues.
const ROOT_TOLERANCE: f64 = 1e-13;
/// The secant steps converge in about ten; bisection alone in fifty.
const MAX_ROOT_STEPS: usize = 80;

/// Speeds at which all eigenvalues are looked at, not only those of the structure.
const FILTER_CHECKS: usize = 24;

/// Where and how densely to look.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OnsetSearch {
    /// Highest wind speed searched, m/s.
    pub speed_max_m_s: f64,
    /// Number of speeds between still air and the highest.
    pub speeds: usize,
}

impl Default for OnsetSearch {
    fn default() -> Self {
        Self {
            speed_max_m_s: 100.0,
            speeds: 200,
        }
    }
}

/// First wind speed at which a mode of `section` loses its damping.
///
/// Every crossing up to the highest speed is found and refined; see [`FlutterSearch`] for which one is the answer.
/// `tested` is the range of reduced frequencies in which the model was tested.
///
/// # Errors
/// [`Error::Input`] for a search range that is none; [`Error::Numerical`] when modes cannot be told apart.
pub fn find_onset(
    model: &str,
    section: &CoupledSection,
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<FlutterSearch> {
    let speed_max = positive("flutter.speed_max_m_s", search.speed_max_m_s)?;
    if search.speeds < 2 {
        return Err(Error::input(
            "flutter.speeds",
            "at least 2",
            search.speeds.to_string(),
        ));
    }
    let mut crossings = Vec::new();
    let mut tracker = Tracker::start(section)?;
    for i in 1..=search.speeds {
        let speed = speed_max * i as f64 / search.speeds as f64;
        if speed <= tracker.speed {
            continue;
        }
        let next = tracker.advance(speed)?;
        for after in next.modes.iter().filter(|m| m.lambda.re >= 0.0) {
            if let Some(before) = tracker.mode(after.branch).filter(|m| m.lambda.re < 0.0) {
                let ends = (before.lambda.re, after.lambda.re);
                let branch = after.branch;
                crossings.push(structural_crossing(model, &tracker, &next, branch, ends)?);
            }
        }
        tracker = next;
    }
    crossings.extend(filter_crossings(model, section, speed_max)?);
    Ok(choose(crossings, tested, speed_max))
}

/// Refines the zero of `Re λ` of one structural mode.
fn structural_crossing(
    model: &str,
    low: &Tracker<'_>,
    high: &Tracker<'_>,
    branch: usize,
    (before, after): (f64, f64),
) -> Result<Onset> {
    let structure = low.section.structure();
    let mode_at = |speed: f64| -> Result<TrackedMode> {
        low.advance(speed)?.mode(branch).cloned().ok_or_else(|| {
            Error::Numerical(format!("onset: the mode does not oscillate at {speed} m/s"))
        })
    };
    let speed = root((low.speed, before), (high.speed, after), |speed| {
        Ok(mode_at(speed)?.lambda.re)
    })?;
    let at = mode_at(speed)?;
    let nearby = mode_at(speed * (1.0 - 1e-5))?;
    let slope = (damping_ratio(at.lambda) - damping_ratio(nearby.lambda)) / (speed * 1e-5);
    let mut onset = Onset::new(
        model,
        OnsetMethod::Eigenvalues,
        structure,
        (speed, at.lambda.im),
        &at.shape,
        branch_name(structure.dofs[branch]),
    );
    onset.damping_slope_s_m = Some(slope);
    if single_dof(structure.dofs[branch], onset.mode_ratio) {
        onset.warnings.push(format!(
            "the mode is almost purely {}: a one-degree-of-freedom instability",
            structure.dofs[branch].name()
        ));
    }
    Ok(onset)
}

/// Whether the mode hardly moves any other degree of freedom than its own.
fn single_dof(dof: Dof, mode_ratio: f64) -> bool {
    match dof {
        Dof::Torsion => mode_ratio < 0.05,
        Dof::Vertical => mode_ratio > 20.0,
        Dof::Lateral => false,
    }
}

/// The least damped oscillating eigenvalue that is none of the tracked modes.
fn least_damped_filter(section: &CoupledSection, at: &Tracker<'_>) -> Result<Option<Complex<f64>>> {
    let tracked = |z: &Complex<f64>| {
        let near = |m: &TrackedMode| (m.lambda - z).norm() < 1e-6 * z.norm();
        at.modes.iter().any(near)
    };
    Ok(section
        .at(at.speed)?
        .eigenvalues()?
        .into_iter()
        .filter(|z| oscillates(z) && !tracked(z))
        .max_by(|a, b| a.re.total_cmp(&b.re)))
}

/// Filter instabilities on a coarse grid of speeds: they belong to broken fits and set in over a wide range.
fn filter_crossings(model: &str, section: &CoupledSection, speed_max: f64) -> Result<Vec<Onset>> {
    let mut found = Vec::new();
    let mut tracker = Tracker::start(section)?;
    for i in 1..=FILTER_CHECKS {
        let speed = speed_max * i as f64 / FILTER_CHECKS as f64;
        if speed <= tracker.speed {
            continue;
        }
        let next = tracker.advance(speed)?;
        found.extend(filter_crossing(model, section, &tracker, &next)?);
        tracker = next;
    }
    Ok(found)
}

/// An oscillating eigenvalue of the filters that has become unstable between two speeds: no structural mode, hence a
/// defect of the model. Real eigenvalues are divergence and are found in closed form elsewhere.
fn filter_crossing(
    model: &str,
    section: &CoupledSection,
    low: &Tracker<'_>,
    high: &Tracker<'_>,
) -> Result<Option<Onset>> {
    let growth = |at: &Tracker<'_>| -> Result<f64> {
        Ok(least_damped_filter(section, at)?.map_or(f64::NEG_INFINITY, |z| z.re))
    };
    let (before, after) = (growth(low)?, growth(high)?);
    if before >= 0.0 || after < 0.0 {
        return Ok(None);
    }
    let speed = root(
        (low.speed, before.max(-after)),
        (high.speed, after),
        |speed| growth(&low.advance(speed)?),
    )?;
    let Some(lambda) = least_damped_filter(section, &low.advance(speed)?)? else {
        return Ok(None);
    };
    let shape = mode_shape(section, &section.at(speed)?, lambda)?;
    let mut onset = Onset::new(
        model,
        OnsetMethod::Eigenvalues,
        section.structure(),
        (speed, lambda.im),
        &shape,
        "aerodynamic".to_owned(),
    );
    onset.warnings.push(
        "an eigenvalue of the force model itself becomes unstable: a defect of the fit".to_owned(),
    );
    Ok(Some(onset))
}

/// Zero of `f` in a bracket with a sign change, by secant steps kept inside (Illinois) and bisection.
pub(super) fn root(
    low: (f64, f64),
    high: (f64, f64),
    f: impl Fn(f64) -> Result<f64>,
) -> Result<f64> {
    let (mut a, mut fa) = low;
    let (mut b, mut fb) = high;
    for step in 0..MAX_ROOT_STEPS {
        if fb == 0.0 || (b - a).abs() <= ROOT_TOLERANCE * b.abs() {
            break;
        }
        let secant = b - fb * (b - a) / (fb - fa);
        let middle = 0.5 * (a + b);
        let inside = (secant - a) * (secant - b) < 0.0;
        let x = if inside && step % 4 != 3 {
            secant
        } else {
            middle
        };
        let fx = f(x)?;
        if (fx >= 0.0) == (fb >= 0.0) {
            (b, fb) = (x, fx);
            fa *= 0.5;
        } else {
            (a, fa) = (x, fx);
            fb *= 0.5;
        }
    }
    Ok(b)
}
