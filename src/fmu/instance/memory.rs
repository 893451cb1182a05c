//! Everything of an instance that a saved state holds and a reset restores.

use super::layout::Layout;
use crate::fmu::lifecycle::State;
use crate::fmu::variables::{Value, VariableTable};
use crate::response::SectionState;

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
    /// Point of time of `section`, s.
    pub time: f64,
    /// One number a variable; truth values are 0 and 1, texts 0.
    pub values: Vec<f64>,
    /// Rates of the inputs: wind speed, then the external forces.
    pub input_rates: Vec<f64>,
    pub section: SectionState,
}

impl Memory {
    /// The start values of the table, at rest.
    pub fn new(table: &VariableTable, layout: &Layout, states: usize) -> Self {
        let start = |value: &Value| match value {
            Value::Real(start) => start.unwrap_or(0.0),
            Value::Integer(start) => f64::from(start.unwrap_or(0)),
            Value::Boolean(start) => f64::from(u8::from(start.unwrap_or(false))),
            Value::String(_) => 0.0,
        };
        Self {
            state: State::Instantiated,
            experiment: None,
            time: 0.0,
            values: table.variables().iter().map(|v| start(&v.value)).collect(),
            input_rates: vec![0.0; 1 + layout.force.len()],
            section: SectionState {
                values: vec![0.0; states],
                phase: 0.0,
            },
        }
    }
}
