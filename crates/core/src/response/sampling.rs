//! The filters of the discrete Laguerre model from sample to sample, and the force they hold between.

use super::packed::{Packed, apply};
use super::values::Inputs;
use crate::aerodynamics::Realization;
use crate::aeroelastic::CoupledSection;
use crate::section::Dof;
use nalgebra::DMatrix;

/// Degrees of freedom of a sampled model at most: heave, sway, rotation.
const MAX_DOFS: usize = Dof::THREE.len();

/// What the filters of the discrete model do at a sample, and the force they give.
#[derive(Debug, Clone)]
pub(super) struct Sampling {
    dofs: usize,
    /// Way of the wind from sample to sample, `Δs B`, m.
    pub way_m: f64,
    /// `½ρ diag(B, B, B²) C`: forces on `S` at 1 m/s.
    force: Packed,
    /// `[A, B diag(1/B, 1/B, 1)]` on `[S, q]`.
    next: Packed,
    /// `[S, q]`.
    operand: Vec<f64>,
}

impl Sampling {
    /// None for a continuous model.
    pub(super) fn from_section(section: &CoupledSection) -> Option<Self> {
        let Realization::Discrete(d) = section.aerodynamics() else {
            return None;
        };
        let s = section.structure();
        let (n, filters) = (s.dofs.len(), d.a.nrows());
        Some(Self {
            dofs: n,
            way_m: d.delta_s * s.width_m,
            force: Packed::new(&section.force_of_filters(&d.c, 1.0)),
            next: Packed::new(&DMatrix::from_fn(filters, filters + n, |l, j| {
                if j < filters {
                    d.a[(l, j)]
                } else {
                    d.b[(l, j - filters)] * s.dofs[j - filters].motion_scale(s.width_m)
                }
            })),
            operand: vec![0.0; filters + n],
        })
    }

    /// Force of the filters at a wind speed, per unit length.
    pub(super) fn force(&self, values: &[f64], wind: f64) -> [f64; MAX_DOFS] {
        let mut force = [0.0; MAX_DOFS];
        apply(&self.force, &values[2 * self.dofs..], &mut force);
        force.map(|f| f * (wind * wind))
    }

    /// `S(k+1) = A S(k) + B r(k+1)`.
    pub(super) fn sample(&mut self, values: &mut [f64]) {
        let filters = self.operand.len() - self.dofs;
        self.operand[..filters].copy_from_slice(&values[2 * self.dofs..]);
        self.operand[filters..].copy_from_slice(&values[..self.dofs]);
        apply(&self.next, &self.operand, &mut values[2 * self.dofs..]);
    }

    /// Wind, and the coefficients of the forces, from `time` after the start of the step on.
    pub(super) fn drive(
        &self,
        values: &[f64],
        inputs: &Inputs,
        time: f64,
    ) -> (f64, [[f64; MAX_DOFS]; 3]) {
        let rate = inputs.wind_speed_rate_m_s2;
        let wind = wind_after(inputs, time);
        let mut force = [[0.0; MAX_DOFS]; 3];
        let held = self.force(values, 1.0);
        for (i, (w, w_rate)) in inputs.force.iter().zip(&inputs.force_rate).enumerate() {
            force[0][i] = w + w_rate * time + held[i] * wind * wind;
            force[1][i] = w_rate + 2.0 * held[i] * wind * rate;
            force[2][i] = held[i] * rate * rate;
        }
        (wind, force)
    }
}

/// Wind speed `time` after the start of a step; rounding must not turn a wind that comes to rest into a negative one.
pub(super) fn wind_after(inputs: &Inputs, time: f64) -> f64 {
    (inputs.wind_speed_m_s + inputs.wind_speed_rate_m_s2 * time).max(0.0)
}
