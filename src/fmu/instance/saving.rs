//! Everything that changes in an instance, and snapshots of it: plain clones, and the same as bytes.

use super::layout::Source;
use super::unit::Unit;
use super::{Instance, serialized};
use crate::fmu::lifecycle::State;
use crate::fmu::refusal::{Answer, Refusal};
use crate::fmu::variables::{Value, VariableTable};
use crate::response::SectionState;
use uuid::Uuid;

/// Times of a run, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Experiment {
    pub start: f64,
    pub stop: Option<f64>,
}

/// A snapshot is a clone of this, a reset the clone of the first one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Memory {
    pub state: State,
    /// Set by the set-up of the experiment.
    pub experiment: Option<Experiment>,
    /// Point of time of `system`, s.
    pub time: f64,
    /// One number per variable, as in [`starts`].
    pub values: Vec<f64>,
    /// Rates of the inputs: wind speed, then the others.
    pub input_rates: Vec<f64>,
    /// State of what is simulated.
    pub system: SectionState,
}

impl Memory {
    /// The start values of the table, at rest.
    pub fn new(table: &VariableTable, unit: &dyn Unit) -> Self {
        Self {
            state: State::Instantiated,
            experiment: None,
            time: 0.0,
            values: starts(table),
            input_rates: vec![0.0; unit.inputs().len()],
            system: unit.at_rest(),
        }
    }
}

/// Start value of each variable; truth values are 0 and 1, texts 0.
pub(super) fn starts(table: &VariableTable) -> Vec<f64> {
    let start = |value: &Value| match value {
        Value::Real(start) => start.unwrap_or(0.0),
        Value::Integer(start) => f64::from(start.unwrap_or(0)),
        Value::Boolean(start) => f64::from(u8::from(start.unwrap_or(false))),
        Value::String(_) => 0.0,
    };
    table.variables().iter().map(|v| start(&v.value)).collect()
}

/// A saved state of an instance.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    guid: Uuid,
    memory: Memory,
}

impl Instance {
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

    pub(super) fn check_owner(&self, snapshot: &Snapshot) -> Answer<()> {
        let own = self.resources.guid;
        if snapshot.guid != own {
            return Err(Refusal::error(format!(
                "saved state: expected one of the model {own}, found one of {}",
                snapshot.guid
            )));
        }
        let of = snapshot.memory.state.interface();
        match of.filter(|of| *of != self.interface) {
            None => Ok(()),
            Some(of) => Err(Refusal::error(format!(
                "saved state: expected one of {}, found one of {}",
                self.interface.name(),
                of.name()
            ))),
        }
    }

    /// Whatever the parameters of both memories share stays computed.
    pub(super) fn replace_memory(&mut self, mut memory: Memory) {
        let (layout, old) = (&self.layout, &self.memory);
        let same = |source: Source| {
            let places = (0..old.values.len()).filter(|place| layout.source(*place) == source);
            let bits = |values: &[f64], place: usize| values[place].to_bits();
            places
                .into_iter()
                .all(|p| bits(&old.values, p) == bits(&memory.values, p))
        };
        let (section, limit) = (same(Source::Section), same(Source::Limit));
        let same = |source: Source| match source {
            Source::Section => section,
            _ => limit,
        };
        self.unit.replace(&mut memory, old, &same);
        self.memory = memory;
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
        let mut memory = serialized::read(bytes, &guid, &self.fresh)
            .map_err(|e| Refusal::call(e.to_string()))?;
        for (place, value) in memory.values.iter_mut().enumerate() {
            if self.layout.source(place) == Source::Constant {
                *value = self.fresh.values[place];
            }
            self.check_stored(place, *value)?;
        }
        Ok(Snapshot { guid, memory })
    }
}
