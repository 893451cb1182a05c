//! Whether a structure is stable in smooth wind, and where it resonates: without the first a response to turbulence means
//! nothing.
//!
//! For any `G` that is analytic for `Re iK > 0` and at most quadratic there, the number of roots of `det Z(λ)` with
//! positive real part follows from the turning of `det Z(iω)` (principle of the argument): over `0 < ω < ∞` it turns by
//! `(n − N)π`. A table is what such a `G` is on the axis of frequencies, which is all that is asked for. At a resonance the
//! determinant turns by half a turn, the faster the less damped.

use crate::aerodynamics::Transfer;
use crate::error::{Error, Result, positive};
use crate::flutter::{impedance, pivots};
use crate::section::Structure;
use crate::units::in_equal_ratios;
use aerodeck_core::threads;
use nalgebra::Complex;
use std::f64::consts::{PI, TAU};

/// Frequencies of the first pass.
const GRID: usize = 600;
/// Below the lowest and above the highest natural frequency by these factors nothing turns any more.
const REACH: (f64, f64) = (1e-4, 1e3);
/// Of more degrees of freedom than this two resonances may be passed in one step, which is a whole turn, or none: steps about the
/// natural frequencies are this small, relatively, in this range about them.
pub(super) const FEW: usize = 3;
const FINE: f64 = 1.5e-3;
const FINE_REACH: (f64, f64) = (0.5, 1.5);
/// Turning between two frequencies from which on the interval is halved, rad.
const LARGEST_TURN: f64 = 0.8;
/// Halvings of one interval at most: then the impedance is singular for all that numbers can tell.
const MAX_HALVINGS: usize = 48;
/// Distance from a whole number that the count may have.
const WHOLE: f64 = 0.2;

/// A frequency, Hz, and the determinant over its size there.
type PhaseAt = (f64, Complex<f64>);

/// What the turning of the determinant over all frequencies tells at a wind speed: how many roots have a positive real part, and the
/// frequencies of resonance, Hz, rising, with half of the half-power width of each, Hz, negative where the motion grows.
///
/// # Errors
/// [`Error::Input`] for a speed that is not positive; [`Error::Numerical`] at an onset itself, where the impedance is
/// singular.
pub(super) fn turning(
    structure: &Structure,
    model: &dyn Transfer,
    speed_m_s: f64,
) -> Result<(usize, Vec<(f64, f64)>)> {
    positive("wind speed", speed_m_s)?;
    let at = |f: f64| -> Result<PhaseAt> {
        Ok((f, phase(impedance(structure, model, speed_m_s, TAU * f)?)))
    };
    let mut passed = Vec::new();
    let mut before: Option<PhaseAt> = None;
    let grid = frequencies(structure);
    let many = structure.dofs.len() > FEW;
    for next in threads::each(&grid, many, |f| at(*f)) {
        let next = next?;
        match &before {
            // the ends lie off the real axis by as much as the damping does there
            None => passed.push((next.0, off_axis(next.1))),
            Some(before) => turn(&at, before, &next, 0, &mut passed)?,
        }
        before = Some(next);
    }
    let turned = passed.last().map_or(0.0, |p| p.1) - before.map_or(0.0, |p| off_axis(p.1));
    let count = structure.dofs.len() as f64 - turned / PI;
    if (count - count.round()).abs() > WHOLE || count < -WHOLE {
        return Err(Error::Numerical(format!(
            "stability at {speed_m_s} m/s: the impedance turns by {turned:.3} rad, no whole number of half turns"
        )));
    }
    Ok((count.round().max(0.0) as usize, resonances(&passed)))
}

/// Frequencies of the first pass, rising.
fn frequencies(structure: &Structure) -> Vec<f64> {
    let natural = natural_hz(structure);
    let (low, high) = range(&natural);
    let (first, last) = (low * REACH.0, high * REACH.1);
    let mut all: Vec<f64> = in_equal_ratios(first, last, GRID + 1).collect();
    if structure.dofs.len() > FEW {
        let (from, to) = (low * FINE_REACH.0, high * FINE_REACH.1);
        let steps = ((to / from).ln() / FINE).ceil();
        all.extend(in_equal_ratios(from, to, steps as usize + 1));
        all.extend(natural);
    }
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| *a <= *b * (1.0 + 1e-9));
    all
}

/// Frequencies of the modes in still air, Hz.
fn natural_hz(structure: &Structure) -> Vec<f64> {
    let all = structure.still_air_rad_s().map(|omega| omega / TAU);
    all.filter(|f| *f > 0.0).collect()
}

/// Highest of them.
pub(super) fn highest_natural_hz(structure: &Structure) -> f64 {
    range(&natural_hz(structure)).1
}

fn range(hertz: &[f64]) -> (f64, f64) {
    let ends = (f64::INFINITY, 0.0f64);
    hertz
        .iter()
        .fold(ends, |(low, high), f| (f.min(low), f.max(high)))
}

/// The determinant over its size: that of many modes is beyond all numbers.
fn phase(impedance: nalgebra::DMatrix<Complex<f64>>) -> Complex<f64> {
    let unit = |z: &Complex<f64>| z.unscale(z.norm());
    match pivots(&impedance) {
        Some(pivots) => pivots.iter().map(unit).product(),
        None => Complex::from(f64::NAN),
    }
}

/// Angle of a value to the real axis, in (−π/2, π/2].
fn off_axis(z: Complex<f64>) -> f64 {
    (z * z.re.signum()).arg()
}

/// Adds the turning between two frequencies to `passed`, by halves until it is small.
fn turn(
    at: &impl Fn(f64) -> Result<PhaseAt>,
    a: &PhaseAt,
    b: &PhaseAt,
    depth: usize,
    passed: &mut Vec<(f64, f64)>,
) -> Result<()> {
    let angle = (b.1 / a.1).arg();
    if angle.abs() <= LARGEST_TURN {
        let before = passed.last().map_or(0.0, |p| p.1);
        passed.push((b.0, before + angle));
        return Ok(());
    }
    if depth == MAX_HALVINGS || !angle.is_finite() {
        return Err(Error::Numerical(format!(
            "stability: the impedance is singular at {} Hz",
            a.0
        )));
    }
    let middle = at(0.5 * (a.0 + b.0))?;
    turn(at, a, &middle, depth + 1, passed)?;
    turn(at, &middle, b, depth + 1, passed)
}

/// Where the determinant turns fastest, and how fast: frequency over angle of a resonance is half of its half-power width. By a
/// motion that grows it turns back.
fn resonances(passed: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let pairs = passed.windows(2);
    // middle of each step, and frequency over angle there
    let steps: Vec<(f64, f64)> = pairs
        .map(|p| {
            (
                0.5 * (p[0].0 + p[1].0),
                (p[1].0 - p[0].0) / (p[1].1 - p[0].1),
            )
        })
        .collect();
    let narrow = |step: &(f64, f64)| step.1.abs();
    let found = steps.windows(3).filter(|three| {
        let width = narrow(&three[1]);
        width < narrow(&three[0]) && width <= narrow(&three[2]) && width < three[1].0
    });
    found.map(|three| three[1]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::{FlatPlate, RationalModel, Realizable, Transfer};
    use crate::aeroelastic::CoupledSection;
    use crate::section::SectionModel;

    fn count(model: &dyn Transfer, speed: f64) -> usize {
        let structure = SectionModel::iabse_1_1a().structure().unwrap();
        turning(&structure, model, speed).unwrap().0
    }

    /// Onset 77.48 m/s, divergence 90.466 m/s, both computed independently.
    #[test]
    fn the_plate_loses_a_pair_at_its_onset_and_one_more_at_divergence() {
        let plate = FlatPlate {
            rotary_inertia: false,
        };
        for (speed, expected) in [
            (10.0, 0),
            (60.0, 0),
            (77.4, 0),
            (77.6, 2),
            (90.0, 2),
            (91.0, 3),
        ] {
            assert_eq!(count(&plate, speed), expected, "{speed}");
        }
    }

    /// The same count from the eigenvalues of the realisation, and the same resonances.
    #[test]
    fn agrees_with_eigenvalues() {
        let jones = RationalModel::jones_flat_plate();
        let structure = SectionModel::iabse_1_1a().structure().unwrap();
        let section = CoupledSection::new(structure, jones.realize()).unwrap();
        for speed in [20.0, 70.0, 76.6, 76.75, 85.0, 95.0, 130.0] {
            let eigenvalues = section.at(speed).unwrap().eigenvalues().unwrap();
            let unstable = eigenvalues.iter().filter(|z| z.re > 0.0).count();
            assert_eq!(count(&jones, speed), unstable, "{speed}");
        }
        let structure = SectionModel::iabse_1_1a().structure().unwrap();
        let (_, resonances_hz) = turning(&structure, &jones, 20.0).unwrap();
        let roots = section.at(20.0).unwrap().eigenvalues().unwrap();
        for root in roots.iter().filter(|z| z.im > 0.0) {
            let near = |(hertz, half): &(f64, f64)| (hertz - root.im / TAU).abs() < 0.6 * half;
            assert!(resonances_hz.iter().any(near), "{root}");
        }
    }
}
