//! Forces alone: strips of deck whose structure is the importer's.
//!
//! The forces put out are those of the instant at which they act, `prediction` communication steps after the motion of the last step;
//! they follow from newer motion as well where it has been set since. Where the importer integrates, the instant is its own.

use super::force_parts::{StripsUnderModel, coordinate};
use super::layout::{Source, index_of};
use super::memory::{Memory, Now};
use super::trust::beyond_linear;
use super::unit::{Prepared, Unit};
use crate::error::Result;
use crate::force_options::StripsOfModel;
use crate::lifecycle::State;
use crate::prescribed::{KnownMotion, StripFlow};
use crate::refusal::CallResult;
use crate::resources::Resources;
use crate::response::SectionState;
use crate::variables::{
    ComputedNumber, Dual, LINEAR_ROTATION_RAD, Role, SectionParameter, StripState, VariableTable,
    strip_states,
};

/// How a number of the motion has been set since the last step.
pub(super) const NOT_SET: f64 = 0.0;
pub(super) const SET: f64 = 1.0;
/// A rate by the derivative of the input below it.
pub(super) const SET_AS_DERIVATIVE: f64 = 2.0;

/// Self-excited forces on strips whose motion the importer gives. The state is the time from the newest motion to the instant of
/// the forces (s), how each number of the motion has been set since, then the state of the forces, model by model.
#[derive(Debug)]
pub(super) struct ForceUnit {
    pub parts: Vec<StripsUnderModel>,
    /// Wind, then the motion: strip by strip, displacement, rate and acceleration of each degree of freedom.
    pub inputs: Vec<usize>,
    /// Index of the motion among the inputs, by index in the table; zero for what is none.
    pub input_at: Vec<usize>,
    /// Force and total force, in the order of the motion.
    pub outputs: Vec<[usize; 2]>,
    /// Further outputs: index, strip, and how it follows.
    pub rows: Vec<(usize, usize, &'static ComputedNumber)>,
    /// Width, length, wind factor of each strip.
    pub strips: Vec<[usize; 3]>,
    /// The gusts of each strip, where the unit takes some.
    pub gusts: Vec<[usize; 2]>,
    density: usize,
    pub prediction: usize,
    pub derivatives: usize,
    /// Entry of the system's state that each filter is, then each lagging gust, in the order of [`Role::Filter`].
    pub entries: Vec<usize>,
    /// Index of each of them where they stand strip by strip.
    pub inner: Vec<usize>,
    /// The same by index in the table.
    state_index: Vec<Option<usize>>,
    /// Whether the importer integrates.
    pub integrated: bool,
    /// While initialising: the flow has to settle around other motion.
    steady_flow_pending: bool,
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
    /// Forces of all strips, per length, in the order of the motion, with their rates in steady wind.
    pub forces: Vec<Dual>,
    /// As they would be without motion of the present.
    pub predicted: Vec<Dual>,
    /// State of the forces with the motion of the present, and the gusts.
    pub renewed: SectionState,
    /// Gusts of a strip.
    pub strip: Vec<f64>,
    /// Rates strip by strip.
    pub rates: Vec<f64>,
    pub before: SectionState,
}

impl ForceUnit {
    /// The forces of trained models.
    ///
    /// # Errors
    /// [`crate::Error::Numerical`] for a table that is not one of forces.
    pub(super) fn new(resources: &Resources) -> Result<Self> {
        let table = &resources.table;
        let of_models = resources.parts();
        let parts = StripsUnderModel::all(&of_models, 1);
        let last = |range: fn(&StripsUnderModel) -> usize| parts.last().map_or(0, range);
        let (count, coordinates) = (last(|p| p.strips.end), last(|p| p.coordinates.end));
        let coordinate = |s: usize, dof| coordinate(&parts, s, dof);
        let mut inputs = vec![index_of(table, Role::WindSpeed)?; 1 + 3 * coordinates];
        let (mut outputs, mut strips) = (vec![[0; 2]; coordinates], vec![[0; 3]; count]);
        let (mut gusts, mut rows) = (vec![[0; 2]; count], Vec::new());
        // in one pass: there may be ten thousand strips
        for (index, variable) in table.variables().iter().enumerate() {
            match variable.role {
                Role::Motion(s, response, dof) => {
                    inputs[1 + 3 * coordinate(s, dof) + response as usize] = index;
                }
                Role::Force(s, dof) => outputs[coordinate(s, dof)][0] = index,
                Role::TotalForce(s, dof) => outputs[coordinate(s, dof)][1] = index,
                Role::OfStrip(s, number) => rows.push((index, s, number)),
                Role::Strip(s, which) => strips[s][which as usize] = index,
                Role::Gust(s, which) => gusts[s][which as usize] = index,
                _ => {}
            }
        }
        let mut input_at = vec![0; table.variables().len()];
        for (input, index) in inputs.iter().enumerate() {
            input_at[*index] = input;
        }
        if resources.gusts.is_some() {
            // behind the motion, which is what has an index
            inputs.extend(gusts.iter().flatten());
        } else {
            gusts.clear();
        }
        let mut unit = Self {
            input_at,
            gusts,
            parts,
            inputs,
            outputs,
            rows,
            strips,
            density: index_of(table, Role::Section(SectionParameter::AirDensity))?,
            prediction: index_of(table, Role::Prediction)?,
            derivatives: index_of(table, Role::MotionDerivatives)?,
            entries: Vec::new(),
            inner: Vec::new(),
            state_index: Vec::new(),
            integrated: false,
            steady_flow_pending: true,
            warned: false,
            warned_of_mass: false,
            work: ForceWork::default(),
        };
        unit.find_states(table, &of_models);
        Ok(unit)
    }

    /// Where the states stand.
    fn find_states(&mut self, table: &VariableTable, of_models: &[StripsOfModel<'_>]) {
        let behind = self.at_rest().values.len();
        for StripState {
            strip,
            number,
            lags,
        } in strip_states(of_models)
        {
            let part = StripsUnderModel::new(&self.parts, strip);
            let filters = part.filters_of(strip);
            let (entry, number) = match lags {
                false => (filters.start + number, number),
                // behind the gusts that blow
                true => (
                    behind + part.gusts_of(strip).start + 2 + number,
                    filters.len() + number,
                ),
            };
            self.entries.push(entry);
            self.inner.push(part.inner_index(strip, number));
        }
        let states = table.variables().iter().map(|v| self.entry_of(v.role));
        self.state_index = states.collect();
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

    /// A force that was found last, with its rate; zero for what is none.
    pub(super) fn entry(&self, memory: &Memory, role: Role) -> Dual {
        let (s, dof, factor) = match role {
            Role::Force(s, dof) => (s, dof, 1.0),
            Role::TotalForce(s, dof) => (s, dof, memory.values[self.strips[s][1]]),
            _ => return Dual::default(),
        };
        let found = self.work.forces[coordinate(&self.parts, s, dof)];
        Dual::new(factor * found.value, factor * found.slope)
    }
}

impl Unit for ForceUnit {
    fn inputs(&self) -> &[usize] {
        &self.inputs
    }

    fn at_rest(&self) -> SectionState {
        let mut values = vec![NOT_SET; self.first()];
        for part in &self.parts {
            values.extend(part.forces.rest(part.strips.len()));
        }
        SectionState {
            values,
            gusts: vec![0.0; self.parts.last().map_or(0, |part| part.lagging.end)],
            ..SectionState::default()
        }
    }

    fn begin_initialization(&mut self) {
        (self.warned, self.warned_of_mass) = (false, false);
        self.steady_flow_pending = true;
    }

    fn will_be_integrated(&mut self) {
        self.integrated = true;
    }

    fn step_taken(&mut self, now: &mut Now) -> CallResult<()> {
        self.check_moving(now)
    }

    fn watch(&mut self, now: &mut Now) {
        let rotations = self.parts.iter().flat_map(|part| {
            let n = part.forces.dofs().len();
            part.coordinates.clone().skip(n - 1).step_by(n)
        });
        let largest = rotations.map(|i| now.memory.values[self.inputs[1 + 3 * i]].abs());
        let largest = largest.fold(0.0, f64::max);
        if largest > LINEAR_ROTATION_RAD && !self.warned {
            self.warned = true;
            now.notices.push(beyond_linear(largest));
        }
    }

    fn value_set(
        &mut self,
        memory: &mut Memory,
        index: usize,
        _: Source,
        before: Option<f64>,
    ) -> bool {
        let changed = before.is_some();
        self.steady_flow_pending |= changed;
        let input = self.input_at[index];
        if input > 0 && self.integrated {
            self.note_motion(memory, input, changed);
        } else if input > 0 {
            memory.system.values[input] = SET;
        }
        input > 0
    }

    fn input_rate_set(&mut self, memory: &mut Memory, index: usize) {
        // of a displacement
        let of_motion = (1..self.first()).contains(&index);
        if of_motion && (index - 1).is_multiple_of(3) && memory.system.values[index + 1] == NOT_SET
        {
            memory.system.values[index + 1] = SET_AS_DERIVATIVE;
        }
    }

    fn replace(&mut self, _: &mut Memory, _: [bool; 2]) {
        self.steady_flow_pending = true;
    }

    fn prepared(&mut self, _: &Resources, memory: &mut Memory) -> Result<&mut dyn Prepared> {
        if memory.state == State::Initialization && self.steady_flow_pending {
            if self.integrated {
                self.check_stated(memory)?;
            }
            // in co-simulation what is read of the filters: the first step settles them itself
            self.enter_steady_flow(memory)?;
            self.steady_flow_pending = false;
        }
        Ok(self)
    }

    fn state_index(&self, index: usize) -> Option<usize> {
        self.state_index[index]
    }
}

impl ForceUnit {
    /// Finds the forces of all strips as they are put out, see the module.
    pub(super) fn present(&mut self, memory: &Memory, renewed: bool) -> Result<()> {
        if self.integrated {
            return self.with_work(|unit, work| unit.at_instant(memory, work));
        }
        self.ahead(memory, renewed)
    }

    /// Those of co-simulation.
    pub(super) fn ahead(&mut self, memory: &Memory, renewed: bool) -> Result<()> {
        self.with_work(|unit, work| unit.ahead_into(memory, renewed, work))
    }

    #[inline]
    fn with_work(
        &mut self,
        find: impl FnOnce(&mut Self, &mut ForceWork) -> Result<()>,
    ) -> Result<()> {
        let mut work = std::mem::take(&mut self.work);
        let found = find(self, &mut work);
        self.work = work;
        found
    }
}
