//! Whether the section is stable in smooth wind: without that a response to turbulence means nothing.
//!
//! For any `G` that is analytic for `Re iK > 0` and at most quadratic there, the number of roots of `det Z(λ)` with
//! positive real part follows from the turning of `det Z(iω)` (principle of the argument): over `0 < ω < ∞` it turns by
//! `(n − N)π`.

use super::problem::BuffetingProblem;
use crate::error::{Error, Result, positive};
use nalgebra::Complex;
use std::f64::consts::{PI, TAU};

/// Frequencies of the first pass.
const GRID: usize = 600;
/// Below the lowest and above the highest natural frequency by these factors nothing turns any more.
const REACH: (f64, f64) = (1e-4, 1e3);
/// Turning between two frequencies from which on the interval is halved, rad.
const LARGEST_TURN: f64 = 0.8;
/// Halvings of one interval at most: then the impedance is singular for all that numbers can tell.
const MAX_HALVINGS: usize = 48;
/// Distance from a whole number that the count may have.
const WHOLE: f64 = 0.2;

impl BuffetingProblem<'_> {
    /// Lowest and highest still-air frequency, Hz.
    pub(super) fn natural_range_hz(&self) -> (f64, f64) {
        self.structure
            .still_air_rad_s()
            .map(|omega| omega / TAU)
            .filter(|f| *f > 0.0)
            .fold((f64::INFINITY, 0.0), |(low, high), f| {
                (f.min(low), f.max(high))
            })
    }

    pub(super) fn determinant(&self, frequency_hz: f64, speed_m_s: f64) -> Result<Complex<f64>> {
        Ok(self.impedance(frequency_hz, speed_m_s)?.determinant())
    }
}

/// Number of eigenvalues with positive real part at a wind speed.
///
/// # Errors
/// [`Error::Input`] for a speed that is not positive; [`Error::Numerical`] at an onset itself, where the impedance is
/// singular.
pub(crate) fn unstable_roots(problem: &BuffetingProblem<'_>, speed_m_s: f64) -> Result<usize> {
    positive("wind speed", speed_m_s)?;
    let (low, high) = problem.natural_range_hz();
    let at = |f: f64| problem.determinant(f, speed_m_s);
    let (first, last) = (low * REACH.0, high * REACH.1);
    let frequency = |i: usize| first * (last / first).powf(i as f64 / GRID as f64);
    let mut before = (frequency(0), at(frequency(0))?);
    // the ends lie off the real axis by as much as the damping does there
    let mut turned = off_axis(before.1);
    for i in 1..=GRID {
        let next = (frequency(i), at(frequency(i))?);
        turned += turn(&at, before, next, 0)?;
        before = next;
    }
    turned -= off_axis(before.1);
    let n = problem.structure.dofs.len() as f64;
    let count = n - turned / PI;
    if (count - count.round()).abs() > WHOLE || count < -WHOLE {
        return Err(Error::Numerical(format!(
            "stability at {speed_m_s} m/s: the impedance turns by {turned:.3} rad, no whole number of half turns"
        )));
    }
    Ok(count.round().max(0.0) as usize)
}

/// Angle of a value to the real axis, in (−π/2, π/2].
fn off_axis(z: Complex<f64>) -> f64 {
    (z * z.re.signum()).arg()
}

/// Turning of the determinant between two frequencies, by halves until it is small.
fn turn(
    at: &impl Fn(f64) -> Result<Complex<f64>>,
    a: (f64, Complex<f64>),
    b: (f64, Complex<f64>),
    depth: usize,
) -> Result<f64> {
    let angle = (b.1 / a.1).arg();
    if angle.abs() <= LARGEST_TURN {
        return Ok(angle);
    }
    if depth == MAX_HALVINGS || !angle.is_finite() {
        return Err(Error::Numerical(format!(
            "stability: the impedance is singular at {} Hz",
            a.0
        )));
    }
    let middle = 0.5 * (a.0 + b.0);
    let middle = (middle, at(middle)?);
    Ok(turn(at, a, middle, depth + 1)? + turn(at, middle, b, depth + 1)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::{FlatPlate, RationalModel, Realizable, Transfer};
    use crate::aeroelastic::CoupledSection;
    use crate::buffeting::{GustForces, Turbulence};
    use crate::section::SectionModel;

    fn count(model: &dyn Transfer, speed: f64) -> usize {
        let structure = SectionModel::iabse_1_1a().structure().unwrap();
        let problem = BuffetingProblem {
            structure: &structure,
            model,
            forces: &GustForces::flat_plate(),
            turbulence: &Turbulence::default(),
        };
        unstable_roots(&problem, speed).unwrap()
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

    /// The same count from the eigenvalues of the realisation.
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
    }
}
