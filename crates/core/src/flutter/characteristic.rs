//! The nonlinear eigenvalue problem of a continuous model: `D(λ) v = 0` with as many rows as degrees of freedom.
//!
//! `D(λ) = λ²M + λR + K − ½ρ diag(B, B, B²) [V²e₀ + VBλe₁ + B²λ²e₂ + V³ C (λB I − V A)⁻¹ b] diag(1/B, 1/B, 1)`,
//! written so that still air is no special case. The filter matrices of this crate are lower triangular, so one
//! evaluation is a forward substitution: much cheaper than the eigenvalues of the whole state matrix.

use super::dynamic_stiffness::{Determinant, Small, ZERO, newton, oscillator};
use crate::aerodynamics::Realization;
use crate::aeroelastic::CoupledSection;
use crate::section::{Dof, Suspension};
use crate::state_space::Complex64;
use nalgebra::{DMatrix, DVector};
use std::array::from_fn;

/// Degrees of freedom at most.
const MAX_DOFS: usize = 3;
/// Newton steps before a start is given up as too far away.
const MAX_NEWTON_STEPS: usize = 15;
/// Relative size of the last Newton step.
const NEWTON_TOLERANCE: f64 = 1e-13;

/// Matrices of the problem, scaled to physical motion and force once.
#[derive(Debug, Clone)]
pub(super) struct Characteristic {
    n: usize,
    width: f64,
    mass: [[f64; MAX_DOFS]; MAX_DOFS],
    damping: [[f64; MAX_DOFS]; MAX_DOFS],
    stiffness: [[f64; MAX_DOFS]; MAX_DOFS],
    feed_through: [[[f64; MAX_DOFS]; MAX_DOFS]; 3],
    filters: usize,
    /// Filter matrix, row by row.
    a: Vec<f64>,
    /// Input matrix, column by column.
    b: Vec<f64>,
    /// Scaled output matrix, row by row.
    c: Vec<f64>,
}

impl Characteristic {
    /// The problem of `section`; `None` for sampled models and for filter matrices that are not lower triangular.
    pub(super) fn new(section: &CoupledSection) -> Option<Self> {
        let Realization::Continuous(aero) = section.aerodynamics() else {
            return None;
        };
        let triangular =
            (0..aero.a.nrows()).all(|i| (i + 1..aero.a.ncols()).all(|j| aero.a[(i, j)] == 0.0));
        let s = section.structure();
        let n = s.dofs.len();
        if n > MAX_DOFS || !triangular {
            return None;
        }
        let half_rho = 0.5 * s.air_density_kg_m3;
        let small = |m: &DMatrix<f64>| -> [[f64; MAX_DOFS]; MAX_DOFS] {
            from_fn(|i| from_fn(|j| m.get((i, j)).copied().unwrap_or(0.0)))
        };
        let air = |m: &DMatrix<f64>| small(&(s.scaled(m) * half_rho));
        let columns = |mut all: DMatrix<f64>, scale: &dyn Fn(Dof) -> f64| {
            for (mut column, dof) in all.column_iter_mut().zip(&s.dofs) {
                column *= scale(*dof);
            }
            all.as_slice().to_vec()
        };
        Some(Self {
            n,
            width: s.width_m,
            mass: small(&s.mass),
            damping: small(&s.damping),
            stiffness: small(&s.stiffness),
            feed_through: [air(&aero.e0), air(&aero.e1), air(&aero.e2)],
            filters: aero.a.nrows(),
            a: aero.a.transpose().as_slice().to_vec(),
            b: columns(aero.b.clone(), &|dof| dof.motion_scale(s.width_m)),
            c: columns(aero.c.transpose(), &|dof| {
                half_rho * dof.force_scale(s.width_m)
            }),
        })
    }

    /// Value and derivative of `D` at one `λ`.
    fn evaluate(
        &self,
        lambda: Complex64,
        speed: f64,
        work: &mut Vec<Complex64>,
    ) -> (Small<MAX_DOFS>, Small<MAX_DOFS>) {
        let (n, b) = (self.n, self.width);
        let mut value = [[ZERO; MAX_DOFS]; MAX_DOFS];
        let mut derivative = value;
        let [e0, e1, e2] = &self.feed_through;
        for i in 0..n {
            for j in 0..n {
                let with_air = Suspension {
                    mass: self.mass[i][j] - b * b * e2[i][j],
                    damping: self.damping[i][j] - speed * b * e1[i][j],
                    stiffness: self.stiffness[i][j] - speed * speed * e0[i][j],
                };
                (value[i][j], derivative[i][j]) = oscillator(lambda, with_air);
            }
        }
        let l = self.filters;
        work.resize(2 * l, ZERO);
        let (x, dx) = work.split_at_mut(l);
        let cube = speed * speed * speed;
        for j in 0..n {
            self.solve_filters(lambda, speed, &self.b[j * l..][..l], x, dx);
            for i in 0..n {
                let c = &self.c[i * l..][..l];
                for ((c, x), dx) in c.iter().zip(&*x).zip(&*dx) {
                    value[i][j] -= x * (c * cube);
                    derivative[i][j] -= dx * (c * cube);
                }
            }
        }
        (value, derivative)
    }

    /// `x = (λB I − V A)⁻¹ b` and `dx/dλ` by forward substitution.
    fn solve_filters(
        &self,
        lambda: Complex64,
        speed: f64,
        b: &[f64],
        x: &mut [Complex64],
        dx: &mut [Complex64],
    ) {
        let l = self.filters;
        for i in 0..l {
            let row = &self.a[i * l..][..l];
            let (mut sum, mut dsum) = (Complex64::new(b[i], 0.0), ZERO);
            for (m, a) in row[..i].iter().enumerate() {
                if *a != 0.0 {
                    sum += x[m] * (a * speed);
                    dsum += dx[m] * (a * speed);
                }
            }
            let pivot = (lambda * self.width - row[i] * speed).inv();
            x[i] = sum * pivot;
            dx[i] = (dsum - x[i] * self.width) * pivot;
        }
    }

    /// The eigenvalue next to `start` at the wind speed, with its displacements; `None` when Newton's method does not
    /// settle.
    pub(super) fn solve(
        &self,
        start: Complex64,
        speed: f64,
        work: &mut Vec<Complex64>,
    ) -> Option<(Complex64, DVector<Complex64>)> {
        let mut last = None;
        let lambda = newton(start, MAX_NEWTON_STEPS, NEWTON_TOLERANCE, |lambda| {
            let (value, derivative) = self.evaluate(lambda, speed, work);
            let determinant = Determinant::new(&value, self.n);
            let step = determinant.value / determinant.along(&derivative);
            last = Some(determinant);
            step
        })?;
        Some((lambda, last?.null_vector()))
    }
}
