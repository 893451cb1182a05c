//! An exported section in motion: what the shells of every FMI version drive.
//!
//! Time is the importer's communication point plus its step, never a sum of steps. Inputs hold at the start of a step
//! and run on with the rates that were set for them (zero unless set); at its end they stand where those rates have
//! taken them. Outputs are computed once per step when first asked for, onset and divergence when first asked for after
//! a change of parameters.

mod layout;
mod memory;
mod section;
mod sensitivity;
mod serialized;

pub use layout::DataType;

use super::lifecycle::{Call, State};
use super::refusal::{Answer, Refusal, Severity};
use super::resources::Resources;
use super::variables::{Role, VariableTable};
use crate::aerodynamics::{AerodynamicModel, Realization};
use crate::error::{Error, Result};
use crate::response::{Inputs, Outputs, Stepper};
use layout::{Layout, Source};
use memory::{Experiment, Memory};
use section::OnsetCard;
use uuid::Uuid;

/// How far an importer's clock may have drifted from ours, relative to the time: sums of some 10⁶ steps.
const CLOCK_TOLERANCE: f64 = 1e-9;
/// The same relative to the step, for times near zero.
const CLOCK_TOLERANCE_OF_STEP: f64 = 1e-6;

/// A saved state of an instance.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    guid: Uuid,
    memory: Memory,
}

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
    inputs: Inputs,
    outputs: Outputs,
    notices: Vec<String>,
}

impl Instance {
    /// A new instance with every variable at its start value.
    ///
    /// # Errors
    /// [`Error::Input`] for a model without a realisation, or whose section cannot be coupled with it.
    pub fn new(resources: Resources) -> Result<Self> {
        let layout = Layout::new(&resources.table)?;
        let model = &resources.model;
        let aerodynamics = model.model.realize().ok_or_else(|| {
            Error::input("model", "a model with a realisation", model.model.kind())
        })?;
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
            inputs: Inputs::steady(0.0, dofs),
            outputs: Outputs::default(),
            notices: Vec::new(),
            layout,
            resources,
        };
        // a section that cannot be coupled is no model to run: say so now
        instance.stepper = Some(instance.new_stepper(&instance.memory.values)?);
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

    /// Begins the initialisation.
    ///
    /// # Errors
    /// When the experiment has not been set up.
    pub fn enter_initialization(&mut self) -> Answer<()> {
        if self.memory.experiment.is_none() {
            return Err(Refusal::error(
                "the experiment has to be set up first: its start time is not known",
            ));
        }
        self.memory.state = State::Initialization;
        self.release_pending = true;
        self.outputs_current = false;
        Ok(())
    }

    /// Releases the section.
    ///
    /// # Errors
    /// When parameters and initial values give no section that can move.
    pub fn exit_initialization(&mut self) -> Answer<()> {
        self.prepare()?;
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

    /// Values of real variables.
    ///
    /// # Errors
    /// A reference that is none, of another type, or not readable now; a value that cannot be computed.
    pub fn reals(&mut self, references: &[u32], values: &mut [f64]) -> Answer<()> {
        for (reference, value) in references.iter().zip(values) {
            *value = self.number(*reference, DataType::Real)?;
        }
        Ok(())
    }

    /// Value of an integer variable.
    ///
    /// # Errors
    /// As [`Instance::reals`].
    pub fn integer(&mut self, reference: u32) -> Answer<i32> {
        Ok(self.number(reference, DataType::Integer)? as i32)
    }

    /// Value of a truth variable.
    ///
    /// # Errors
    /// As [`Instance::reals`].
    pub fn boolean(&mut self, reference: u32) -> Answer<bool> {
        Ok(self.number(reference, DataType::Boolean)? != 0.0)
    }

    /// Place in the table of a text that may be read now.
    ///
    /// # Errors
    /// As [`Instance::reals`].
    pub fn text_place(&self, reference: u32) -> Answer<usize> {
        let table = &self.resources.table;
        self.layout
            .readable(reference, DataType::String, self.memory.state, table)
            .map(|(place, _)| place)
    }

    fn number(&mut self, reference: u32, wanted: DataType) -> Answer<f64> {
        let table = &self.resources.table;
        let (place, access) = self
            .layout
            .readable(reference, wanted, self.memory.state, table)?;
        match access.source {
            Source::Response if !self.outputs_current => self.refresh_outputs()?,
            Source::Calculated if !self.onset_current => self.refresh_onset()?,
            _ => {}
        }
        Ok(self.memory.values[place])
    }

    /// Sets real variables: all of them or, when one is refused, none.
    ///
    /// # Errors
    /// An error for a reference that is none, of another type or not settable now, and for a value that is not finite;
    /// a discard for a value outside the limits of its variable.
    pub fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Answer<()> {
        let table = &self.resources.table;
        for (reference, value) in references.iter().zip(values) {
            let target =
                self.layout
                    .writable(*reference, DataType::Real, self.memory.state, table)?;
            self.layout.check_value(target, *value, table)?;
        }
        for (reference, value) in references.iter().zip(values) {
            self.store(*reference as usize, *value);
        }
        Ok(())
    }

    /// Refuses to set variables of a type that has none to set.
    ///
    /// # Errors
    /// For every reference.
    pub fn refuse_to_set(&self, references: &[u32], of_type: DataType) -> Answer<()> {
        let table = &self.resources.table;
        for reference in references {
            self.layout
                .writable(*reference, of_type, self.memory.state, table)?;
        }
        Ok(())
    }

    fn store(&mut self, place: usize, value: f64) {
        if self.memory.values[place].to_bits() == value.to_bits() {
            return;
        }
        self.memory.values[place] = value;
        self.outputs_current = false;
        match self.layout.source(place) {
            Source::Section => {
                self.stepper = None;
                self.onset_current = false;
                self.release_pending = true;
            }
            Source::Release => self.release_pending = true,
            Source::Limit => self.onset_current = false,
            _ => {}
        }
    }

    /// Sets first rates of inputs, per second: all of them or none.
    ///
    /// # Errors
    /// A reference that is no input, another order than one, a rate that is not finite.
    pub fn set_input_rates(
        &mut self,
        references: &[u32],
        orders: &[i32],
        rates: &[f64],
    ) -> Answer<()> {
        for ((reference, order), rate) in references.iter().zip(orders).zip(rates) {
            self.input_index(*reference)?;
            check_order(*order)?;
            if !rate.is_finite() {
                return Err(Refusal::error(format!(
                    "rate of value reference {reference}: expected a finite number, found {rate}"
                )));
            }
        }
        for (reference, rate) in references.iter().zip(rates) {
            let index = self.input_index(*reference)?;
            self.memory.input_rates[index] = *rate;
        }
        Ok(())
    }

    /// Place among the inputs: wind speed, then the external forces.
    fn input_index(&self, reference: u32) -> Answer<usize> {
        let table = &self.resources.table;
        let (place, _) = self.layout.typed(reference, DataType::Real, table)?;
        let forces = self.layout.force.iter().copied();
        std::iter::once(self.layout.wind_speed)
            .chain(forces)
            .position(|input| input == place)
            .ok_or_else(|| {
                let name = table.variables()[place].name;
                Refusal::error(format!("`{name}` is no input"))
            })
    }

    /// One communication step of `step` seconds from the point of time `point`.
    ///
    /// # Errors
    /// An error for a step that is not positive, a point that is not ours, or an end behind the stop time; a discard,
    /// with everything as it was, when the step cannot be computed.
    pub fn do_step(&mut self, point: f64, step: f64) -> Answer<()> {
        self.check_step(point, step)?;
        if let Err(refusal) = self.advance(step) {
            self.memory.state = State::StepFailed;
            return Err(Refusal::discard(refusal.message));
        }
        self.run_inputs_on(step);
        self.memory.time = point + step;
        self.outputs_current = false;
        Ok(())
    }

    fn advance(&mut self, step: f64) -> Answer<()> {
        self.prepare()?;
        self.load_inputs();
        if let Some(stepper) = &mut self.stepper {
            stepper.advance(&mut self.memory.section, &self.inputs, step)?;
        }
        Ok(())
    }

    fn check_step(&self, point: f64, step: f64) -> Answer<()> {
        let time = self.memory.time;
        if !(step.is_finite() && step > 0.0) {
            return Err(Refusal::error(format!(
                "communication step: expected a positive number, found {step}"
            )));
        }
        let tolerance =
            CLOCK_TOLERANCE * time.abs().max(point.abs()) + CLOCK_TOLERANCE_OF_STEP * step;
        // written so that a NaN is refused
        if !((point - time).abs() <= tolerance) {
            return Err(Refusal::error(format!(
                "communication point: expected {time} s, where the last step ended, found {point}"
            )));
        }
        match self.memory.experiment.and_then(|e| e.stop) {
            Some(stop) if point + step > stop + tolerance + CLOCK_TOLERANCE * stop.abs() => {
                Err(Refusal::error(format!(
                    "communication step: expected an end not after the stop time {stop} s, found {}",
                    point + step
                )))
            }
            _ => Ok(()),
        }
    }

    fn load_inputs(&mut self) {
        let (values, rates) = (&self.memory.values, &self.memory.input_rates);
        self.inputs.wind_speed_m_s = values[self.layout.wind_speed];
        self.inputs.wind_speed_rate_m_s2 = rates[0];
        for (i, place) in self.layout.force.iter().enumerate() {
            self.inputs.force[i] = values[*place];
            self.inputs.force_rate[i] = rates[i + 1];
        }
    }

    fn run_inputs_on(&mut self, step: f64) {
        let values = &mut self.memory.values;
        let inputs =
            std::iter::once(self.layout.wind_speed).chain(self.layout.force.iter().copied());
        for (place, rate) in inputs.zip(&self.memory.input_rates) {
            if *rate != 0.0 {
                values[place] += rate * step;
            }
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

    fn refresh_outputs(&mut self) -> Answer<()> {
        self.prepare()?;
        self.load_inputs();
        if let Some(stepper) = &mut self.stepper {
            stepper.outputs(&self.memory.section, &self.inputs, &mut self.outputs)?;
        }
        for (i, places) in self.layout.responses.iter().enumerate() {
            let values = &mut self.memory.values;
            values[places[0]] = self.outputs.displacement[i];
            values[places[1]] = self.outputs.rate[i];
            values[places[2]] = self.outputs.acceleration[i];
            values[places[3]] = self.outputs.self_excited_force[i];
        }
        self.outputs_current = true;
        Ok(())
    }

    /// Searches onset and divergence for the current parameters. A search that fails is no reason to end a run.
    fn refresh_onset(&mut self) -> Answer<()> {
        let card = self
            .onset_card(&self.memory.values)
            .map_err(|e| Refusal::discard(format!("onset search: {e}")))?;
        for (place, variable) in self.resources.table.variables().iter().enumerate() {
            if let Role::Calculated(which) = variable.role {
                self.memory.values[place] = card.value(which);
            }
        }
        self.notices.extend(card.warnings);
        self.onset_current = true;
        Ok(())
    }

    fn onset_card(&self, values: &[f64]) -> Result<OnsetCard> {
        let Resources { model, table, .. } = &self.resources;
        let section = section::coupled_section(model, table, &self.aerodynamics, values)?;
        OnsetCard::search(model, &section, values[self.layout.search_limit])
    }

    /// A copy of everything that changes.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            guid: self.resources.guid,
            memory: self.memory.clone(),
        }
    }

    /// Copies everything that changes into an existing snapshot.
    pub fn snapshot_into(&self, snapshot: &mut Snapshot) {
        snapshot.guid = self.resources.guid;
        snapshot.memory.clone_from(&self.memory);
    }

    /// Goes back to a snapshot.
    ///
    /// # Errors
    /// A snapshot of another model.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Answer<()> {
        self.check_owner(snapshot)?;
        self.replace_memory(snapshot.memory.clone());
        Ok(())
    }

    fn check_owner(&self, snapshot: &Snapshot) -> Answer<()> {
        let own = self.resources.guid;
        if snapshot.guid == own {
            Ok(())
        } else {
            Err(Refusal::error(format!(
                "saved state: expected one of the model {own}, found one of {}",
                snapshot.guid
            )))
        }
    }

    /// Whatever the parameters of both memories share stays computed.
    fn replace_memory(&mut self, mut memory: Memory) {
        let same = |source: Source, a: &[f64], b: &[f64]| {
            (0..a.len())
                .filter(|place| self.layout.source(*place) == source)
                .all(|place| a[place].to_bits() == b[place].to_bits())
        };
        let same_section = same(Source::Section, &memory.values, &self.memory.values);
        let same_limit = same(Source::Limit, &memory.values, &self.memory.values);
        if !same_section {
            self.stepper = None;
        }
        self.onset_current &= same_section && same_limit;
        if self.onset_current {
            for place in 0..memory.values.len() {
                if self.layout.source(place) == Source::Calculated {
                    memory.values[place] = self.memory.values[place];
                }
            }
        }
        self.memory = memory;
        self.release_pending = true;
        self.outputs_current = false;
    }

    /// Length in bytes of a serialised state.
    pub fn serialized_length(&self) -> usize {
        serialized::length(&self.memory)
    }

    /// A snapshot as bytes.
    ///
    /// # Errors
    /// A snapshot of another model.
    pub fn serialize(&self, snapshot: &Snapshot) -> Answer<Vec<u8>> {
        self.check_owner(snapshot)?;
        Ok(serialized::write(&snapshot.memory, &snapshot.guid))
    }

    /// A snapshot from bytes.
    ///
    /// # Errors
    /// Bytes that are no state of this export, or hold a value outside the limits of its variable.
    pub fn deserialize(&self, bytes: &[u8]) -> Answer<Snapshot> {
        let guid = self.resources.guid;
        let mut memory = serialized::read(bytes, &guid, &self.fresh)?;
        for (place, value) in memory.values.iter_mut().enumerate() {
            if self.layout.source(place) == Source::Constant {
                *value = self.fresh.values[place];
            }
            self.layout.check_stored(place, *value, self.table())?;
        }
        Ok(Snapshot { guid, memory })
    }
}

/// Rates are known to the first order.
fn check_order(order: i32) -> Answer<()> {
    if order == 1 {
        Ok(())
    } else {
        Err(Refusal::error(format!(
            "order of the derivative: expected 1, found {order}"
        )))
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
