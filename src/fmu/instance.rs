//! An exported section in motion: what the shells of every FMI version drive.
//!
//! Time is the importer's communication point plus its step, never a sum of steps. Inputs hold at the start of a step
//! and run on with the rates that were set for them (zero unless set); at its end they stand where those rates have
//! taken them. Outputs are computed once per step when first asked for, onset and divergence when first asked for after
//! a change of parameters.

mod layout;
mod saving;
mod section;
mod sensitivity;
mod serialized;
mod stepping;
mod values;

pub use layout::DataType;
pub use saving::Snapshot;

use super::lifecycle::{Call, State};
use super::refusal::{Answer, Refusal, Severity};
use super::resources::Resources;
use super::variables::VariableTable;
use crate::aerodynamics::{Realizable, Realization};
use crate::error::Result;
use crate::response::{Inputs, Outputs, Stepper};
use layout::Layout;
use saving::{Experiment, Memory};

/// Searches for growth of one instance at most: one takes as long as some thousand steps, and an importer may change
/// parameters at every communication point.
const GROWTH_SEARCHES: usize = 32;

/// One instance; instances share nothing.
#[derive(Debug)]
pub struct Instance {
    resources: Resources,
    layout: Layout,
    aerodynamics: Realization,
    memory: Memory,
    /// The memory at the beginning.
    fresh: Memory,
    /// Stepper of the current parameters; `None` after they have changed.
    stepper: Option<Stepper>,
    /// While initialising: the state has to be made anew from the values at release.
    release_pending: bool,
    outputs_current: bool,
    onset_current: bool,
    /// Whether growth below the onset has been looked for with the current parameters.
    growth_known: bool,
    /// Searches for growth that this instance may still do.
    growth_searches_left: usize,
    inputs: Inputs,
    outputs: Outputs,
    notices: Vec<String>,
}

impl Instance {
    /// A new instance with every variable at its start value.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for a model without a realisation, or whose section cannot be coupled with it.
    pub fn new(resources: Resources) -> Result<Self> {
        let layout = Layout::new(&resources.table)?;
        let model = &resources.model;
        let aerodynamics = model.model.realize();
        let dofs = layout.force.len();
        let states = 2 * dofs + aerodynamics.states();
        let fresh = Memory::new(&resources.table, &layout, states);
        let mut instance = Self {
            memory: fresh.clone(),
            fresh,
            aerodynamics,
            stepper: None,
            release_pending: true,
            outputs_current: false,
            onset_current: false,
            growth_known: false,
            growth_searches_left: GROWTH_SEARCHES,
            inputs: Inputs::steady(0.0, dofs),
            outputs: Outputs::default(),
            notices: Vec::new(),
            layout,
            resources,
        };
        // a section that cannot be coupled is no model to run: say so now
        instance.stepper = Some(instance.new_stepper(&instance.memory.values)?);
        instance.watch_growth();
        Ok(instance)
    }

    /// Where the instance stands.
    pub fn state(&self) -> State {
        self.memory.state
    }

    /// Its variables.
    pub fn table(&self) -> &VariableTable {
        &self.resources.table
    }

    /// Point of time reached, s.
    pub fn time_s(&self) -> f64 {
        self.memory.time
    }

    /// Remarks that have come up since they were last asked for.
    pub fn take_notices(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notices)
    }

    /// Whether there are remarks.
    pub fn has_notices(&self) -> bool {
        !self.notices.is_empty()
    }

    /// Whether `call` is legal now.
    ///
    /// # Errors
    /// A [`Refusal`] naming call and state.
    pub fn admit(&self, call: Call) -> Answer<()> {
        if call.legal_in().contains(self.memory.state) {
            Ok(())
        } else {
            Err(not_now(call, self.memory.state))
        }
    }

    /// Takes note that a call was refused: an error ends the run.
    pub fn note(&mut self, refusal: &Refusal) {
        if refusal.severity == Severity::Error {
            self.memory.state = State::Error;
        }
    }

    /// Sets the times of the run, s.
    ///
    /// # Errors
    /// Times that are not finite, or a stop before the start.
    pub fn set_up_experiment(&mut self, start: f64, stop: Option<f64>) -> Answer<()> {
        if !start.is_finite() || stop.is_some_and(|stop| !stop.is_finite() || stop < start) {
            let stop = stop.map_or_else(|| "none".into(), |s| s.to_string());
            return Err(Refusal::error(format!(
                "expected a finite start time and a stop time not before it, found start {start}, stop {stop}"
            )));
        }
        self.memory.experiment = Some(Experiment { start, stop });
        self.memory.time = start;
        Ok(())
    }

    /// Begins the initialisation. An experiment that was not set up starts at the start time of the description, zero,
    /// with a warning.
    pub fn enter_initialization(&mut self) {
        if self.memory.experiment.is_none() {
            self.memory.experiment = Some(Experiment {
                start: 0.0,
                stop: None,
            });
            self.memory.time = 0.0;
            self.notices.push(
                "the experiment has not been set up: the run starts at 0 s and has no end".into(),
            );
        }
        self.memory.state = State::Initialization;
        self.release_pending = true;
        self.outputs_current = false;
    }

    /// Releases the section.
    ///
    /// # Errors
    /// When parameters and initial values give no section that can move.
    pub fn exit_initialization(&mut self) -> Answer<()> {
        self.prepare()?;
        self.watch_growth();
        self.memory.state = State::StepComplete;
        Ok(())
    }

    /// Ends the run.
    pub fn terminate(&mut self) {
        self.memory.state = State::Terminated;
    }

    /// Restores every default.
    pub fn reset(&mut self) {
        let fresh = self.fresh.clone();
        self.replace_memory(fresh);
    }

    /// Says, once for each set of parameters, where the section grows although nothing was tested there.
    fn watch_growth(&mut self) {
        if self.growth_known || self.growth_searches_left == 0 {
            return;
        }
        self.growth_known = true;
        self.growth_searches_left -= 1;
        match self.growth(&self.memory.values) {
            Ok(growth) if growth.is_none() => {}
            Ok(growth) => self.notices.push(format!(
                "with these parameters the section {}",
                growth.explain()
            )),
            // no reason to end a run
            Err(e) => self
                .notices
                .push(format!("growth below the onset could not be judged: {e}")),
        }
        if self.growth_searches_left == 0 {
            self.notices.push(format!(
                "growth below the onset is no longer looked for after {GROWTH_SEARCHES} changes of parameters"
            ));
        }
    }

    fn new_stepper(&self, values: &[f64]) -> Result<Stepper> {
        let Resources { model, table, .. } = &self.resources;
        section::coupled_section(model, table, &self.aerodynamics, values).map(Stepper::new)
    }

    /// Makes stepper and, while initialising, state fit the current values.
    fn prepare(&mut self) -> Answer<()> {
        if self.stepper.is_none() {
            self.stepper = Some(self.new_stepper(&self.memory.values)?);
        }
        if self.release_pending && self.memory.state == State::Initialization {
            if let Some(stepper) = &self.stepper {
                self.memory.section = self.release(stepper, &self.memory.values)?;
            }
            self.release_pending = false;
        }
        Ok(())
    }

    /// State at release with the initial values in `values`.
    fn release(&self, stepper: &Stepper, values: &[f64]) -> Result<crate::response::SectionState> {
        let pick = |places: &[usize]| places.iter().map(|i| values[*i]).collect::<Vec<_>>();
        stepper.released(
            &pick(&self.layout.initial_displacement),
            &pick(&self.layout.initial_rate),
        )
    }
}

#[cold]
fn not_now(call: Call, state: State) -> Refusal {
    Refusal::error(format!(
        "{} is not legal in the state `{}`, only {}",
        call.name(),
        state.name(),
        call.legal_in().names()
    ))
}
