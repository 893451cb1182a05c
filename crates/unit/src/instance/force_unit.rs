//! Forces alone: strips of deck whose structure is the importer's.
//!
//! The forces put out are those at the instant at which they will act, `prediction` communication steps after the
//! motion that was set for the last step. When the importer has set newer motion since, they follow from that as well. Where
//! the importer integrates, they are those of its instant.

use super::layout::{Source, place};
use super::memory::Memory;
use super::trust::beyond_linear;
use super::unit::{Differentiable, Prepared, Unit};
use crate::aerodynamics::Realizable;
use crate::error::{Error, Result};
use crate::force_options::ForceOptions;
use crate::lifecycle::State;
use crate::refusal::{CallResult, Refusal};
use crate::resources::Resources;
use crate::response::{
    ForceAhead, GivenMotion, KnownMotion, PrescribedForces, SectionState, StripFlow, StripGusts,
    wind_at_rest,
};
use crate::variables::{ForceOutput, LINEAR_ROTATION_RAD, Role, SectionParameter, VariableTable};

/// How a number of the motion has been set since the last step.
pub(super) const NOT_SET: f64 = 0.0;
pub(super) const SET: f64 = 1.0;
/// A rate by the derivative of the input below it.
pub(super) const SET_AS_DERIVATIVE: f64 = 2.0;

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
    pub gusts: Option<(StripGusts, Vec<[usize; 2]>)>,
    density: usize,
    prediction: usize,
    pub derivatives: usize,
    /// Entry of the system's state that each filter is, then each lagging gust; all of one kind strip by strip.
    pub entries: Vec<usize>,
    /// The same by place in the table.
    held: Vec<Option<usize>>,
    /// Whether the importer integrates.
    pub integrated: bool,
    /// While initialising: the flow has to settle around other motion.
    settle_pending: bool,
    /// Whether it has been said that a rotation is beyond linear theory.
    warned: bool,
    /// Whether it has been said that the added mass is missing.
    pub warned_of_mass: bool,
    pub work: ForceWork,
}

/// Memory of a step.
#[derive(Debug, Default)]
pub(super) struct ForceWork {
    pub motion: Vec<KnownMotion>,
    pub flows: Vec<StripFlow>,
    /// Forces of all strips in the order of the motion.
    pub forces: Vec<ForceAhead>,
    /// State of the forces with the motion of the present, and the gusts.
    pub renewed: SectionState,
    /// Gusts of a strip.
    pub strip: Vec<f64>,
    /// Rates of a strip.
    pub rates: Vec<f64>,
    before: SectionState,
}

impl ForceUnit {
    /// The forces of a trained model.
    ///
    /// # Errors
    /// [`crate::Error::Numerical`] for a table that is not one of forces.
    pub(super) fn new(resources: &Resources, options: &ForceOptions) -> Result<Self> {
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
        let mut unit = Self {
            input_at,
            gusts: gust_force.map(|force| (StripGusts::new(force), gusts)),
            forces: PrescribedForces::new(resources.model.model.realize(), dofs),
            inputs,
            outputs,
            strips,
            density: place(table, Role::Section(SectionParameter::AirDensity))?,
            prediction: place(table, Role::Prediction)?,
            derivatives: place(table, Role::MotionDerivatives)?,
            entries: Vec::new(),
            held: Vec::new(),
            integrated: false,
            settle_pending: true,
            warned: false,
            warned_of_mass: false,
            work: ForceWork::default(),
        };
        unit.find_states(table);
        Ok(unit)
    }

    /// Where the states stand.
    fn find_states(&mut self, table: &VariableTable) {
        let (strips, first) = (self.strips.len(), self.first());
        let behind = self.at_rest().values.len();
        for k in 0..self.forces.filters(0).len() {
            let of = |s: usize| first + self.forces.filters(s).start + k;
            self.entries.extend((0..strips).map(of));
        }
        let of_strip = self.gusts.as_ref().map_or(0, |(g, _)| g.per_strip());
        for lag in 2..of_strip {
            let of = |s: usize| behind + s * of_strip + lag;
            self.entries.extend((0..strips).map(of));
        }
        let states = table.variables().iter().map(|v| self.entry_of(v.role));
        self.held = states.collect();
    }

    /// Coordinates of all strips.
    pub(super) fn coordinates(&self) -> usize {
        self.outputs.len()
    }

    /// Numbers of the motion.
    pub(super) fn motions(&self) -> usize {
        3 * self.outputs.len()
    }

    /// Where the state of the forces begins.
    pub(super) fn first(&self) -> usize {
        1 + self.motions()
    }

    /// How many strips there are.
    pub(super) fn strips(&self) -> usize {
        self.strips.len()
    }

    /// The air around strip `s`.
    pub(super) fn flow(&self, values: &[f64], s: usize) -> StripFlow {
        let [width, _, factor] = self.strips[s];
        StripFlow {
            width_m: values[width],
            wind_factor: values[factor],
        }
    }

    /// The air around all of them.
    pub(super) fn flows<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = StripFlow> + 'a {
        (0..self.strips.len()).map(|s| self.flow(values, s))
    }

    pub(super) fn air_density(&self, values: &[f64]) -> f64 {
        values[self.density]
    }

    pub(super) fn entry(&self, memory: &Memory, forces: &[ForceAhead], role: Role) -> ForceAhead {
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

    fn changed(&mut self, _: Source) {
        self.settle_pending = true;
    }

    fn begin_initialization(&mut self) {
        (self.warned, self.warned_of_mass) = (false, false);
        self.settle_pending = true;
    }

    fn will_be_integrated(&mut self) {
        self.integrated = true;
    }

    fn step_taken(
        &mut self,
        table: &VariableTable,
        memory: &Memory,
        notices: &mut Vec<String>,
    ) -> CallResult<()> {
        self.check_moving(table, memory, notices)
    }

    fn watch(&mut self, _: &Resources, memory: &Memory, notices: &mut Vec<String>) {
        let n = self.forces.dofs().len();
        let rotations = self.inputs[1..self.first()]
            .chunks(3)
            .skip(n - 1)
            .step_by(n);
        let largest = rotations.map(|places| memory.values[places[0]].abs());
        let largest = largest.fold(0.0, f64::max);
        if largest > LINEAR_ROTATION_RAD && !self.warned {
            self.warned = true;
            notices.push(beyond_linear(largest));
        }
    }

    fn input_set(&mut self, memory: &mut Memory, place: usize, changed: bool) -> bool {
        let index = self.input_at[place];
        if index > 0 && self.integrated {
            self.note_motion(memory, index, changed);
        } else if index > 0 {
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

    fn replace(&mut self, _: &mut Memory, _: &dyn Fn(Source) -> bool) {
        self.settle_pending = true;
    }

    fn prepared(&mut self, _: &Resources, memory: &mut Memory) -> Result<&mut dyn Differentiable> {
        if memory.state == State::Initialization && self.settle_pending {
            if self.integrated {
                self.check_stated(memory)?;
            }
            // in co-simulation what is read of the filters: the first step settles them itself
            self.settle(memory)?;
            self.settle_pending = false;
        }
        Ok(self)
    }

    fn held_output(&self, place: usize) -> Option<usize> {
        self.held[place]
    }
}

impl Prepared for ForceUnit {
    fn state_rates(&mut self, memory: &Memory, rates: &mut [f64]) -> CallResult<()> {
        self.rates_now(memory, rates);
        if rates.iter().all(|x| x.is_finite()) {
            return Ok(());
        }
        Err(Refusal::discard("derivatives: the filters have overflowed"))
    }

    fn filter_rate(&mut self, memory: &Memory, i: usize) -> Option<f64> {
        let strips = self.strips();
        let mut work = std::mem::take(&mut self.work);
        self.rates_of(memory, i % strips, &mut work);
        self.work = work;
        self.work.rates.get(i / strips).copied()
    }

    fn advance(&mut self, _: &Resources, memory: &mut Memory, step: f64) -> CallResult<bool> {
        let wind = memory.values[self.inputs[0]];
        let end = wind + memory.input_rates[0] * step;
        if wind_at_rest(end, wind) < 0.0 {
            return Err(Refusal::discard(format!(
                "wind_speed: expected zero or a positive wind speed, found {end} m/s at the end of the step"
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

    fn outputs(&mut self, _: &Resources, memory: &mut Memory) -> CallResult<()> {
        let renewed = self.renewed(memory);
        let found = self.present(memory, renewed);
        found.map_err(|why| Refusal::discard(format!("outputs: {why}")))?;
        self.put_out(memory);
        Ok(())
    }
}

/// Refuses forces that no number holds any more.
pub(super) fn check_forces(found: &[ForceAhead]) -> Result<()> {
    if found.iter().all(|f| f.force.is_finite()) {
        return Ok(());
    }
    Err(Error::Numerical("the forces have overflowed".into()))
}

impl ForceUnit {
    /// Finds the forces of all strips as they are put out, see the module.
    pub(super) fn present(&mut self, memory: &Memory, renewed: bool) -> Result<()> {
        let mut work = std::mem::take(&mut self.work);
        let found = if self.integrated {
            self.at_instant(memory, &mut work)
        } else {
            self.ahead_into(memory, renewed, &mut work)
        };
        self.work = work;
        found
    }

    /// Those of co-simulation.
    pub(super) fn ahead(&mut self, memory: &Memory, renewed: bool) -> Result<()> {
        let mut work = std::mem::take(&mut self.work);
        let found = self.ahead_into(memory, renewed, &mut work);
        self.work = work;
        found
    }

    /// Takes the motion of the present into the state, from that before.
    fn take_motion(&mut self, memory: &mut Memory, before: &SectionState) -> Result<()> {
        let mut work = std::mem::take(&mut self.work);
        self.motion(memory, &mut work.motion);
        work.flows.clear();
        work.flows.extend(self.flows(&memory.values));
        let given = GivenMotion {
            time_s: memory.time,
            wind_speed_m_s: memory.values[self.inputs[0]],
            motion: &work.motion,
        };
        let first = self.first();
        let state = &mut memory.system.values[first..];
        let taken = self.forces.take(state, &given, &work.flows);
        if taken.is_ok() {
            let mut gusts = std::mem::take(&mut memory.system.gusts);
            self.take_gusts(&mut gusts, &before.values[first..], memory, &work.flows);
            memory.system.gusts = gusts;
        }
        self.work = work;
        taken
    }

    fn put_out(&self, memory: &mut Memory) {
        let n = self.forces.dofs().len();
        let found = self.outputs.iter().zip(&self.work.forces);
        for (i, ([per_length, total], force)) in found.enumerate() {
            let length = memory.values[self.strips[i / n][1]];
            memory.values[*per_length] = force.force;
            memory.values[*total] = force.force * length;
        }
    }
}
