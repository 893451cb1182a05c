//! Forces alone in co-simulation: where the motion goes on until the instant at which they act.

use super::force_parts::StripsUnderModel;
use super::force_unit::{ForceUnit, ForceWork, NOT_SET, SET_AS_DERIVATIVE};
use super::memory::Memory;
use crate::error::{Error, Result};
use crate::prescribed::{KnownMotion, PrescribedForces, StripFlow};
use crate::response::SectionState;
use crate::variables::Dual;
use std::ops::Range;

impl ForceUnit {
    /// The motion as it has been set.
    pub(super) fn motion(&self, memory: &Memory, motion: &mut Vec<KnownMotion>) {
        let set = &memory.system.values[1..self.first()];
        let stated = memory.values[self.derivatives];
        let coordinate = |i: usize| {
            let at = |order: usize| memory.values[self.inputs[1 + 3 * i + order]];
            let mut values = [at(0), at(1), at(2)];
            let by_derivative = set[3 * i + 1] == SET_AS_DERIVATIVE;
            if by_derivative {
                values[1] = memory.input_rates[1 + 3 * i];
            }
            let known = if stated >= 0.0 {
                1 + stated as usize
            } else {
                let order = |o: usize| set[3 * i + o] != NOT_SET;
                1 + usize::from(order(1)) + usize::from(order(1) && order(2) && !by_derivative)
            };
            KnownMotion { values, known }
        };
        motion.clear();
        motion.extend((0..self.motions() / 3).map(coordinate));
    }

    /// Takes the motion of a new point of time into the numbers of a state. After an error they have to be made anew.
    pub(super) fn take(
        &mut self,
        state: &mut [f64],
        time_s: f64,
        wind_m_s: f64,
        motion: &[KnownMotion],
        flows: &[StripFlow],
    ) -> Result<()> {
        for part in &mut self.parts {
            let state = &mut state[part.state.clone()];
            let motion = &motion[part.coordinates.clone()];
            let flows = &flows[part.strips.clone()];
            part.forces.take(state, time_s, wind_m_s, motion, flows)?;
        }
        Ok(())
    }

    /// Takes the motion of the present into the state, from that before.
    pub(super) fn take_motion(&mut self, memory: &mut Memory, before: &SectionState) -> Result<()> {
        let mut work = std::mem::take(&mut self.work);
        self.motion(memory, &mut work.motion);
        work.flows.clear();
        work.flows.extend(self.flows(&memory.values));
        let (wind, system) = (memory.values[self.inputs[0]], &mut memory.system.values);
        let taken = self.take(system, memory.time, wind, &work.motion, &work.flows);
        if taken.is_ok() {
            let mut gusts = std::mem::take(&mut memory.system.gusts);
            self.take_gusts(&mut gusts, before, memory, &work.flows);
            memory.system.gusts = gusts;
        }
        self.work = work;
        taken
    }

    /// The forces of the first strips of a state, whose points of time are those of all.
    fn first_of<'a>(&self, system: &'a SectionState) -> &'a [f64] {
        &system.values[self.first()..]
    }

    /// Finds the forces of all strips. `renewed` says that there is motion of the present time; a strip of which none has been set
    /// goes on as before.
    pub(super) fn ahead_into(
        &mut self,
        memory: &Memory,
        renewed: bool,
        work: &mut ForceWork,
    ) -> Result<()> {
        work.flows.clear();
        work.flows.extend(self.flows(&memory.values));
        let system = &memory.system;
        let ahead_s = system.values[0];
        if !renewed {
            return self.forces_of(system, ahead_s, memory, &work.flows, &mut work.forces);
        }
        self.motion(memory, &mut work.motion);
        let newest = PrescribedForces::newest_s(self.first_of(system));
        let left_s = newest.map_or(ahead_s, |t| (t + ahead_s - memory.time).max(0.0));
        work.renewed.set_to(system);
        let (wind, renewed) = (memory.values[self.inputs[0]], &mut work.renewed.values);
        self.take(renewed, memory.time, wind, &work.motion, &work.flows)?;
        self.take_gusts(&mut work.renewed.gusts, system, memory, &work.flows);
        let (flows, forces) = (&work.flows, &mut work.forces);
        self.forces_of(&work.renewed, left_s, memory, flows, forces)?;
        let flags = &system.values[1..self.first()];
        let goes_on = |own: &Range<usize>| {
            let flags = &flags[3 * own.start..3 * own.end];
            flags.iter().all(|flag| *flag == NOT_SET)
        };
        let mut strips = self.parts_and_strips().map(|(p, s)| p.coordinates_of(s));
        if newest.is_none() || !strips.any(|own| goes_on(&own)) {
            return Ok(());
        }
        drop(strips);
        self.forces_of(system, ahead_s, memory, flows, &mut work.predicted)?;
        let strips = self.parts_and_strips().map(|(p, s)| p.coordinates_of(s));
        for own in strips.filter(goes_on) {
            forces[own.clone()].copy_from_slice(&work.predicted[own]);
        }
        Ok(())
    }

    /// Finds the forces of all strips, `ahead_s` after the newest motion that a state has taken.
    fn forces_of(
        &mut self,
        system: &SectionState,
        ahead_s: f64,
        memory: &Memory,
        flows: &[StripFlow],
        forces: &mut Vec<Dual>,
    ) -> Result<()> {
        let density = self.air_density(&memory.values);
        forces.clear();
        forces.resize(self.coordinates(), Dual::default());
        for part in &mut self.parts {
            let flows = &flows[part.strips.clone()];
            let found = &mut forces[part.coordinates.clone()];
            let state = &system.values[part.state.clone()];
            part.forces.ahead(state, flows, ahead_s, density, found)?;
        }
        let wind = PrescribedForces::newest_wind_m_s(self.first_of(system));
        for s in 0..self.gusts.len() {
            let part = StripsUnderModel::new(&self.parts, s);
            if let Some(gusts) = &part.gusts {
                let rates = &memory.input_rates[1 + self.motions() + 2 * s..];
                let air = flows[s].in_air(wind, density);
                let strip = &system.gusts[part.gusts_of(s)];
                let forces = &mut forces[part.coordinates_of(s)];
                gusts.add_ahead(strip, [rates[0], rates[1]], ahead_s, air, forces);
            }
        }
        self.check_forces(memory, forces)
    }

    /// Refuses forces, of a strip per length or in all, that no number holds any more.
    pub(super) fn check_forces(&self, memory: &Memory, found: &[Dual]) -> Result<()> {
        let holds = |(part, s): (&StripsUnderModel, usize)| {
            // of zero length an infinite force is no number, and refused as well
            let length = memory.values[self.strips[s][1]];
            let own = found[part.coordinates_of(s)].iter();
            own.into_iter().all(|f| (f.value * length).is_finite())
        };
        match self.parts_and_strips().all(holds) {
            true => Ok(()),
            false => Err(Error::Numerical("the forces have overflowed".into())),
        }
    }

    /// The gusts go to the present time, from the state before.
    pub(super) fn take_gusts(
        &self,
        gusts: &mut [f64],
        before: &SectionState,
        memory: &Memory,
        flows: &[StripFlow],
    ) {
        let before = self.first_of(before);
        let seconds = PrescribedForces::newest_s(before).map(|t| memory.time - t);
        let now = memory.values[self.inputs[0]];
        // to second order in the change of the wind, as the filters of the motion
        let wind = 0.5 * (PrescribedForces::newest_wind_m_s(before) + now);
        for (s, (indices, flow)) in self.gusts.iter().zip(flows).enumerate() {
            let part = StripsUnderModel::new(&self.parts, s);
            let widths = seconds.map(|s| s * wind * flow.wind_factor / flow.width_m);
            if let Some(strips) = &part.gusts {
                let strip = &mut gusts[part.gusts_of(s)];
                strips.take(strip, indices.map(|index| memory.values[index]), widths);
            }
        }
    }

    /// Whether there is motion of the present time that no step has taken yet.
    pub(super) fn renewed(&self, memory: &Memory) -> bool {
        let [flags, state] = [
            &memory.system.values[1..self.first()],
            self.first_of(&memory.system),
        ];
        let newest = PrescribedForces::newest_s(state);
        newest.is_none_or(|t| t < memory.time && flags.iter().any(|f| *f != NOT_SET))
    }
}
