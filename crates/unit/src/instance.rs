//! An exported unit in motion: what the shells of every FMI version drive, in steps of its own (co-simulation) or with the
//! importer integrating (model exchange).
//!
//! Time is the importer's communication point plus its step, never a sum of steps. Inputs hold at the start of a step
//! and run on with the rates that were set for them (zero unless set); at its end they stand where those rates have
//! taken them. Outputs are computed once per step when first asked for.

mod access;
mod bridge_built;
mod bridge_onset;
mod bridge_unit;
mod calculated;
mod coupled;
mod coupled_derivatives;
mod coupled_indices;
mod coupled_present;
mod damping;
mod dependencies;
pub(crate) mod derivatives;
mod force_ahead;
mod force_derivatives;
mod force_exchange;
mod force_parts;
mod force_rows;
mod force_unit;
mod integration;
mod layout;
mod memory;
mod saving;
mod section;
mod section_unit;
mod sensitivity;
mod stepping;
#[cfg(test)]
mod tests;
mod trust;
mod unit;
mod values;

pub use layout::DataType;
pub use memory::Memory;

use super::lifecycle::{Call, Interface, LEGAL_CALLS, State, StateSet};
use super::refusal::{CallResult, Refusal, RefusalEffect};
use super::resources::Resources;
use super::variables::VariableTable;
use crate::error::Result;
use bridge_unit::BridgeUnit;
use force_unit::ForceUnit;
use layout::VariableLayout;
use memory::Now;
use section_unit::SectionUnit;
use std::collections::HashMap;
use trust::shown;
use unit::Unit;

/// One instance; instances share nothing.
#[derive(Debug)]
pub struct Instance {
    pub(crate) now: Now,
    interface: Interface,
    layout: VariableLayout,
    unit: Box<dyn Unit>,
    /// The memory at the beginning.
    fresh: Memory,
    outputs_current: bool,
    /// Cached rates of the states.
    rates: Vec<f64>,
    /// The table with its dependencies, once they have been asked for.
    described: Option<VariableTable>,
}

impl Instance {
    /// A new instance with every variable at its start value.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for a model without a realisation, or whose section cannot be coupled with it.
    pub fn new(resources: Resources) -> Result<Self> {
        let mut unit: Box<dyn Unit> = match (&resources.bridge, &resources.force) {
            (Some(options), _) => Box::new(BridgeUnit::of_bridge(&resources, options)?),
            (None, Some(_)) => Box::new(ForceUnit::new(&resources)?),
            (None, None) => Box::new(SectionUnit::of_section(&resources)?),
        };
        let layout = VariableLayout::new(&resources.table, |index| unit.state_index(index))?;
        let fresh = Memory::new(&resources, unit.inputs().len(), unit.at_rest());
        let mut memory = fresh.clone();
        // a section that cannot be coupled is no model to run: say so now
        unit.prepared(&resources, &mut memory)?;
        Ok(Self {
            now: Now {
                memory: fresh.clone(),
                notices: Vec::new(),
                resources,
            },
            fresh,
            unit,
            interface: Interface::CoSimulation,
            outputs_current: false,
            rates: Vec::new(),
            described: None,
            layout,
        })
    }

    /// Where the instance stands.
    pub fn state(&self) -> State {
        self.now.memory.state
    }

    /// Its variables.
    pub fn table(&self) -> &VariableTable {
        &self.now.resources.table
    }

    /// Point of time reached, s.
    pub fn time_s(&self) -> f64 {
        self.now.memory.time
    }

    /// Remarks that have come up since they were last asked for.
    pub fn take_notices(&mut self) -> Vec<String> {
        std::mem::take(&mut self.now.notices)
    }

    /// Whether `call` is legal now.
    ///
    /// # Errors
    /// A [`Refusal`] naming the state.
    pub(crate) fn admit(&self, call: Call) -> CallResult<()> {
        let legal = LEGAL_CALLS[call as usize].1[self.interface as usize];
        if legal.contains(self.now.memory.state) {
            return Ok(());
        }
        Err(not_legal(legal, self.now.memory.state))
    }

    /// Takes note that a call was refused: an error ends the run.
    pub fn note(&mut self, refusal: &Refusal) {
        if refusal.severity == RefusalEffect::Error {
            self.now.memory.state = State::Error;
        }
    }

    /// Sets the times of the run, s.
    ///
    /// # Errors
    /// Times that are not finite, or a stop before the start.
    pub fn set_up_experiment(&mut self, start: f64, stop: Option<f64>) -> CallResult<()> {
        if !start.is_finite() || stop.is_some_and(|stop| !stop.is_finite() || stop < start) {
            let [start, stop] = [Some(start), stop].map(|s| s.map_or("none".into(), shown));
            return Err(Refusal::error(format!(
                "expected a finite start time and a stop time not before it, found start {start}, stop {stop}"
            )));
        }
        self.now.memory.experiment = Some((start, stop));
        self.now.memory.time = start;
        Ok(())
    }

    /// Begins the initialisation. An experiment that was not set up starts at the start time of the description, zero,
    /// with a warning.
    pub fn enter_initialization(&mut self) {
        if self.now.memory.experiment.is_none() {
            self.now.memory.experiment = Some((0.0, None));
            self.now.memory.time = 0.0;
            self.now.notices.push(
                "the experiment has not been set up: the run starts at 0 s and has no end".into(),
            );
        }
        self.now.memory.state = State::Initialization;
        self.unit.begin_initialization();
        self.outputs_current = false;
    }

    /// Ends the initialisation: the section is released.
    ///
    /// # Errors
    /// When parameters and initial values give no section that can move.
    pub fn exit_initialization(&mut self) -> CallResult<()> {
        let now = &mut self.now;
        self.unit.prepared(&now.resources, &mut now.memory)?;
        // whatever is read between steps is read without a further look
        sensitivity::check_finite(&now.memory.system.all())?;
        self.unit.watch(now);
        self.now.memory.state = match self.interface {
            Interface::CoSimulation => State::StepComplete,
            Interface::ModelExchange => State::EventMode,
        };
        Ok(())
    }

    /// Ends the run.
    pub fn terminate(&mut self) {
        self.now.memory.state = State::Terminated;
    }

    /// Restores every default.
    pub fn reset(&mut self) {
        let fresh = self.fresh.clone();
        self.replace_memory(fresh);
    }

    /// The same with so many strips, or as many as were exported; those beyond them are like the last. What has been set stays where there
    /// still is such a variable.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for what has no strips to count, and for too many.
    pub(crate) fn resized(&self, strips: Option<usize>) -> Result<Self> {
        let mut resized = Self::new(self.now.resources.with_strips(strips)?)?;
        resized.interface = self.interface;
        let variables = self.table().variables().iter();
        let values = variables.zip(&self.now.memory.values);
        let old: HashMap<&str, f64> = values.map(|(v, x)| (v.name.as_str(), *x)).collect();
        for index in 0..resized.table().variables().len() {
            let name = resized.table().variables()[index].name.as_str();
            if let Some(value) = old.get(name)
                && resized.layout.access[index]
                    .settable
                    .contains(State::Instantiated)
            {
                resized.now.memory.values[index] = *value;
            }
        }
        Ok(resized)
    }

    /// Whether it has another number of strips than was exported.
    pub(crate) fn is_resized(&self) -> bool {
        self.now.resources.exported_force.is_some()
    }
}

#[cold]
fn not_legal(legal: StateSet, state: State) -> Refusal {
    if legal == StateSet::NONE {
        return Refusal::call(
            "it belongs to model exchange, and this instance was made for co-simulation",
        );
    }
    Refusal::error(format!(
        "not legal in the state `{}`, only {}",
        state.name(),
        legal.names()
    ))
}
