//! Rates of the state, for importers that integrate and for derivatives.

use super::{Inputs, Outputs, SectionState, Stepper};
use crate::error::Result;
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
            let gusts = self.gust_force(state, inputs);
            let mut w = DVector::from_column_slice(&inputs.force);
            w.iter_mut().zip(gusts).for_each(|(w, gust)| *w += gust);
            let force = sampling.force(&state.values, inputs.wind_speed_m_s.max(0.0));
            let force = DVector::from_column_slice(&force[..n]);
            let (a, b) = self.section.structure_alone();
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
        if let Some(gusts) = self.series.gusts() {
            let lagging = gusts.rates_per_wind(&inputs.gust_m_s, &state.gusts);
            derivative.extend(lagging.iter().map(|x| wind * x));
        }
        Ok(derivative)
    }
}
