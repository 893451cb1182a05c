//! Outputs, and rates of the state for importers that integrate and for derivatives.

use super::matrix_polynomial::MatrixPolynomial;
use super::packed::{Packed, apply};
use super::step_cache::load;
use super::{Inputs, Outputs, SectionState, Stepper};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::state_space::StateEquation;
use nalgebra::DVector;

/// Terms of the output equations.
const POWERS_OF_WIND: usize = 3;

impl Stepper {
    /// `d/dt` of the state values and, behind them, of the lagging gusts; filters of the discrete model stand still between samples.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for inputs that are not finite.
    pub fn state_derivative(&mut self, state: &SectionState, inputs: &Inputs) -> Result<Vec<f64>> {
        let mut derivative = vec![0.0; state.values.len() + self.gust_states()];
        self.write_derivative(state, inputs, &mut derivative)?;
        Ok(derivative)
    }

    /// The same in place, of so many numbers; of a continuous model without memory from the system.
    ///
    /// # Errors
    /// As [`state_derivative`](Self::state_derivative).
    pub fn write_derivative(
        &mut self,
        state: &SectionState,
        inputs: &Inputs,
        derivative: &mut [f64],
    ) -> Result<()> {
        let n = self.section.structure().dofs.len();
        inputs.check(n, 0.0)?;
        let wind = inputs.wind_speed_m_s.max(0.0);
        let (values, lagging) = derivative.split_at_mut(state.values.len());
        self.lag_rates_per_wind(state, inputs, lagging);
        lagging.iter_mut().for_each(|rate| *rate *= wind);
        if let Some(sampling) = &self.sampling {
            let z = DVector::from_column_slice(&state.values);
            let gusts = self.gusts_per_wind(state, inputs);
            let w = DVector::from_fn(n, |i, _| inputs.force[i] + wind * gusts[i]);
            let force = sampling.force(&state.values, wind);
            let force = DVector::from_column_slice(&force[..n]);
            let StateEquation { a, b } = self.section.structure_alone();
            let motion = a * z.rows(0, 2 * n) + b * (w + force);
            values[2 * n..].fill(0.0);
            values[..2 * n].copy_from_slice(motion.as_slice());
            return Ok(());
        }
        let mut now = std::mem::take(&mut self.now);
        let found = self.outputs(state, inputs, &mut now);
        if found.is_ok() {
            values[..n].copy_from_slice(&now.rate);
            values[n..2 * n].copy_from_slice(&now.acceleration);
        }
        self.now = now;
        found?;
        let filters = &mut values[2 * n..];
        self.section.filter_rates_per_wind(&state.values, filters);
        filters.iter_mut().for_each(|rate| *rate *= wind);
        Ok(())
    }

    /// Force of the gusts per unit length and 1 m/s of wind.
    pub fn gusts_per_wind(&self, state: &SectionState, inputs: &Inputs) -> Vec<f64> {
        let mut force = vec![0.0; self.section.structure().dofs.len()];
        if let Some(gusts) = &self.series.gusts {
            gusts.force_per_wind(&inputs.gust_m_s, &state.gusts, &mut force);
        }
        force
    }

    /// Rates of the lagging gusts per 1 m/s of wind.
    pub fn lag_rates_per_wind(&self, state: &SectionState, inputs: &Inputs, rates: &mut [f64]) {
        if let Some(gusts) = &self.series.gusts {
            gusts.rates_per_wind(&inputs.gust_m_s, &state.gusts, rates);
        }
    }

    /// Motion, accelerations and self-excited forces at the instant of `state`.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for inputs that are not finite.
    #[inline]
    pub fn outputs(
        &mut self,
        state: &SectionState,
        inputs: &Inputs,
        outputs: &mut Outputs,
    ) -> Result<()> {
        let n = self.section.structure().dofs.len();
        inputs.check(n, 0.0)?;
        outputs.displacement.clear();
        outputs.displacement.extend_from_slice(&state.values[..n]);
        outputs.rate.clear();
        outputs.rate.extend_from_slice(&state.values[n..2 * n]);
        outputs.acceleration.resize(n, 0.0);
        outputs.self_excited_force.resize(n, 0.0);
        let wind = inputs.wind_speed_m_s.max(0.0);
        self.operand[..state.values.len()].copy_from_slice(&state.values);
        let external = &mut self.operand[state.values.len()..][..n];
        external.copy_from_slice(&inputs.force);
        if let Some(gusts) = &self.series.gusts {
            let by_gusts = &mut self.both[..n];
            gusts.force_per_wind(&inputs.gust_m_s, &state.gusts, by_gusts);
            for (w, gust) in external.iter_mut().zip(by_gusts) {
                *w += wind * *gust;
            }
        }
        let columns = state.values.len() + n;
        let both = &mut self.both[..];
        apply(
            output_rows(&mut self.rows, &self.section, wind),
            &self.operand[..columns],
            both,
        );
        outputs.acceleration.copy_from_slice(&both[..n]);
        outputs.self_excited_force.copy_from_slice(&both[n..]);
        Ok(())
    }

    /// `[q̈, F]` after a step that could be [repeated](Self::repeat); `None` after any other.
    #[inline(always)]
    pub fn repeat_outputs(&mut self, state: &SectionState, inputs: &Inputs) -> Option<&[f64]> {
        let (_, columns) = self.repeatable?;
        let most = state.values.len() + inputs.force.len();
        let operand = if columns == state.values.len() {
            &state.values
        } else {
            load(&mut self.operand, &state.values, inputs);
            &self.operand[..columns.min(most)]
        };
        apply(
            output_rows(&mut self.rows, &self.section, inputs.wind_speed_m_s),
            operand,
            &mut self.both,
        );
        Some(&self.both)
    }
}

/// Rows of accelerations and self-excited forces on state and external forces at a wind speed.
#[inline(always)]
fn output_rows<'a>(
    rows: &'a mut Option<MatrixPolynomial>,
    section: &CoupledSection,
    wind_m_s: f64,
) -> &'a Packed {
    let rows = match rows {
        Some(rows) => rows,
        None => rows.insert(all_output_rows(section)),
    };
    rows.at(wind_m_s, POWERS_OF_WIND)
}

/// The same for every wind speed; once, and apart from the step.
#[cold]
fn all_output_rows(section: &CoupledSection) -> MatrixPolynomial {
    MatrixPolynomial::new(&section.output_rows_by_wind())
}
