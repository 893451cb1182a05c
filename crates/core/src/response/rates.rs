//! Rates of the state, for importers that integrate and for derivatives.

use super::{Inputs, Outputs, SectionState, Stepper};
use crate::error::Result;
use crate::state_space::StateEquation;
use nalgebra::DVector;

impl Stepper {
    /// `d/dt` of the state values and, behind them, of the lagging gusts; filters of the discrete model stand still between samples.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for inputs that are not finite.
    pub fn state_derivative(&mut self, state: &SectionState, inputs: &Inputs) -> Result<Vec<f64>> {
        let n = self.section.structure().dofs.len();
        inputs.check(n)?;
        if let Some(sampling) = &self.sampling {
            let z = DVector::from_column_slice(&state.values);
            let (gusts, _) = self.gusts_per_wind(state, inputs);
            let wind = inputs.wind_speed_m_s.max(0.0);
            let w = DVector::from_fn(n, |i, _| inputs.force[i] + wind * gusts[i]);
            let force = sampling.force(&state.values, wind);
            let force = DVector::from_column_slice(&force[..n]);
            let StateEquation { a, b } = self.section.structure_alone();
            let motion = a * z.rows(0, 2 * n) + b * (w + force);
            let mut derivative = vec![0.0; state.values.len()];
            derivative[..2 * n].copy_from_slice(motion.as_slice());
            return Ok(derivative);
        }
        let mut now = Outputs::default();
        self.outputs(state, inputs, &mut now)?;
        let mut derivative = [now.rate, now.acceleration].concat();
        let by_wind = self.section.filter_rates_per_wind(&state.values);
        let wind = inputs.wind_speed_m_s.max(0.0);
        derivative.extend(by_wind.iter().map(|x| wind * x));
        let (_, lagging) = self.gusts_per_wind(state, inputs);
        derivative.extend(lagging.iter().map(|x| wind * x));
        Ok(derivative)
    }

    /// Force of the gusts per unit length and 1 m/s of wind, and the rates of their lags per 1 m/s.
    pub fn gusts_per_wind(&self, state: &SectionState, inputs: &Inputs) -> (Vec<f64>, Vec<f64>) {
        let mut force = vec![0.0; self.section.structure().dofs.len()];
        let Some(gusts) = self.series.gusts() else {
            return (force, Vec::new());
        };
        gusts.force_per_wind(&inputs.gust_m_s, &state.gusts, &mut force);
        let rates = gusts.rates_per_wind(&inputs.gust_m_s, &state.gusts);
        (force, rates)
    }
}
