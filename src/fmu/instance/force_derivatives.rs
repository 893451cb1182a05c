//! Derivatives of forces alone: they are linear in motion and gusts; wind and parameters are differenced.

use super::force_unit::{ForceUnit, SET};
use super::memory::Memory;
use super::sensitivity::central_difference;
use crate::error::Result;
use crate::fmu::refusal::Answer;
use crate::fmu::resources::Resources;
use crate::fmu::variables::Role;
use crate::response::ForceAhead;

/// Relative step of the differences with respect to wind and parameters.
const RELATIVE_STEP: f64 = 1e-5;

impl ForceUnit {
    /// Derivatives of all unknowns with respect to one known.
    pub fn column(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        known: usize,
        unknowns: &[Role],
    ) -> Answer<Vec<f64>> {
        let index = self.input_at[known];
        if index > 0 {
            let forces = self.by_motion(memory, index)?;
            let entry = |role: &Role| self.entry(memory, &forces, *role).force;
            return Ok(unknowns.iter().map(entry).collect());
        }
        let step = match resources.table.variables()[known].role {
            // forces are linear in gusts
            Role::Gust(..) => 1.0,
            _ => RELATIVE_STEP * memory.values[known].abs().max(RELATIVE_STEP),
        };
        let renewed = self.renewed(memory);
        central_difference(resources, memory, (known, step), |other| {
            let forces = self.ahead(other, renewed)?;
            let entry = |role: &Role| self.entry(other, &forces, *role).force;
            Ok(unknowns.iter().map(entry).collect())
        })
    }

    /// Forces follow the motion linearly: those of a unit of one number of it, in a flow at rest.
    fn by_motion(&mut self, memory: &Memory, index: usize) -> Result<Vec<ForceAhead>> {
        let mut unit = memory.clone();
        for place in &self.inputs[1..] {
            unit.values[*place] = 0.0;
        }
        unit.system.gusts.fill(0.0);
        unit.input_rates.fill(0.0);
        unit.values[self.inputs[index]] = 1.0;
        if (index - 1) % 3 == 1 {
            unit.system.values[index] = SET;
        }
        let first = self.first();
        self.forces.forget(&mut unit.system.values[first..]);
        self.ahead(&unit, true)
    }
}
