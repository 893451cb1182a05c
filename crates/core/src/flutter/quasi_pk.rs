//! One mode at one wind speed of models that are only a `G(K)`, by the p-k iteration.
//!
//! The forces act as stiffness and damping at the frequency of the mode itself, `ω = Im λ`:
//! `M q̈ + (R − ½ρV² P(Im G)/ω) q̇ + (K − ½ρV² P(Re G)) q = 0` with `G` at `K = ωB/V`. Exact at an onset, where `λ` is
//! imaginary; for damped modes it means by frequency and damping what measured derivatives mean, not what the
//! eigenvalues of a realisation mean.

use super::determinant::StructureInWind;
use super::following::{Mode, oscillates};
use super::modal_characteristic::inverse_step;
use crate::aerodynamics::TransferMatrix;
use crate::error::{Error, Result};
use crate::state_space::{eigenvalues, eigenvector, first_order};
use crate::units::ReducedFrequency;
use nalgebra::DMatrix;

/// The iteration contracts by about ten a round; one that needs more than this has no solution.
const MAX_ROUNDS: usize = 200;
/// Relative change at which a mode counts as found.
const TOLERANCE: f64 = 1e-12;

impl StructureInWind<'_> {
    /// The mode at `speed_m_s` that the iteration reaches from `start`; `None` when it stops oscillating or does not settle.
    pub(super) fn pk_mode(&self, speed_m_s: f64, start: &Mode) -> Result<Option<Mode>> {
        self.converge(|_| speed_m_s, start)
    }

    /// The mode at the reduced frequency `k` that the iteration reaches from `start`, with its speed (m/s).
    pub(super) fn pk_mode_at(
        &self,
        k: ReducedFrequency,
        start: &Mode,
    ) -> Result<Option<(f64, Mode)>> {
        let speed = |omega: f64| omega * self.structure.width_m / k.full_width();
        let mode = self.converge(speed, start)?;
        Ok(mode.map(|mode| (speed(mode.lambda.im), mode)))
    }

    /// Iterates at the speed that belongs to each frequency.
    fn converge(&self, speed: impl Fn(f64) -> f64, start: &Mode) -> Result<Option<Mode>> {
        if self.structure.is_modal() {
            return self.settle_by_shape(speed, start);
        }
        let mut lambda = start.lambda;
        for _ in 0..MAX_ROUNDS {
            let matrix = self.frozen(speed(lambda.im), lambda.im)?;
            let all = eigenvalues(&matrix)?.into_iter().filter(oscillates);
            let next = all.min_by(|a, b| (a - lambda).norm().total_cmp(&(b - lambda).norm()));
            let Some(next) = next else { return Ok(None) };
            if (next - lambda).norm() <= TOLERANCE * next.norm() {
                let vector = eigenvector(&matrix, next)?;
                let shape = vector.rows(0, self.structure.dofs.len()).into_owned();
                return Ok(Some(Mode::new(start.branch, next, shape)));
            }
            lambda = next;
        }
        Ok(None)
    }

    /// The same for many modes: each round is a step of inverse iteration from the shape before with the forces at the last
    /// frequency, so that no eigenvalue is computed that is not asked for.
    fn settle_by_shape(&self, speed: impl Fn(f64) -> f64, start: &Mode) -> Result<Option<Mode>> {
        let (s, n) = (self.structure, start.shape.len());
        let mut lambda = start.lambda;
        let mut shape = start.shape.normalize();
        for _ in 0..MAX_ROUNDS {
            let force = self.frozen_forces(speed(lambda.im), lambda.im)?;
            let on_rate = &s.damping - force.map(|z| z.im / lambda.im);
            let stiffness = DMatrix::from_fn(n, n, |i, j| {
                (lambda * s.mass[(i, j)] + on_rate[(i, j)]) * lambda + s.stiffness[(i, j)]
                    - force[(i, j)].re
            });
            let slope = DMatrix::from_fn(n, n, |i, j| {
                lambda * (2.0 * s.mass[(i, j)]) + on_rate[(i, j)]
            });
            let Some(step) = inverse_step(&stiffness, slope * &shape, &mut shape) else {
                return Ok(None);
            };
            lambda -= step;
            if !oscillates(&lambda) {
                return Ok(None);
            }
            if step.norm() <= TOLERANCE * lambda.norm() {
                return Ok(Some(Mode::new(start.branch, lambda, shape)));
            }
        }
        Ok(None)
    }

    /// Forces of unit motions, frozen at the frequency `omega`.
    fn frozen_forces(&self, speed: f64, omega: f64) -> Result<TransferMatrix> {
        let k = omega * self.structure.width_m / speed;
        // on the way to a mode a table is asked beyond its ends; no mode is taken from there
        let k = self.model.known_range().map_or(k, |range| {
            k.clamp(range.min.full_width(), range.max.full_width())
        });
        self.forces(ReducedFrequency::from_full_width(k), speed)
    }

    /// State matrix of `[q, q̇]` with the forces frozen at one frequency.
    fn frozen(&self, speed: f64, omega: f64) -> Result<DMatrix<f64>> {
        let (s, force) = (self.structure, self.frozen_forces(speed, omega)?);
        let without = || Error::Numerical("quasi-p-k: a degree of freedom has no mass".into());
        let inverse = s.mass.clone().try_inverse().ok_or_else(without)?;
        let on_motion = force.map(|z| z.re) - &s.stiffness;
        let on_rate = force.map(|z| z.im / omega) - &s.damping;
        Ok(first_order(&inverse, &on_motion, &on_rate))
    }
}
