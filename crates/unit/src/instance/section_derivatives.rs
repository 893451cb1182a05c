//! Derivatives of a section. Outputs and rates of the state are linear in state and forces, `y = C(V) z + D w`,
//! `ż = A(V) z + E w`, so their derivatives are products with the same matrices; those with respect to the wind speed are
//! closed too. Only section properties are differenced.

use super::layout::Source;
use super::memory::Memory;
use super::section_unit::SectionUnit;
use super::sensitivity::{
    SectionValues, add, central_difference, check_finite, parameter_step, pick, speed_sensitivity,
};
use super::trust::{MonitoredUnit, is_of_onset, without_motion};
use super::unit::Differentiable;
use crate::error::Result;
use crate::flutter::smallest_damping;
use crate::refusal::CallResult;
use crate::resources::Resources;
use crate::response::{Inputs, Outputs, Stepper};
use crate::variables::{Role, Safety};

impl Differentiable for SectionUnit {
    fn output_rates(&mut self, memory: &mut Memory, outputs: &[Role]) -> CallResult<Vec<f64>> {
        let all = self.time_derivative(memory)?;
        let rate = |role: &Role| -> CallResult<f64> {
            match role {
                Role::Status(_) => Ok(self.present_by_wind(memory, *role)? * memory.input_rates[0]),
                response => Ok(pick(&all, *response)),
            }
        };
        outputs.iter().map(rate).collect()
    }

    fn derivatives(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        known: usize,
        unknowns: &[Role],
    ) -> CallResult<Vec<f64>> {
        let instant = match Source::of(resources.table.variables()[known].role) {
            Source::Input => self.by_input(memory, known)?,
            Source::Release => self.by_release(memory, known)?,
            Source::Response | Source::State => self.by_state(memory, known)?,
            _ => {
                let step = parameter_step(memory.values[known]);
                return central_difference(resources, memory, known, step, |other| {
                    self.unknowns(resources, other, unknowns)
                });
            }
        };
        let derivative = |unknown: &Role| match unknown {
            Role::Status(_) if known == self.places.wind_speed => {
                self.present_by_wind(memory, *unknown)
            }
            other => Ok(instant.pick(*other)),
        };
        Ok(unknowns.iter().map(derivative).collect::<Result<_>>()?)
    }
}

impl SectionUnit {
    /// `ẏ = C ż + D ẇ + (∂y/∂V) V̇` of all outputs.
    pub(super) fn time_derivative(&mut self, memory: &Memory) -> CallResult<Outputs> {
        self.load_inputs(memory);
        let Some(stepper) = &mut self.stepper else {
            return Ok(Outputs::default());
        };
        let velocity = stepper.state_derivative(&memory.system, &self.inputs)?;
        let velocity = memory.system.with_all(&velocity);
        let driven = Inputs {
            force: self.inputs.force_rate.clone(),
            gust_m_s: self.inputs.gust_rate_m_s2.clone(),
            ..Inputs::steady(self.inputs.wind_speed_m_s, self.inputs.force.len())
        };
        let mut rates = Outputs::default();
        stepper.outputs(&velocity, &driven, &mut rates)?;
        let by_speed = speed_sensitivity(stepper, &memory.system, &self.inputs);
        add(&mut rates, &by_speed, self.inputs.wind_speed_rate_m_s2);
        check_finite(&rates)?;
        Ok(rates)
    }

    fn by_input(&mut self, memory: &Memory, known: usize) -> Result<SectionValues> {
        self.load_inputs(memory);
        let speed = self.inputs.wind_speed_m_s;
        let Some(stepper) = &mut self.stepper else {
            return Ok(SectionValues::default());
        };
        if known == self.places.wind_speed {
            return Ok(SectionValues::by_speed(
                stepper,
                &memory.system,
                &self.inputs,
            ));
        }
        let mut unit = Inputs::steady(speed, self.places.force.len());
        for (force, place) in unit.force.iter_mut().zip(&self.places.force) {
            *force = f64::from(u8::from(*place == known));
        }
        let gusts = self.places.gusts.iter();
        unit.gust_m_s = gusts.map(|p| f64::from(u8::from(*p == known))).collect();
        let at_rest = memory
            .system
            .with_all(&vec![0.0; memory.system.all().len()]);
        SectionValues::of(stepper, &at_rest, &unit)
    }

    fn by_state(&mut self, memory: &Memory, known: usize) -> Result<SectionValues> {
        let speed = memory.values[self.places.wind_speed];
        let mut unit = vec![0.0; memory.system.all().len()];
        if let Some(entry) = self.places.state_entry[known] {
            unit[entry] = 1.0;
        }
        let unit = memory.system.with_all(&unit);
        match &mut self.stepper {
            Some(stepper) => {
                let still = Inputs::steady(speed, self.places.force.len());
                SectionValues::of(stepper, &unit, &still)
            }
            None => Ok(SectionValues::default()),
        }
    }

    /// The release is linear in its displacements and rates.
    fn by_release(&mut self, memory: &Memory, known: usize) -> Result<SectionValues> {
        let mut unit = vec![0.0; memory.values.len()];
        unit[known] = 1.0;
        let speed = memory.values[self.places.wind_speed];
        let still = Inputs::steady(speed, self.places.force.len());
        let Some(stepper) = &self.stepper else {
            return Ok(SectionValues::default());
        };
        let state = self.release(stepper, &unit)?;
        match &mut self.stepper {
            Some(stepper) => SectionValues::of(stepper, &state, &still),
            None => Ok(SectionValues::default()),
        }
    }

    /// The unknowns for the values in `memory`.
    fn unknowns(
        &mut self,
        resources: &Resources,
        memory: &Memory,
        unknowns: &[Role],
    ) -> CallResult<Vec<f64>> {
        let values = &memory.values;
        let wants = |wanted: fn(&Role) -> bool| unknowns.iter().any(wanted);
        let mut instant = SectionValues::default();
        let moves = |u: &Role| {
            matches!(
                u,
                Role::Response(..) | Role::Filter(_) | Role::FilterRate(_)
            )
        };
        if wants(moves) {
            let mut stepper: Stepper = self.new_stepper(resources, values)?;
            let state = self.release(&stepper, values)?;
            self.load_inputs(memory);
            instant = SectionValues::of(&mut stepper, &state, &self.inputs)?;
        }
        let wind = values[self.places.wind_speed];
        let card = if wants(is_of_onset) {
            Some(self.onset_card(resources, values))
        } else {
            None
        };
        let damping = if unknowns.contains(&Role::Status(Safety::DampingNow)) {
            smallest_damping(self.new_stepper(resources, values)?.section(), wind)?
        } else {
            0.0
        };
        let calculated = |which| card.as_ref().map_or(0.0, |card| card.value(which));
        let value = |unknown: &Role| {
            let still = without_motion(*unknown, calculated, wind, damping);
            still.unwrap_or_else(|| instant.pick(*unknown))
        };
        Ok(unknowns.iter().map(value).collect())
    }
}
