//! Steps of the discrete Laguerre model: force sampled and held every `Δt = Δs B/V`.

use super::step_cache::apply;
use super::{Inputs, SectionState, Stepper, check_substeps, drop_what_died_out, overgrown};
use crate::aerodynamics::{DiscreteRealization, Realization};
use crate::error::{Error, Result};
use nalgebra::DVector;

/// A sample closer to the end of the step than this part of `Δs` is taken: the phase is known to rounding only.
const SAMPLE_TOLERANCE: f64 = 1e-10;

impl Stepper {
    /// Force of the filters, `½ρV² diag(B, B, B²) C S`, per unit length (n).
    pub(super) fn held_force(
        &self,
        model: &DiscreteRealization,
        values: &[f64],
        speed: f64,
    ) -> DVector<f64> {
        let s = self.section.structure();
        let n = s.dofs.len();
        let pressure = 0.5 * s.air_density_kg_m3 * speed * speed;
        let filters = DVector::from_column_slice(&values[2 * n..]);
        let mut force = &model.c * filters;
        for (i, f) in force.iter_mut().enumerate() {
            *f *= pressure * s.dofs[i].force_scale(s.width_m);
        }
        force
    }

    /// Moves the structure from sample to sample; the last piece ends between two samples.
    pub(super) fn advance_sampled(
        &mut self,
        state: &mut SectionState,
        inputs: &Inputs,
        step: f64,
    ) -> Result<()> {
        let Realization::Discrete(model) = self.section.aerodynamics().clone() else {
            return Err(Error::Numerical("step: the model is not sampled".into()));
        };
        let width = self.section.structure().width_m;
        let mean = inputs.wind_speed_m_s + 0.5 * inputs.wind_speed_rate_m_s2 * step;
        check_substeps((mean * step / (model.delta_s * width)).ceil(), step)?;
        let mut next = state.clone();
        let mut now = inputs.clone();
        let mut remaining = step;
        while remaining > 0.0 {
            let distance = (1.0 - next.phase) * model.delta_s * width;
            let wait = time_to_cover(distance, now.wind_speed_m_s, now.wind_speed_rate_m_s2);
            let sampled = remaining >= wait * (1.0 - SAMPLE_TOLERANCE);
            let piece = if sampled { wait } else { remaining };
            self.move_structure(&model, &mut next, &now, piece)?;
            let travelled =
                (now.wind_speed_m_s + 0.5 * now.wind_speed_rate_m_s2 * piece) * piece / width;
            advance_inputs(&mut now, piece);
            if sampled {
                self.sample(&model, &mut next);
                next.phase = 0.0;
                remaining = (remaining - piece).max(0.0);
            } else {
                next.phase += travelled / model.delta_s;
                remaining = 0.0;
            }
        }
        if !next.values.iter().all(|x| x.is_finite()) {
            return Err(overgrown());
        }
        drop_what_died_out(&mut next.values);
        *state = next;
        Ok(())
    }

    /// Structure alone under the held force and the external one.
    fn move_structure(
        &mut self,
        model: &DiscreteRealization,
        state: &mut SectionState,
        inputs: &Inputs,
        piece: f64,
    ) -> Result<()> {
        if piece <= 0.0 {
            return Ok(());
        }
        let n = inputs.force.len();
        let force = self.held_force(model, &state.values, inputs.wind_speed_m_s);
        let mut operand = Vec::with_capacity(4 * n);
        operand.extend_from_slice(&state.values[..2 * n]);
        operand.extend(force.iter().zip(&inputs.force).map(|(held, w)| held + w));
        operand.extend_from_slice(&inputs.force_rate);
        let step = self.cache.structure(&self.section, piece)?;
        apply(step, &operand, &mut state.values[..2 * n]);
        Ok(())
    }

    /// `S(k+1) = A S(k) + B r(k+1)`.
    fn sample(&self, model: &DiscreteRealization, state: &mut SectionState) {
        let s = self.section.structure();
        let n = s.dofs.len();
        let motion = DVector::from_fn(n, |i, _| {
            state.values[i] * s.dofs[i].motion_scale(s.width_m)
        });
        let filters = DVector::from_column_slice(&state.values[2 * n..]);
        let new = &model.a * filters + &model.b * motion;
        state.values[2 * n..].copy_from_slice(new.as_slice());
    }
}

/// Time in which the wind covers `distance`, starting at `speed` with the acceleration `rate`; infinite if never.
fn time_to_cover(distance: f64, speed: f64, rate: f64) -> f64 {
    if rate == 0.0 {
        return if speed > 0.0 {
            distance / speed
        } else {
            f64::INFINITY
        };
    }
    let discriminant = speed * speed + 2.0 * rate * distance;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    let sum = speed + discriminant.sqrt();
    if sum > 0.0 {
        2.0 * distance / sum
    } else {
        f64::INFINITY
    }
}

fn advance_inputs(inputs: &mut Inputs, piece: f64) {
    // rounding must not turn a wind that comes to rest into a negative one
    inputs.wind_speed_m_s = (inputs.wind_speed_m_s + inputs.wind_speed_rate_m_s2 * piece).max(0.0);
    for (w, rate) in inputs.force.iter_mut().zip(&inputs.force_rate) {
        *w += rate * piece;
    }
}
