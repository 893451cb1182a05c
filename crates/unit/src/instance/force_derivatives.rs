//! What forces alone are computed to be, and their derivatives: they are linear in motion, states and gusts; wind and parameters are differenced.

use super::force_unit::{ForceUnit, NOT_SET, SET};
use super::memory::{Memory, Now};
use super::sensitivity::central_difference;
use super::trust::shown;
use super::unit::Prepared;
use crate::error::Result;
use crate::lifecycle::State;
use crate::refusal::{CallResult, Refusal};
use crate::resources::Resources;
use crate::response::wind_at_rest;
use crate::section::Dof;
use crate::variables::Role;

/// Relative step of the differences with respect to wind and parameters.
const RELATIVE_STEP: f64 = 1e-5;

impl Prepared for ForceUnit {
    fn state_rates(&mut self, memory: &Memory, rates: &mut [f64]) -> CallResult<()> {
        self.rates_now(memory, rates);
        if rates.iter().all(|x| x.is_finite()) {
            return Ok(());
        }
        Err(Refusal::discard("derivatives: the filters have overflowed"))
    }

    fn filter_rate(&mut self, memory: &Memory, i: usize) -> Option<f64> {
        let index = *self.inner.get(i)?;
        let part = self.parts.iter().find(|part| index < part.inner.end)?;
        let [strip, number] = part.at_inner(index);
        let mut work = std::mem::take(&mut self.work);
        work.rates.clear();
        self.add_rates(memory, part, strip, &mut work);
        self.work = work;
        self.work.rates.get(number).copied()
    }

    fn advance(&mut self, memory: &mut Memory, step: f64) -> CallResult<bool> {
        let wind = memory.values[self.inputs[0]];
        let end = wind + memory.input_rates[0] * step;
        if wind_at_rest(end, wind) < 0.0 {
            return Err(Refusal::discard(format!(
                "wind_speed: expected zero or a positive wind speed, found {} m/s at the end of the step",
                shown(end)
            )));
        }
        let mut before = std::mem::take(&mut self.work.before);
        before.set_to(&memory.system);
        let taken = self.take_motion(memory, &before);
        memory.system.values[0] = memory.values[self.prediction] * step;
        let first = self.first();
        memory.system.values[1..first].fill(NOT_SET);
        // a force that cannot be put out is refused with its step
        let found = taken.and_then(|()| self.ahead(memory, false));
        match &found {
            Ok(()) => self.put_out(memory),
            Err(_) => memory.system.set_to(&before),
        }
        self.work.before = before;
        found?;
        Ok(true)
    }

    fn outputs(&mut self, memory: &mut Memory) -> CallResult<()> {
        let renewed = self.renewed(memory);
        let found = self.present(memory, renewed);
        found.map_err(|why| Refusal::discard(format!("outputs: {why}")))?;
        self.put_out(memory);
        Ok(())
    }

    fn output_rates(&mut self, now: &mut Now, outputs: &[Role]) -> CallResult<Vec<f64>> {
        let memory = &now.memory;
        self.ahead(memory, self.renewed(memory))?;
        let rate = |role: &Role| self.rate(memory, *role);
        Ok(outputs.iter().map(rate).collect())
    }

    fn derivatives(
        &mut self,
        now: &mut Now,
        known: usize,
        unknowns: &[Role],
    ) -> CallResult<Vec<f64>> {
        let (resources, memory) = (&now.resources, &now.memory);
        let mut found = self.base_derivatives(resources, memory, known, unknowns)?;
        let role = resources.table.variables()[known].role;
        for (found, unknown) in found.iter_mut().zip(unknowns) {
            let Role::OfStrip(s, number) = *unknown else {
                continue;
            };
            let forces = Dof::THREE.map(|dof| Role::Force(s, dof));
            let slopes = self.base_derivatives(resources, memory, known, &forces)?;
            self.present(memory, self.renewed(memory))?;
            let slope = |of: Role| match forces.iter().position(|force| *force == of) {
                Some(force) => slopes[force],
                None => f64::from(u8::from(of == role)),
            };
            *found = number.evaluate(&self.read(memory, s, number, &slope)).slope;
        }
        Ok(found)
    }
}

impl ForceUnit {
    /// Derivatives of forces, states and their rates.
    fn base_derivatives(
        &mut self,
        resources: &Resources,
        memory: &Memory,
        known: usize,
        unknowns: &[Role],
    ) -> CallResult<Vec<f64>> {
        let role = resources.table.variables()[known].role;
        let (index, state) = (self.input_at[known], self.entry_of(role));
        if index > 0 || state.is_some() {
            let mut unit = self.in_still_flow(memory);
            match state {
                Some(entry) => unit.system.set_number(entry, 1.0),
                None => self.set_unit(&mut unit, index),
            }
            // a state stands apart from the motion, which otherwise counts as that of the present
            let renewed = state.is_none() || self.renewed(memory);
            return Ok(self.unknowns(&mut unit, renewed, unknowns)?);
        }
        let value = memory.values[known].abs();
        let step = match role {
            // forces are linear in gusts
            Role::Gust(..) => 1.0,
            // of an instant they are of second degree in the wind: a difference of any step is exact
            Role::WindSpeed if self.integrated && value > 0.0 => 0.5 * value,
            _ => RELATIVE_STEP * value.max(RELATIVE_STEP),
        };
        let renewed = self.renewed(memory);
        central_difference(resources, memory, known, step, |other| {
            Ok(self.unknowns(&mut other.clone(), renewed, unknowns)?)
        })
    }

    /// The unknowns for a memory.
    fn unknowns(
        &mut self,
        memory: &mut Memory,
        renewed: bool,
        unknowns: &[Role],
    ) -> Result<Vec<f64>> {
        if memory.state == State::Initialization {
            self.enter_steady_flow(memory)?;
        }
        let wants = |wanted: fn(&Role) -> bool| unknowns.iter().any(wanted);
        if wants(|role| matches!(role, Role::Force(..) | Role::TotalForce(..))) {
            self.present(memory, renewed)?;
        }
        let mut rates = vec![0.0; self.entries.len()];
        if wants(|role| matches!(role, Role::FilterRate(_))) {
            self.rates_now(memory, &mut rates);
        }
        let value = |role: &Role| match role {
            Role::Force(..) | Role::TotalForce(..) => self.entry(memory, *role).value,
            Role::FilterRate(i) => rates.get(*i).copied().unwrap_or(0.0),
            other => {
                let entry = self.entry_of(*other);
                entry.map_or(0.0, |entry| memory.system.number(entry))
            }
        };
        Ok(unknowns.iter().map(value).collect())
    }

    /// Nothing moves, no gust blows, no force acts, and none has.
    fn in_still_flow(&self, memory: &Memory) -> Memory {
        let mut still = memory.clone();
        for index in &self.inputs[1..] {
            still.values[*index] = 0.0;
        }
        still.system.gusts.fill(0.0);
        still.input_rates.fill(0.0);
        for part in &self.parts {
            let state = &mut still.system.values[part.state.clone()];
            part.forces.forget(state);
        }
        still
    }

    /// One number of the motion is one.
    fn set_unit(&self, still: &mut Memory, index: usize) {
        still.values[self.inputs[index]] = 1.0;
        let order = (index - 1) % 3;
        // what has been set has its strip go on no longer
        for set in [index - order]
            .into_iter()
            .chain((order == 1).then_some(index))
        {
            still.system.values[set] = SET;
        }
    }
}
