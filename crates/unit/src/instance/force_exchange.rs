//! Forces alone beside an importer that integrates the filters: the forces of the instant, from the motion that is set.
//!
//! Nothing is predicted and nothing derived from earlier motion, so that the rates of the motion have to be set. A displacement
//! that moves while its rate has never been set is a motion that was not connected: it ends the run.

use super::force_parts::StripsUnderModel;
use super::force_unit::{ForceUnit, ForceWork, NOT_SET, SET};
use super::memory::{Memory, Now};
use crate::error::{Result, ensure};
use crate::lifecycle::State;
use crate::refusal::{CallResult, Refusal};
use crate::section::Dof;
use crate::variables::{Dual, Role};
use std::ops::Range;

/// A displacement that has changed between events.
const MOVES: f64 = 3.0;

impl ForceUnit {
    /// Takes note of motion that has been set while the importer integrates.
    pub(super) fn note_motion(&self, memory: &mut Memory, index: usize, changed: bool) {
        let moves = memory.state == State::ContinuousTimeMode && changed;
        let flag = &mut memory.system.values[index];
        let displacement = (index - 1).is_multiple_of(3);
        if displacement && (moves || *flag == MOVES) {
            *flag = MOVES;
        } else {
            *flag = SET;
        }
    }

    /// Displacement, rate and acceleration of these coordinates, those of a strip, as they count now.
    fn motion_now(
        &self,
        memory: &Memory,
        coordinates: Range<usize>,
    ) -> [[f64; 3]; Dof::THREE.len()] {
        let stated = memory.values[self.derivatives];
        let counts = |order: usize| stated < 0.0 || order as f64 <= stated;
        let number = |i: usize, order: usize| {
            let value = memory.values[self.inputs[1 + 3 * i + order]];
            if counts(order) { value } else { 0.0 }
        };
        let mut motion = [[0.0; 3]; Dof::THREE.len()];
        for (i, motion) in coordinates.zip(&mut motion) {
            *motion = [0, 1, 2].map(|order| number(i, order));
        }
        motion
    }

    /// Numbers of the gusts at strip `s`, of which the first two are those that blow now.
    fn gusts_now<'a>(
        &self,
        memory: &Memory,
        part: &StripsUnderModel,
        s: usize,
        strip: &'a mut Vec<f64>,
    ) -> Option<&'a [f64]> {
        let indices = self.gusts.get(s)?;
        strip.clear();
        strip.extend_from_slice(&memory.system.gusts[part.gusts_of(s)]);
        for (gust, index) in strip.iter_mut().zip(indices) {
            *gust = memory.values[*index];
        }
        Some(strip)
    }

    /// Finds the forces of the instant, of all strips.
    pub(super) fn at_instant(&mut self, memory: &Memory, work: &mut ForceWork) -> Result<()> {
        let density = self.air_density(&memory.values);
        let wind = memory.values[self.inputs[0]];
        work.forces.clear();
        work.forces.resize(self.coordinates(), Dual::default());
        for (part, s) in self.parts_and_strips() {
            let air = self.flow(&memory.values, s).in_air(wind, density);
            let filters = &memory.system.values[part.filters_of(s)];
            let own = part.coordinates_of(s);
            let motion = self.motion_now(memory, own.clone());
            let forces = &mut work.forces[own.clone()];
            part.forces
                .at_instant(filters, &motion[..own.len()], air, forces);
            let strip = self.gusts_now(memory, part, s, &mut work.strip);
            if let (Some(gusts), Some(strip)) = (&part.gusts, strip) {
                gusts.add_ahead(strip, [0.0; 2], 0.0, air, forces);
            }
        }
        self.check_forces(memory, &work.forces)
    }

    /// Writes the rates of filters and lagging gusts, per second, in the order of [`Role::Filter`].
    pub(super) fn rates_now(&mut self, memory: &Memory, rates: &mut [f64]) {
        let mut work = std::mem::take(&mut self.work);
        work.rates.clear();
        for (part, s) in self.parts_and_strips() {
            self.add_rates(memory, part, s, &mut work);
        }
        for (slot, index) in rates.iter_mut().zip(&self.inner) {
            *slot = work.rates[*index];
        }
        self.work = work;
    }

    /// Adds those of strip `s`.
    pub(super) fn add_rates(
        &self,
        memory: &Memory,
        part: &StripsUnderModel,
        s: usize,
        work: &mut ForceWork,
    ) {
        let flow = self.flow(&memory.values, s);
        let wind = memory.values[self.inputs[0]] * flow.wind_factor;
        let displacement = self
            .motion_now(memory, part.coordinates_of(s))
            .map(|m| m[0]);
        let filters = &memory.system.values[part.filters_of(s)];
        let before = work.rates.len();
        work.rates.resize(before + filters.len(), 0.0);
        let (width, rates) = (flow.width_m, &mut work.rates[before..]);
        part.forces
            .filter_rates(filters, &displacement, wind, width, rates);
        let strip = self.gusts_now(memory, part, s, &mut work.strip);
        if let (Some(gusts), Some(strip)) = (&part.gusts, strip) {
            work.rates.extend(gusts.rates(strip, wind / flow.width_m));
        }
    }

    /// Every strip with the part to which it belongs.
    pub(super) fn parts_and_strips(&self) -> impl Iterator<Item = (&StripsUnderModel, usize)> {
        let each = self.parts.iter();
        each.flat_map(|part| part.strips.clone().map(move |s| (part, s)))
    }

    /// The flow settles around the deck where it is held, in the gusts that blow.
    pub(super) fn enter_steady_flow(&self, memory: &mut Memory) -> Result<()> {
        for part in &self.parts {
            let steady_flow = part.forces.steady_flow()?;
            for s in part.strips.clone() {
                let flow = self.flow(&memory.values, s);
                let at = |i: usize| memory.values[self.inputs[1 + 3 * i]];
                let displacement: Vec<f64> = part.coordinates_of(s).map(at).collect();
                let filters = &mut memory.system.values[part.filters_of(s)];
                part.forces
                    .enter_steady_flow(&steady_flow, &displacement, flow.width_m, filters);
                if let Some(gusts) = &part.gusts {
                    let strip = &mut memory.system.gusts[part.gusts_of(s)];
                    gusts.take(strip, self.gusts[s].map(|index| memory.values[index]), None);
                }
            }
        }
        Ok(())
    }

    /// Whether the motion that is said to be set is enough.
    pub(super) fn check_stated(&self, memory: &Memory) -> Result<()> {
        let feels = |part: &StripsUnderModel| {
            let mut dofs = 0..part.forces.dofs().len();
            dofs.any(|dof| part.forces.feels(dof)[0])
        };
        let rates = self.parts.iter().any(feels);
        ensure(
            memory.values[self.derivatives] != 0.0 || !rates,
            "motion_derivatives",
            "-1, 1 or 2 in model exchange, where the forces of an instant need the rates of the motion",
            "0",
        )
    }

    /// Looks whether what moves has its rate, once the importer has taken a step.
    pub(super) fn check_moving(&mut self, now: &mut Now) -> CallResult<()> {
        let (table, memory, notices) = (&now.resources.table, &now.memory, &mut now.notices);
        if memory.values[self.derivatives] >= 0.0 {
            return Ok(());
        }
        let flags = &memory.system.values[1..self.first()];
        let name = |index: usize| &table.variables()[self.inputs[1 + index]].name;
        let each = self.parts.iter().flat_map(|part| {
            let own = part.coordinates.clone();
            own.map(move |i| (i, part, i - part.coordinates.start))
        });
        for ((i, part, of_part), flags) in each.zip(flags.chunks(3)) {
            if flags[0] != MOVES {
                continue;
            }
            let dof = of_part % part.forces.dofs().len();
            let [rate, acceleration] = part.forces.feels(dof);
            if rate && flags[1] == NOT_SET {
                return Err(Refusal::error(format!(
                    "`{}` moves, but `{}` has never been set: in model exchange the forces of an instant need the rates of \
                     the motion (set motion_derivatives to 1 where they really are zero)",
                    name(3 * i),
                    name(3 * i + 1)
                )));
            }
            if acceleration && flags[2] == NOT_SET && !self.warned_of_mass {
                self.warned_of_mass = true;
                notices.push(format!(
                    "`{}` has not been set: the forces hold no added mass of the air (set motion_derivatives to 1 where that \
                     is meant)",
                    name(3 * i + 2)
                ));
            }
        }
        Ok(())
    }

    /// Entry of the system's state that a filter or lagging gust is.
    pub(super) fn entry_of(&self, role: Role) -> Option<usize> {
        match role {
            Role::Filter(i) => self.entries.get(i).copied(),
            _ => None,
        }
    }
}
