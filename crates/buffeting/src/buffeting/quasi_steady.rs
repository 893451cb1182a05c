//! Motion under nonlinear quasi-steady forces and gusts (1.8): classical Runge–Kutta steps of fourth order, halved
//! until two runs agree.

use crate::aerodynamics::GustSeries;
use crate::aerodynamics::quasi_steady::QuasiSteady;
use crate::error::{Error, Result, ensure, finite_numbers, positive};
use crate::section::{Dof, Structure};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Times that the step is halved before the run is given up.
const MAX_HALVINGS: u32 = 10;
/// First step, as a part of the shortest still-air period.
const FIRST_STEP: f64 = 0.1;
/// Longest run that is kept in memory, in steps.
const MAX_STEPS: f64 = 1e7;

/// A section under nonlinear quasi-steady forces in gusty wind: `M q̈ + R q̇ + K q = F(q, q̇, V, u(t), w(t))`.
#[derive(Debug, Clone)]
pub struct NonlinearSection<'a> {
    speed_m_s: f64,
    gusts: &'a GustSeries,
    structure: Structure,
    theory: QuasiSteady,
    inverse_mass: DMatrix<f64>,
    /// Places of the motions among the degrees of freedom: vertical, lateral if there is one, torsion.
    places: (usize, Option<usize>, usize),
}

/// Motion of one run, and how exact it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NonlinearRun {
    /// Time between rows, s.
    pub step_s: f64,
    /// Displacements (n) and rates (n) in each row: m, rad, m/s, rad/s.
    pub rows: Vec<Vec<f64>>,
    /// Runge–Kutta steps between two rows.
    pub substeps: usize,
    /// Largest difference to the run with half as many steps, as a part of the largest value of each quantity.
    pub step_error: f64,
}

impl<'a> NonlinearSection<'a> {
    /// Couples a structure with a theory of the same degrees of freedom, in a mean wind (m/s) and gusts about it.
    ///
    /// # Errors
    /// [`Error::Input`] when the degrees of freedom differ, [`Error::Numerical`] when one has no mass.
    pub fn new(
        structure: Structure,
        theory: QuasiSteady,
        speed_m_s: f64,
        gusts: &'a GustSeries,
    ) -> Result<Self> {
        theory.check_dofs("nonlinear section", &structure.dofs)?;
        let inverse_mass = structure.mass.clone().try_inverse().ok_or_else(|| {
            Error::Numerical("nonlinear section: a degree of freedom has no mass".into())
        })?;
        let lateral = structure.dofs.iter().position(|d| *d == Dof::Lateral);
        let places = (0, lateral, structure.dofs.len() - 1);
        Ok(Self {
            speed_m_s,
            gusts,
            structure,
            theory,
            inverse_mass,
            places,
        })
    }

    /// Runs from the state `[q, q̇]` for `steps` steps of `step_s`.
    ///
    /// The Runge–Kutta step is halved until a further halving changes no quantity by more than `tolerance` of its
    /// largest value; the finer run is returned. Its error is about a fifteenth of the stated difference.
    ///
    /// # Errors
    /// [`Error::Input`] for a state that is not 2n finite numbers, a speed (in still air no angle of attack is small), step
    /// or tolerance that is not positive, gusts that
    /// end before the run does, and, with the time, an angle of attack outside the table; [`Error::Numerical`] when the
    /// halving does not settle.
    pub fn run(
        &self,
        initial: &[f64],
        step_s: f64,
        steps: usize,
        tolerance: f64,
    ) -> Result<NonlinearRun> {
        positive("wind speed", self.speed_m_s)?;
        positive("step size", step_s)?;
        positive("tolerance", tolerance)?;
        let n = self.structure.dofs.len();
        finite_numbers("initial state", initial, 2 * n)?;
        let duration = step_s * steps as f64;
        // the last step may end on the last gust but for rounding
        let recorded = self.gusts.duration_s();
        let covered = duration <= recorded * (1.0 + 1e-9);
        let expected = format_args!("at least {duration} s of them");
        ensure(covered, "gusts", expected, format_args!("{recorded} s"))?;
        let omega = |i| (self.structure.stiffness[(i, i)] * self.inverse_mass[(i, i)]).sqrt();
        let period = std::f64::consts::TAU / (0..n).map(omega).fold(0.0, f64::max);
        let mut substeps = (step_s / (FIRST_STEP * period)).ceil().max(1.0) as usize;
        let mut coarse = self.rows(initial, step_s, steps, substeps)?;
        let mut step_error = f64::INFINITY;
        for _ in 0..MAX_HALVINGS {
            substeps *= 2;
            let fine = self.rows(initial, step_s, steps, substeps)?;
            step_error = largest_difference(&coarse, &fine);
            if step_error <= tolerance {
                return Ok(NonlinearRun {
                    step_s,
                    rows: fine,
                    substeps,
                    step_error,
                });
            }
            coarse = fine;
        }
        Err(Error::Numerical(format!(
            "nonlinear run: halving the step {MAX_HALVINGS} times leaves a difference of {step_error:.1e}, more than {tolerance:.1e}"
        )))
    }

    fn rows(
        &self,
        initial: &[f64],
        step_s: f64,
        steps: usize,
        substeps: usize,
    ) -> Result<Vec<Vec<f64>>> {
        let all = steps as f64 * substeps as f64;
        let expected = format_args!("at most {MAX_STEPS:.0e} steps");
        ensure(all <= MAX_STEPS, "run", expected, format_args!("{all:.1e}"))?;
        let mut state = DVector::from_column_slice(initial);
        let mut rows = Vec::with_capacity(steps + 1);
        rows.push(initial.to_vec());
        let h = step_s / substeps as f64;
        for i in 0..steps {
            for j in 0..substeps {
                // from the count, so that no rounding accumulates
                let time = step_s * i as f64 + h * j as f64;
                let next = self.runge_kutta(&state, time, h);
                state = next.map_err(|e| e.within(format!("t = {time:.3} s")))?;
            }
            rows.push(state.as_slice().to_vec());
        }
        Ok(rows)
    }

    fn runge_kutta(&self, z: &DVector<f64>, t: f64, h: f64) -> Result<DVector<f64>> {
        let k1 = self.rate(z, t)?;
        let k2 = self.rate(&(z + &k1 * (0.5 * h)), t + 0.5 * h)?;
        let k3 = self.rate(&(z + &k2 * (0.5 * h)), t + 0.5 * h)?;
        let k4 = self.rate(&(z + &k3 * h), t + h)?;
        Ok(z + (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0))
    }

    /// `d/dt [q, q̇]`.
    fn rate(&self, z: &DVector<f64>, time: f64) -> Result<DVector<f64>> {
        let s = &self.structure;
        let n = s.dofs.len();
        let (u, w) = self.gusts.at(time);
        let (vertical, lateral, torsion) = self.places;
        let wind = [
            self.speed_m_s + u - lateral.map_or(0.0, |i| z[n + i]),
            // of the reference point
            w - z[n + vertical] - s.axis_offset_m * z[n + torsion],
            s.width_m * z[n + torsion],
        ];
        let mut forces = self.theory.specific_forces(z[torsion], wind)?;
        forces[torsion] += s.axis_offset_m / s.width_m * forces[vertical];
        let mut total = DVector::from_fn(n, |i, _| {
            0.5 * s.air_density_kg_m3 * s.dofs[i].force_scale(s.width_m) * forces[i]
        });
        total -= &s.damping * z.rows(n, n) + &s.stiffness * z.rows(0, n);
        let acceleration = &self.inverse_mass * total;
        Ok(DVector::from_fn(2 * n, |i, _| {
            if i < n { z[n + i] } else { acceleration[i - n] }
        }))
    }
}

/// Over all quantities: largest difference as a part of the largest value.
pub fn largest_difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let quantities = b.first().map_or(0, Vec::len);
    (0..quantities)
        .map(|i| {
            let size = b.iter().map(|row| row[i].abs()).fold(0.0, f64::max);
            let difference = a
                .iter()
                .zip(b)
                .map(|(a, b)| (a[i] - b[i]).abs())
                .fold(0.0, f64::max);
            if size > 0.0 { difference / size } else { 0.0 }
        })
        .fold(0.0, f64::max)
}
