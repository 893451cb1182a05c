//! What sections and bridges compute, and its derivatives. Outputs and rates of the state are linear in state, forces and gusts, `y = C(V) z + D w`,
//! `ż = A(V) z + E w`, so their derivatives are what one of each does; those with respect to the wind speed are closed too. Only
//! parameters are differenced.

use super::coupled::{Coupled, CoupledKind};
use super::layout::Source;
use super::memory::{Memory, Now};
use super::sensitivity::{SectionValues, add, central_difference, check_finite, parameter_step};
use super::unit::Prepared;
use crate::error::Result;
use crate::lifecycle::State;
use crate::refusal::CallResult;
use crate::variables::{ComputedNumber, Role};

impl<S: CoupledKind> Prepared for Coupled<S> {
    fn advance(&mut self, memory: &mut Memory, step: f64) -> CallResult<bool> {
        self.load_inputs_once(memory);
        let factor = self.indices.turbulence_factor;
        match factor.map_or(0.0, |index| memory.values[index]) {
            0.0 => {
                let stepper = &mut self.built.stepper;
                stepper.advance(&mut memory.system, &self.inputs, step)?;
            }
            factor => S::advance_in_turbulence(self, memory, step, factor)?,
        }
        Ok(false)
    }

    fn state_rates(&mut self, memory: &Memory, rates: &mut [f64]) -> CallResult<()> {
        self.load_inputs_once(memory);
        let stepper = &mut self.built.stepper;
        stepper.write_derivative(&memory.system, &self.inputs, rates)?;
        check_finite(&*rates)
    }

    fn outputs(&mut self, memory: &mut Memory) -> CallResult<()> {
        self.load_inputs_once(memory);
        let stepper = &mut self.built.stepper;
        stepper.outputs(&memory.system, &self.inputs, &mut self.outputs)?;
        check_finite(self.outputs.lists().into_iter().flatten())?;
        S::write_outputs(self, memory);
        Ok(())
    }

    /// Onset and divergence. A search that fails is no reason to end a run.
    fn calculate(&mut self, now: &mut Now) {
        if self.calculated.are_known() {
            return;
        }
        if self.calculated.card.is_none() {
            let card = S::found(self, &now.resources, &now.memory);
            self.calculated.enter(card, &mut now.memory);
        }
        self.calculated.tell(now);
    }

    /// `ẏ = C ż + D ẇ + (∂y/∂V) V̇`.
    fn output_rates(&mut self, now: &mut Now, outputs: &[Role]) -> CallResult<Vec<f64>> {
        let memory = &now.memory;
        S::load_inputs(self, memory);
        let (stepper, inputs) = (&mut self.built.stepper, &mut self.inputs);
        let velocity = stepper.state_derivative(&memory.system, inputs)?;
        let velocity = memory.system.with_all(&velocity);
        let by_wind = SectionValues::by_speed(stepper, &memory.system, inputs);
        let wind_rate = inputs.wind_speed_rate_m_s2;
        std::mem::swap(&mut inputs.force, &mut inputs.force_rate);
        std::mem::swap(&mut inputs.gust_m_s, &mut inputs.gust_rate_m_s2);
        let mut rates = SectionValues::default();
        stepper.outputs(&velocity, inputs, &mut rates.outputs)?;
        add(&mut rates.outputs, &by_wind.outputs, wind_rate);
        check_finite(rates.outputs.lists().into_iter().flatten())?;
        let by_outputs = Some(&rates.outputs);
        let rate = |role: &Role| match role {
            Role::Computed(number) => Ok(self.slope(now, number, wind_rate, by_outputs)?),
            response => Ok(self.pick(&rates, *response)),
        };
        outputs.iter().map(rate).collect()
    }

    fn derivatives(
        &mut self,
        now: &mut Now,
        known: usize,
        unknowns: &[Role],
    ) -> CallResult<Vec<f64>> {
        let (resources, memory) = (&now.resources, &now.memory);
        let role = resources.table.variables()[known].role;
        let instant = match (Source::from_role(role), role) {
            (Source::Section | Source::Turbulence, _) => {
                let step = parameter_step(memory.values[known]);
                return central_difference(resources, memory, known, step, |other| {
                    let found = |unit: &mut Self| unit.unknowns(resources, other, unknowns);
                    Ok(self.with_parameters(resources, other, found)?)
                });
            }
            (Source::Limit, _) => None,
            (_, Role::WindSpeed) => {
                S::load_inputs(self, memory);
                let (stepper, state) = (&self.built.stepper, &memory.system);
                Some(SectionValues::by_speed(stepper, state, &self.inputs))
            }
            _ => Some(by_unit(self, memory, known)?),
        };
        let by_wind = f64::from(u8::from(role == Role::WindSpeed));
        let outputs = instant.as_ref().map(|i| &i.outputs);
        let derivative = |unknown: &Role| match unknown {
            Role::Computed(number) => self.slope(now, number, by_wind, outputs),
            other => Ok(instant.as_ref().map_or(0.0, |i| self.pick(i, *other))),
        };
        Ok(unknowns.iter().map(derivative).collect::<Result<_>>()?)
    }

    fn present(&mut self, now: &mut Now, number: &ComputedNumber) -> f64 {
        number.evaluate(&self.read(now, number)).value
    }
}

/// What a force, a gust, a state or a number at release of one does.
fn by_unit<S: CoupledKind>(
    unit: &mut Coupled<S>,
    memory: &Memory,
    known: usize,
) -> Result<SectionValues> {
    let mut of_one = memory.clone();
    let indices = &unit.indices;
    for index in indices.inputs[1..].iter().chain(&indices.initial) {
        of_one.values[*index] = f64::from(u8::from(*index == known));
    }
    if let Some(index) = indices.turbulence_factor {
        of_one.values[index] = 0.0;
    }
    let entry = indices.state_entry[known];
    of_one.input_rates.fill(0.0);
    S::load_inputs(unit, &of_one);
    // while initialising the state follows from what is stated, and lags stand where the gusts are
    let mut state = if memory.state == State::Initialization {
        unit.release(&of_one.values)?
    } else {
        memory
            .system
            .with_all(&vec![0.0; memory.system.all().len()])
    };
    if let Some(entry) = entry {
        state.set_number(entry, 1.0);
    }
    unit.instant(&state)
}
