//! What a section and a bridge share: a structure coupled with its self-excited forces.

use super::calculated::CalculatedNumbers;
use super::damping::PresentDamping;
use super::layout::{Source, index_of};
use super::memory::{Memory, starts};
use super::section::OnsetCard;
use super::sensitivity::{SectionValues, check_finite, finite};
use super::unit::{Differentiable, Prepared, Unit};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::lifecycle::State;
use crate::refusal::CallResult;
use crate::resources::Resources;
use crate::response::{Inputs, Outputs, SectionState, Stepper};
use crate::section::Dof;
use crate::variables::{Causality, Response, Role, Variable, VariableTable};
use std::fmt::Debug;

/// Indices in the table.
#[derive(Debug)]
pub(super) struct CoupledIndices {
    /// Wind speed, then forces, then gusts: the inputs.
    pub inputs: Vec<usize>,
    /// Where the gusts begin among them.
    pub first_gust: usize,
    /// Displacements at release, then rates where they can be set.
    pub initial: Vec<usize>,
    /// Upper end of the search for the onset.
    pub limit: usize,
    /// Factor on the turbulence of the archive.
    pub turbulence_factor: Option<usize>,
    /// Entry of the state that a variable is; by index.
    pub state_entry: Vec<Option<usize>>,
}

impl CoupledIndices {
    /// Those of a section or bridge, whose inputs stand first in the table, in this order.
    pub(super) fn new(table: &VariableTable) -> Result<Self> {
        let all = |wanted: &dyn Fn(&Variable) -> bool| -> Vec<usize> {
            let variables = table.variables().iter().enumerate();
            let wanted = variables.filter(|(_, v)| wanted(v));
            wanted.map(|(index, _)| index).collect()
        };
        let inputs = all(&|v| v.causality == Causality::Input);
        let gusts = all(&|v| matches!(v.role, Role::Gust(..))).len();
        let displacements =
            |v: &Variable| matches!(v.role, Role::InitialDisplacement(_) | Role::InitialMode(_));
        let mut initial = all(&displacements);
        initial.extend(all(&|v| matches!(v.role, Role::InitialRate(_))));
        // the state begins with all displacements, then all rates; on a bridge every entry is numbered
        let dofs = table.dofs();
        let of = |dof: Dof| dofs.iter().position(|d| *d == dof);
        let entries = table.variables().iter().map(|v| match v.role {
            Role::Filter(i) => Some(2 * dofs.len() + i),
            Role::Response(Response::Displacement, dof) => of(dof),
            Role::Response(Response::Rate, dof) => of(dof).map(|i| dofs.len() + i),
            _ => None,
        });
        Ok(Self {
            first_gust: inputs.len() - gusts,
            inputs,
            initial,
            limit: index_of(table, Role::OnsetSearchLimit)?,
            turbulence_factor: table.find(Role::TurbulenceFactor),
            state_entry: entries.collect(),
        })
    }

    pub(super) fn wind_speed(&self, memory: &Memory) -> f64 {
        memory.values[self.inputs[0]]
    }

    pub(super) fn limit(&self, memory: &Memory) -> f64 {
        memory.values[self.limit]
    }

    pub(super) fn forces(&self) -> &[usize] {
        &self.inputs[1..self.first_gust]
    }

    pub(super) fn gusts(&self) -> &[usize] {
        &self.inputs[self.first_gust..]
    }
}

/// Gusts have blown as they do now until the release: `gusts` for every group of lags.
fn blow_until_release(state: &mut SectionState, gusts: &[f64]) {
    let lags = state.gusts.len() / gusts.len().max(1);
    for (lagging, gust) in state.gusts.chunks_mut(lags.max(1)).zip(gusts) {
        lagging.fill(*gust);
    }
}

/// What a section and a bridge do each in their own way.
pub(super) trait CoupledKind: Debug + Send + Sized + 'static {
    /// What follows from the parameters.
    type Built: Debug + Send;

    /// The same for the parameters in `values`.
    ///
    /// # Errors
    /// When they give nothing that can be simulated.
    fn build(&self, resources: &Resources, values: &[f64]) -> Result<Self::Built>;

    fn stepper(built: &Self::Built) -> &Stepper;

    fn parts(built: &mut Self::Built) -> (&mut Stepper, &mut PresentDamping);

    /// The parameters have changed, and what was built is replaced.
    fn replaces(_unit: &mut Coupled<Self>) {}

    /// Parameters or the limit of the search have changed.
    fn parameters_changed(&mut self) {}

    /// Inputs, or what is made of them, may have changed.
    fn inputs_changed(&mut self) {}

    /// Nothing has been said yet.
    fn forget_warnings(&mut self);

    /// Loads the inputs of a memory.
    fn load_inputs(unit: &mut Coupled<Self>, memory: &Memory);

    /// The same of the memory of the unit, which may know them.
    fn load_own_inputs(unit: &mut Coupled<Self>, memory: &Memory) {
        Self::load_inputs(unit, memory);
    }

    /// Displacements and rates of the coordinates at release with the initial values in `values`.
    fn motion_at_release(unit: &Coupled<Self>, values: &[f64]) -> [Vec<f64>; 2];

    /// What a variable that is no computed number stands for.
    fn pick(unit: &Coupled<Self>, instant: &SectionValues, role: Role) -> f64;

    /// Of outputs of the coordinates, or their derivatives, what [`Known::Motion`](crate::variables::Known::Motion) stands for in `state`.
    fn motion(
        unit: &Coupled<Self>,
        state: &SectionState,
        outputs: &Outputs,
        response: Response,
        dof: Dof,
    ) -> f64;

    /// Greatest rotation, rad.
    fn rotation(unit: &Coupled<Self>, memory: &Memory) -> f64;

    fn wind_is_tested(
        unit: &mut Coupled<Self>,
        resources: &Resources,
        memory: &mut Memory,
        notices: &mut Vec<String>,
    ) -> bool;

    /// Onset and divergence for the parameters that it has been built with, by a search.
    fn searched(unit: &Coupled<Self>, resources: &Resources, memory: &Memory) -> OnsetCard;

    /// The same by the shortest way that is known to be right.
    fn found(unit: &mut Coupled<Self>, resources: &Resources, memory: &Memory) -> OnsetCard {
        Self::searched(unit, resources, memory)
    }

    /// See [`Unit::watch`].
    fn watch(
        unit: &mut Coupled<Self>,
        resources: &Resources,
        memory: &Memory,
        notices: &mut Vec<String>,
    );

    /// See [`Prepared::advance`].
    fn advance(unit: &mut Coupled<Self>, memory: &mut Memory, step: f64) -> Result<()>;

    /// See [`Unit::repeat`].
    fn repeat(_unit: &mut Coupled<Self>, _memory: &mut Memory, _step: f64) -> Option<bool> {
        None
    }

    /// See [`Unit::repeat_outputs`].
    fn repeat_outputs(_unit: &mut Coupled<Self>, _memory: &mut Memory) -> bool {
        false
    }

    /// Writes outputs into the memory.
    fn write_outputs(unit: &Coupled<Self>, memory: &mut Memory);
}

/// A structure coupled with its self-excited forces, rebuilt when parameters change.
#[derive(Debug)]
pub(super) struct Coupled<S: CoupledKind> {
    pub own: S,
    pub indices: CoupledIndices,
    /// Of the parameters as they are.
    pub built: S::Built,
    /// Whether they have changed since.
    stale: bool,
    /// While initialising: the state has to be made anew from the values at release.
    release_pending: bool,
    pub calculated: CalculatedNumbers,
    pub inputs: Inputs,
    pub outputs: Outputs,
}

impl<S: CoupledKind> Unit for Coupled<S> {
    fn inputs(&self) -> &[usize] {
        &self.indices.inputs
    }

    fn at_rest(&self) -> SectionState {
        SectionState {
            values: vec![0.0; self.section().states()],
            gusts: vec![0.0; S::stepper(&self.built).gust_states()],
            ..SectionState::default()
        }
    }

    fn changed(&mut self, source: Source) {
        match source {
            Source::Input => self.own.inputs_changed(),
            Source::Section => {
                self.stale = true;
                self.own.inputs_changed();
                self.calculated.forget();
                self.own.parameters_changed();
                self.release_pending = true;
            }
            Source::Release => self.release_pending = true,
            Source::Limit => {
                self.calculated.forget();
                self.own.parameters_changed();
            }
            Source::Constant
            | Source::Response
            | Source::Calculated
            | Source::Status
            | Source::State
            | Source::Rate => {}
        }
    }

    fn input_set(&mut self, memory: &mut Memory, index: usize, _: bool) -> bool {
        if memory.state == State::Initialization && self.indices.gusts().contains(&index) {
            self.release_pending = true;
        }
        false
    }

    fn begin_initialization(&mut self) {
        self.own.forget_warnings();
        self.release_pending = true;
    }

    fn input_rate_set(&mut self, _: &mut Memory, _: usize) {
        self.own.inputs_changed();
    }

    fn replace(&mut self, new: &mut Memory, same: &dyn Fn(Source) -> bool) {
        self.own.inputs_changed();
        let same_system = same(Source::Section);
        self.stale |= !same_system;
        let same = same_system && same(Source::Limit);
        self.calculated.carry_over(new, same);
        self.release_pending = true;
    }

    fn prepared(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
    ) -> Result<&mut dyn Differentiable> {
        if self.stale {
            let built = self.own.build(resources, &memory.values)?;
            S::replaces(self);
            self.built = built;
            self.stale = false;
        }
        if self.release_pending && memory.state == State::Initialization {
            S::load_inputs(self, memory);
            memory.system = self.release(&memory.values)?;
            self.release_pending = false;
        }
        Ok(self)
    }

    fn calculated(&mut self) -> Option<&mut CalculatedNumbers> {
        Some(&mut self.calculated)
    }

    fn watch(&mut self, resources: &Resources, memory: &Memory, notices: &mut Vec<String>) {
        S::watch(self, resources, memory, notices);
    }

    fn repeat(&mut self, memory: &mut Memory, step: f64) -> Option<bool> {
        S::repeat(self, memory, step)
    }

    fn repeat_outputs(&mut self, memory: &mut Memory) -> bool {
        S::repeat_outputs(self, memory)
    }

    fn state_index(&self, index: usize) -> Option<usize> {
        self.indices.state_entry[index]
    }
}

impl<S: CoupledKind> Prepared for Coupled<S> {
    fn advance(&mut self, _: &Resources, memory: &mut Memory, step: f64) -> CallResult<bool> {
        S::advance(self, memory, step)?;
        Ok(false)
    }

    fn state_rates(&mut self, memory: &Memory, rates: &mut [f64]) -> CallResult<()> {
        S::load_inputs(self, memory);
        let (stepper, _) = S::parts(&mut self.built);
        stepper.write_derivative(&memory.system, &self.inputs, rates)?;
        finite(rates)
    }

    fn outputs(&mut self, _: &Resources, memory: &mut Memory) -> CallResult<()> {
        S::load_own_inputs(self, memory);
        let (stepper, _) = S::parts(&mut self.built);
        stepper.outputs(&memory.system, &self.inputs, &mut self.outputs)?;
        check_finite(&self.outputs)?;
        S::write_outputs(self, memory);
        Ok(())
    }

    /// Onset and divergence. A search that fails is no reason to end a run.
    fn calculate(&mut self, resources: &Resources, memory: &mut Memory, notices: &mut Vec<String>) {
        if !self.calculated.are_known() {
            let card = S::found(self, resources, memory);
            self.calculated.enter(card, memory, notices);
        }
    }
}

impl<S: CoupledKind> Coupled<S> {
    pub(super) fn new(own: S, resources: &Resources) -> Result<Self> {
        let table = &resources.table;
        let built = own.build(resources, &starts(table))?;
        let coordinates = S::stepper(&built).section().structure().dofs.len();
        Ok(Self {
            own,
            indices: CoupledIndices::new(table)?,
            built,
            stale: false,
            release_pending: true,
            calculated: CalculatedNumbers::new(table),
            inputs: Inputs::steady(0.0, coordinates),
            outputs: Outputs::default(),
        })
    }

    /// What steps it, and the inputs that are loaded.
    pub(super) fn parts(&mut self) -> (&mut Stepper, &mut Inputs) {
        (S::parts(&mut self.built).0, &mut self.inputs)
    }

    pub(super) fn section(&self) -> &CoupledSection {
        S::stepper(&self.built).section()
    }

    /// State at release with the initial values in `values` and the gusts that are loaded.
    pub(super) fn release(&self, values: &[f64]) -> Result<SectionState> {
        let [displacement, rate] = S::motion_at_release(self, values);
        let mut state = S::stepper(&self.built).released(&displacement, &rate)?;
        blow_until_release(&mut state, &self.inputs.gust_m_s);
        Ok(state)
    }

    /// `result` with the parameters of another memory.
    pub(super) fn with_parameters(
        &mut self,
        resources: &Resources,
        other: &Memory,
        result: &mut dyn FnMut(&mut Self) -> Result<Vec<f64>>,
    ) -> Result<Vec<f64>> {
        let of_other = self.own.build(resources, &other.values)?;
        let present = std::mem::replace(&mut self.built, of_other);
        let found = result(self);
        self.built = present;
        found
    }

    /// All that there is in a state, with the inputs that are loaded.
    pub(super) fn instant(&mut self, state: &SectionState) -> Result<SectionValues> {
        let (stepper, inputs) = self.parts();
        SectionValues::new(stepper, state, inputs)
    }
}
