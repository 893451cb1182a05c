//! Forces alone in co-simulation: where the motion goes on until the instant at which they act.

use super::force_unit::{ForceUnit, ForceWork, NOT_SET, SET_AS_DERIVATIVE, check_forces};
use super::memory::Memory;
use crate::error::Result;
use crate::response::{ForceAhead, GivenMotion, KnownMotion, PrescribedForces, StripFlow};

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

    /// Finds the forces of all strips. `renewed` says that there is motion of the present time.
    pub(super) fn ahead_into(
        &mut self,
        memory: &Memory,
        renewed: bool,
        work: &mut ForceWork,
    ) -> Result<()> {
        work.flows.clear();
        work.flows.extend(self.flows(&memory.values));
        let density = self.air_density(&memory.values);
        let first = self.first();
        let mut system = &memory.system;
        let mut ahead_s = system.values[0];
        if renewed {
            self.motion(memory, &mut work.motion);
            if let Some(newest) = PrescribedForces::newest_s(&system.values[first..]) {
                ahead_s = (newest + ahead_s - memory.time).max(0.0);
            }
            let given = GivenMotion {
                time_s: memory.time,
                wind_speed_m_s: memory.values[self.inputs[0]],
                motion: &work.motion,
            };
            work.renewed.set_to(system);
            let state = &mut work.renewed.values[first..];
            self.forces.take(state, &given, &work.flows)?;
            let before = &memory.system.values[first..];
            self.take_gusts(&mut work.renewed.gusts, before, memory, &work.flows);
            system = &work.renewed;
        }
        let (state, gusts) = (&system.values[first..], &system.gusts);
        let n = self.forces.dofs().len();
        let wind = PrescribedForces::newest_wind_m_s(state);
        work.forces.clear();
        work.forces
            .resize(self.coordinates(), ForceAhead::default());
        let found = &mut work.forces;
        self.forces
            .ahead(state, &work.flows, ahead_s, density, found)?;
        if let Some((strips, _)) = &self.gusts {
            let each = work.flows.iter().zip(found.chunks_mut(n));
            let each = each.zip(gusts.chunks(strips.per_strip()));
            for (s, ((flow, forces), strip)) in each.enumerate() {
                let rates = &memory.input_rates[1 + self.motions() + 2 * s..];
                let air = flow.in_air(wind, density);
                strips.add_ahead(strip, [rates[0], rates[1]], ahead_s, air, forces);
            }
        }
        check_forces(&work.forces)
    }

    /// The gusts go to the present time, from the state of the forces before.
    pub(super) fn take_gusts(
        &self,
        gusts: &mut [f64],
        before: &[f64],
        memory: &Memory,
        flows: &[StripFlow],
    ) {
        let Some((strips, places)) = &self.gusts else {
            return;
        };
        let seconds = PrescribedForces::newest_s(before).map(|t| memory.time - t);
        let now = memory.values[self.inputs[0]];
        // to second order in the change of the wind, as the filters of the motion
        let wind = 0.5 * (PrescribedForces::newest_wind_m_s(before) + now);
        let each = gusts.chunks_mut(strips.per_strip()).zip(flows).zip(places);
        for ((strip, flow), places) in each {
            let widths = seconds.map(|s| s * wind * flow.wind_factor / flow.width_m);
            strips.take(strip, places.map(|place| memory.values[place]), widths);
        }
    }

    /// Whether there is motion of the present time that no step has taken yet.
    pub(super) fn renewed(&self, memory: &Memory) -> bool {
        let [flags, state] = [
            &memory.system.values[1..self.first()],
            &memory.system.values[self.first()..],
        ];
        let newest = PrescribedForces::newest_s(state);
        newest.is_none_or(|t| t < memory.time && flags.iter().any(|f| *f != NOT_SET))
    }
}
