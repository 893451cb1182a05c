//! Forces alone: strips of deck whose structure is the importer's.
//!
//! The forces put out are those at the instant at which they will act, `prediction` communication steps after the
//! motion that was set for the last step. When the importer has set newer motion since, they follow from that as well.

use super::layout::{Source, place};
use super::memory::Memory;
use super::trust::{LINEAR_ROTATION_RAD, beyond_linear};
use super::unit::Unit;
use crate::aerodynamics::Realizable;
use crate::error::{Error, Result};
use crate::fmu::force_options::ForceOptions;
use crate::fmu::refusal::{Answer, Refusal};
use crate::fmu::resources::Resources;
use crate::fmu::variables::{ForceOutput, Role, SectionParameter};
use crate::response::{
    ForceAhead, Given, KnownMotion, PrescribedForces, SectionState, StripFlow, StripGusts,
    wind_at_rest,
};
use std::borrow::Cow;

/// How a number of the motion has been set since the last step.
const NOT_SET: f64 = 0.0;
pub(super) const SET: f64 = 1.0;
/// A rate by the derivative of the input below it.
const SET_AS_DERIVATIVE: f64 = 2.0;

/// See the module. The state is the time from the newest motion to the instant of the forces (s), how each number of
/// the motion has been set since, then the state of the forces.
#[derive(Debug)]
pub(super) struct ForceUnit {
    pub forces: PrescribedForces,
    /// Wind, then the motion: strip by strip, displacement, rate and acceleration of each degree of freedom.
    pub inputs: Vec<usize>,
    /// Index of the motion among the inputs, by place; zero for what is none.
    pub input_at: Vec<usize>,
    /// Force and total force, in the order of the motion.
    outputs: Vec<[usize; 2]>,
    /// Width, length, wind factor of each strip.
    strips: Vec<[usize; 3]>,
    /// Forces of gusts, and the gusts of each strip; none where the unit takes none.
    gusts: Option<(StripGusts, Vec<[usize; 2]>)>,
    density: usize,
    prediction: usize,
    derivatives: usize,
    /// Whether it has been said that a rotation is beyond linear theory.
    told: bool,
}

/// What acts on the strips.
struct Conditions {
    flows: Vec<StripFlow>,
    density: f64,
}

impl ForceUnit {
    /// The forces of a trained model.
    ///
    /// # Errors
    /// [`crate::Error::Numerical`] for a table that is not one of forces.
    pub fn new(resources: &Resources, options: &ForceOptions) -> Result<Self> {
        let table = &resources.table;
        let dofs = resources.model.section.dofs();
        let n = dofs.len();
        let coordinate = |s: usize, dof| s * n + dofs.iter().position(|d| *d == dof).unwrap_or(0);
        let count = options.strips.len();
        let mut inputs = vec![place(table, Role::WindSpeed)?; 1 + 3 * n * count];
        let (mut outputs, mut strips) = (vec![[0; 2]; n * count], vec![[0; 3]; count]);
        let mut gusts = vec![[0; 2]; count];
        // in one pass: there may be ten thousand strips
        for (place, variable) in table.variables().iter().enumerate() {
            match variable.role {
                Role::Motion(s, response, dof) => {
                    inputs[1 + 3 * coordinate(s, dof) + response as usize] = place;
                }
                Role::Force(s, kind, dof) => outputs[coordinate(s, dof)][kind as usize] = place,
                Role::Strip(s, which) => strips[s][which as usize] = place,
                Role::Gust(s, which) => gusts[s][which as usize] = place,
                _ => {}
            }
        }
        let mut input_at = vec![0; table.variables().len()];
        for (index, place) in inputs.iter().enumerate() {
            input_at[*place] = index;
        }
        let gust_force = resources.gusts.as_ref();
        if gust_force.is_some() {
            // behind the motion, which is what has an index
            inputs.extend(gusts.iter().flatten());
        }
        Ok(Self {
            input_at,
            gusts: gust_force.map(|force| (StripGusts::new(force), gusts)),
            forces: PrescribedForces::new(resources.model.model.realize(), dofs),
            inputs,
            outputs,
            strips,
            density: place(table, Role::Section(SectionParameter::AirDensity))?,
            prediction: place(table, Role::Prediction)?,
            derivatives: place(table, Role::MotionDerivatives)?,
            told: false,
        })
    }

    /// Numbers of the motion.
    fn motions(&self) -> usize {
        3 * self.outputs.len()
    }

    /// Where the state of the forces begins.
    pub fn first(&self) -> usize {
        1 + self.motions()
    }

    fn conditions(&self, values: &[f64]) -> Conditions {
        let flow = |[width, _, factor]: &[usize; 3]| StripFlow {
            width_m: values[*width],
            wind_factor: values[*factor],
        };
        Conditions {
            flows: self.strips.iter().map(flow).collect(),
            density: values[self.density],
        }
    }

    /// The motion as it has been set.
    fn motion(&self, memory: &Memory) -> Vec<KnownMotion> {
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
        (0..self.motions() / 3).map(coordinate).collect()
    }

    /// Forces of all strips in the order of the motion. `renewed` says that there is motion of the present time.
    pub fn ahead(&mut self, memory: &Memory, renewed: bool) -> Result<Vec<ForceAhead>> {
        let Conditions { flows, density } = self.conditions(&memory.values);
        let mut state = Cow::Borrowed(&memory.system.values[self.first()..]);
        let mut ahead_s = memory.system.values[0];
        if renewed {
            let motion = self.motion(memory);
            if let Some(newest) = PrescribedForces::newest_s(&state) {
                ahead_s = (newest + ahead_s - memory.time).max(0.0);
            }
            let given = Given {
                time_s: memory.time,
                wind_speed_m_s: memory.values[self.inputs[0]],
                motion: &motion,
            };
            self.forces.take(state.to_mut(), &given, &flows)?;
        }
        let n = self.forces.dofs().len();
        let mut gusts = Cow::Borrowed(memory.system.gusts.as_slice());
        if renewed {
            let before = &memory.system.values[self.first()..];
            self.take_gusts(gusts.to_mut(), before, memory, &flows);
        }
        let wind = PrescribedForces::newest_wind_m_s(&state);
        let mut found = vec![ForceAhead::default(); self.outputs.len()];
        for (s, (flow, forces)) in flows.iter().zip(found.chunks_mut(n)).enumerate() {
            self.forces
                .ahead(&state, (s, flow), ahead_s, density, forces)?;
            if let Some((strips, _)) = &self.gusts {
                let of = strips.per_strip();
                let strip = &gusts[s * of..(s + 1) * of];
                let rates = &memory.input_rates[1 + self.motions() + 2 * s..];
                let air = (wind * flow.wind_factor, flow.width_m, density);
                strips.add_ahead(strip, [rates[0], rates[1]], ahead_s, air, forces);
            }
        }
        if found.iter().all(|f| f.force.is_finite()) {
            return Ok(found);
        }
        Err(Error::Numerical(
            "the forces have grown beyond the range of numbers".into(),
        ))
    }

    /// The gusts go to the present time, from the state of the forces before.
    fn take_gusts(&self, gusts: &mut [f64], before: &[f64], memory: &Memory, flows: &[StripFlow]) {
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
    pub fn renewed(&self, memory: &Memory) -> bool {
        let [flags, state] = [
            &memory.system.values[1..self.first()],
            &memory.system.values[self.first()..],
        ];
        let newest = PrescribedForces::newest_s(state);
        newest.is_none_or(|t| t < memory.time && flags.iter().any(|f| *f != NOT_SET))
    }

    pub fn entry(&self, memory: &Memory, forces: &[ForceAhead], role: Role) -> ForceAhead {
        let Role::Force(s, kind, dof) = role else {
            return ForceAhead::default();
        };
        let dofs = self.forces.dofs();
        let index = dofs.iter().position(|d| *d == dof).unwrap_or(0);
        let ForceAhead { force, rate } = forces[s * dofs.len() + index];
        let factor = match kind {
            ForceOutput::PerLength => 1.0,
            ForceOutput::Total => memory.values[self.strips[s][1]],
        };
        ForceAhead {
            force: factor * force,
            rate: factor * rate,
        }
    }
}

impl Unit for ForceUnit {
    fn inputs(&self) -> &[usize] {
        &self.inputs
    }

    fn at_rest(&self) -> SectionState {
        let mut values = vec![NOT_SET; self.first()];
        values.extend(self.forces.rest(self.strips.len()));
        let of_strip = self.gusts.as_ref().map_or(0, |(g, _)| g.per_strip());
        SectionState {
            values,
            gusts: vec![0.0; self.strips.len() * of_strip],
            ..SectionState::default()
        }
    }

    fn changed(&mut self, _: Source) {}

    fn begin_initialization(&mut self) {
        self.told = false;
    }

    fn watch(&mut self, _: &Resources, memory: &Memory, notices: &mut Vec<String>) {
        let n = self.forces.dofs().len();
        let rotations = self.inputs[1..self.first()]
            .chunks(3)
            .skip(n - 1)
            .step_by(n);
        let largest = rotations.map(|places| memory.values[places[0]].abs());
        let largest = largest.fold(0.0, f64::max);
        if largest > LINEAR_ROTATION_RAD && !self.told {
            self.told = true;
            notices.push(beyond_linear(largest));
        }
    }

    fn input_set(&mut self, memory: &mut Memory, place: usize) -> bool {
        let index = self.input_at[place];
        if index > 0 {
            memory.system.values[index] = SET;
        }
        index > 0
    }

    fn input_rate_set(&mut self, memory: &mut Memory, index: usize) {
        // of a displacement
        let of_motion = (1..self.first()).contains(&index);
        if of_motion && (index - 1).is_multiple_of(3) && memory.system.values[index + 1] == NOT_SET
        {
            memory.system.values[index + 1] = SET_AS_DERIVATIVE;
        }
    }

    fn replace(&mut self, _: &mut Memory, _: &Memory, _: &dyn Fn(Source) -> bool) {}

    fn prepare(&mut self, _: &Resources, _: &mut Memory) -> Result<()> {
        Ok(())
    }

    fn advance(&mut self, _: &Resources, memory: &mut Memory, step: f64) -> Answer<bool> {
        let wind = memory.values[self.inputs[0]];
        let end = wind + memory.input_rates[0] * step;
        if wind_at_rest(end, wind) < 0.0 {
            return Err(Refusal::discard(format!(
                "wind_speed: expected a wind that does not blow backwards, found {end} m/s at the end of the step"
            )));
        }
        let motion = self.motion(memory);
        let flows = self.conditions(&memory.values).flows;
        let given = Given {
            time_s: memory.time,
            wind_speed_m_s: wind,
            motion: &motion,
        };
        let first = self.first();
        let before = memory.system.clone();
        self.forces
            .take(&mut memory.system.values[first..], &given, &flows)?;
        let mut gusts = std::mem::take(&mut memory.system.gusts);
        self.take_gusts(&mut gusts, &before.values[first..], memory, &flows);
        memory.system.gusts = gusts;
        memory.system.values[0] = memory.values[self.prediction] * step;
        memory.system.values[1..first].fill(NOT_SET);
        // a force that cannot be put out is refused with its step
        match self.ahead(memory, false) {
            Ok(forces) => {
                self.put_out(memory, &forces);
                Ok(true)
            }
            Err(why) => {
                memory.system = before;
                Err(why.into())
            }
        }
    }

    fn outputs(&mut self, _: &Resources, memory: &mut Memory) -> Answer<()> {
        let renewed = self.renewed(memory);
        let forces = self.ahead(memory, renewed);
        let forces = forces.map_err(|why| Refusal::discard(format!("outputs: {why}")))?;
        self.put_out(memory, &forces);
        Ok(())
    }

    fn output_rates(
        &mut self,
        _: &Resources,
        memory: &mut Memory,
        outputs: &[Role],
    ) -> Answer<Vec<f64>> {
        let forces = self.ahead(memory, self.renewed(memory))?;
        let rate = |role: &Role| self.entry(memory, &forces, *role).rate;
        Ok(outputs.iter().map(rate).collect())
    }

    fn derivatives(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        known: usize,
        unknowns: &[Role],
    ) -> Answer<Vec<f64>> {
        self.column(resources, memory, known, unknowns)
    }
}

impl ForceUnit {
    fn put_out(&self, memory: &mut Memory, forces: &[ForceAhead]) {
        let n = self.forces.dofs().len();
        for (i, ([per_length, total], force)) in self.outputs.iter().zip(forces).enumerate() {
            let length = memory.values[self.strips[i / n][1]];
            memory.values[*per_length] = force.force;
            memory.values[*total] = force.force * length;
        }
    }
}
