//! Everything that changes in an instance.

use crate::lifecycle::State;
use crate::resources::Resources;
use crate::response::SectionState;
use crate::variables::{StartValue, VariableTable};
use uuid::Uuid;

/// What the methods of a unit work on.
#[derive(Debug)]
pub(crate) struct Now {
    pub resources: Resources,
    pub memory: Memory,
    /// Remarks that have come up since they were last asked for.
    pub notices: Vec<String>,
}

/// A saved state is a clone of this, a reset the clone of the first one.
#[derive(Debug, Clone, PartialEq)]
pub struct Memory {
    /// Identity of the export whose memory it is.
    pub(super) guid: Uuid,
    pub(super) state: State,
    /// Start and stop of the run, s, set by the set-up of the experiment.
    pub(super) experiment: Option<(f64, Option<f64>)>,
    /// Point of time of `system`, s.
    pub(super) time: f64,
    /// One number per variable, as in [`starts`].
    pub(super) values: Vec<f64>,
    /// Rates of the inputs: wind speed, then the others.
    pub(super) input_rates: Vec<f64>,
    /// State of what is simulated.
    pub(super) system: SectionState,
}

impl Memory {
    /// The start values of the variables, with so many inputs and what is simulated in the state `system`.
    pub(super) fn new(resources: &Resources, inputs: usize, system: SectionState) -> Self {
        Self {
            guid: resources.guid,
            state: State::Instantiated,
            experiment: None,
            time: 0.0,
            values: starts(&resources.table),
            input_rates: vec![0.0; inputs],
            system,
        }
    }
}

/// Start value of each variable; truth values are 0 and 1, texts 0.
pub(super) fn starts(table: &VariableTable) -> Vec<f64> {
    let start = |value: &StartValue| match value {
        StartValue::Real(start) => start.unwrap_or(0.0),
        StartValue::Integer(start) => f64::from(start.unwrap_or(0)),
        StartValue::Boolean(start) => f64::from(u8::from(start.unwrap_or(false))),
        StartValue::String(_) => 0.0,
    };
    table.variables().iter().map(|v| start(&v.value)).collect()
}
