//! Steps of continuous models while the wind speed changes: the Magnus series to fourth order.
//!
//! With `y = [z, w, ẇ]` and `y' = M(t) y`, one sub-step is `y(t+τ) = exp(½τ(M₁ + M₂) + (√3/12)τ²[M₂, M₁]) y(t)`,
//! `M₁`, `M₂` at the two Gauss points (Iserles and Nørsett 1999). Exact again when the speed is constant.

use super::{Inputs, SectionState, Stepper, check_substeps, drop_what_died_out, load, overgrown};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::state_space::matrix_exponential;
use nalgebra::{DMatrix, DVector};

/// Sub-steps turn the fastest rate of the system by no more than this angle, in rad.
const ANGLE_PER_SUBSTEP: f64 = 0.25;

impl Stepper {
    pub(super) fn advance_varying_speed(
        &mut self,
        state: &mut SectionState,
        inputs: &Inputs,
        step: f64,
    ) -> Result<()> {
        let rate = inputs.wind_speed_rate_m_s2;
        let fastest = fastest_rate(
            &self.section,
            inputs
                .wind_speed_m_s
                .max(inputs.wind_speed_m_s + rate * step),
        );
        let count = (step * fastest / ANGLE_PER_SUBSTEP).ceil().max(1.0);
        check_substeps(count, step)?;
        load(&mut self.operand, &state.values, inputs);
        let mut y = DVector::from_column_slice(&self.operand);
        let tau = step / count;
        for i in 0..count as usize {
            let start = inputs.wind_speed_m_s + rate * (i as f64 * tau);
            y = magnus_exponential(&self.section, start, rate, tau)? * y;
        }
        let new = y.rows(0, state.values.len());
        if !new.iter().all(|x| x.is_finite()) {
            return Err(overgrown());
        }
        state.values.copy_from_slice(new.as_slice());
        drop_what_died_out(&mut state.values);
        Ok(())
    }
}

/// Highest natural frequency or filter rate, rad/s.
fn fastest_rate(section: &CoupledSection, speed: f64) -> f64 {
    let s = section.structure();
    let structural = (0..s.dofs.len())
        .map(|i| (s.stiffness[(i, i)] * section.inverse_mass()[(i, i)]).sqrt())
        .fold(0.0, f64::max);
    let filters = match section.aerodynamics() {
        crate::aerodynamics::Realization::Continuous(c) => c.a.diagonal().amax(),
        crate::aerodynamics::Realization::Discrete(_) => 0.0,
    };
    structural.max(filters * speed / s.width_m)
}

fn magnus_exponential(
    section: &CoupledSection,
    start: f64,
    rate: f64,
    tau: f64,
) -> Result<DMatrix<f64>> {
    let offset = 3f64.sqrt() / 6.0;
    let at = |fraction: f64| {
        // rounding must not turn a wind that comes to rest into a negative one
        augmented(section, (start + rate * (0.5 + fraction) * tau).max(0.0))
    };
    let (m1, m2) = (at(-offset)?, at(offset)?);
    let commutator = &m2 * &m1 - &m1 * &m2;
    let exponent = (m1 + m2) * (0.5 * tau) + commutator * (3f64.sqrt() / 12.0 * tau * tau);
    matrix_exponential(&exponent)
}

/// `[[A(V), B, 0], [0, 0, I], [0, 0, 0]]`.
fn augmented(section: &CoupledSection, speed: f64) -> Result<DMatrix<f64>> {
    let s = section.continuous_at(speed)?;
    let (n, m) = s.b.shape();
    let mut matrix = DMatrix::zeros(n + 2 * m, n + 2 * m);
    matrix.view_mut((0, 0), (n, n)).copy_from(&s.a);
    matrix.view_mut((0, n), (n, m)).copy_from(&s.b);
    matrix.view_mut((n, n + m), (m, m)).fill_with_identity();
    Ok(matrix)
}
