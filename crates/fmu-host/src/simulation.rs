//! Running an FMU from start to stop: a table of its variables.

use super::description::{
    Causality, DefaultExperiment, ModelDescription, ScalarVariable, Value, VariableType,
};
use super::slave::{Slave, find};
use crate::error::{Result, ensure, positive};

/// Recorded variables: Reals, and the rest as numbers (false 0, true 1).
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ValueTable {
    /// `time`, then the variables.
    pub names: Vec<String>,
    /// One row a communication point, the start included.
    pub rows: Vec<Vec<f64>>,
}

/// Start, stop and step in s, checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Times {
    pub start: f64,
    pub stop: f64,
    pub step: f64,
}

impl Times {
    /// As stated, else from the default experiment, else from 0 to 1 s in 500 steps.
    pub(super) fn new(d: &ModelDescription, stated: DefaultExperiment) -> Result<Self> {
        let e = &d.default_experiment;
        let start = stated.start_time.or(e.start_time).unwrap_or(0.0);
        let stop = stated.stop_time.or(e.stop_time).unwrap_or(start + 1.0);
        let step = stated.step_size.or(e.step_size);
        let step = step.unwrap_or((stop - start) / 500.0);
        let rises = start.is_finite() && stop.is_finite() && stop > start;
        let found = format_args!("{start} s to {stop} s");
        ensure(rises, "simulation", "a stop after the start", found)?;
        positive("communication step", step)?;
        Ok(Self { start, stop, step })
    }

    /// Number of whole steps; a last partial one is left out, since not every FMU can take it.
    pub(super) fn steps(&self) -> usize {
        ((self.stop - self.start) / self.step * (1.0 + 1e-12)).floor() as usize
    }

    /// Time of a communication point, from its number and so without adding up rounding errors, s.
    pub(super) fn at(&self, point: usize) -> f64 {
        self.start + point as f64 * self.step
    }

    /// Brings an instance into the initialisation mode.
    pub(super) fn initialise(&self, slave: &mut Slave) -> Result<()> {
        let tolerance = slave.model_description().default_experiment.tolerance;
        slave.enter_initialization(self.start, Some(self.stop), tolerance)
    }
}

/// Sets values and initialises: parameters and start values before the initialisation, inputs in it.
pub(super) fn start(slave: &mut Slave, times: &Times, values: &[(String, Value)]) -> Result<()> {
    let mut inputs = Vec::new();
    for (name, value) in values {
        let variable = find(slave.model_description(), name)?;
        let place = format_args!("variable `{name}`");
        let found = format!("{:?} {:?}", variable.causality, variable.variability);
        let expected = "one that can be set";
        ensure(variable.settable(), place, expected, found.to_lowercase())?;
        match variable.causality {
            Causality::Input => inputs.push((name, value)),
            _ => slave.set(name, value)?,
        }
    }
    times.initialise(slave)?;
    for (name, value) in inputs {
        slave.set(name, value)?;
    }
    slave.exit_initialization()
}

/// Steps from start to stop; `before` is called with the time before each step, to set inputs.
pub(super) fn run(
    slave: &mut Slave,
    times: &Times,
    record: &[&ScalarVariable],
    mut before: impl FnMut(&mut Slave, f64) -> Result<()>,
) -> Result<ValueTable> {
    let mut names = vec!["time".to_owned()];
    names.extend(record.iter().map(|v| v.name.clone()));
    let mut rows = vec![row(slave, times.at(0), record)?];
    for point in 0..times.steps() {
        let (from, to) = (times.at(point), times.at(point + 1));
        before(slave, from)?;
        // the constant step rather than the difference of two rounded times: it may not vary in the last bits
        slave.whole_step(from, times.step)?;
        rows.push(row(slave, to, record)?);
    }
    Ok(ValueTable { names, rows })
}

fn row(slave: &Slave, time: f64, record: &[&ScalarVariable]) -> Result<Vec<f64>> {
    let mut row = vec![time];
    if record.iter().all(|v| v.kind == VariableType::Real) {
        let references: Vec<u32> = record.iter().map(|v| v.value_reference).collect();
        row.extend(slave.get_real(&references)?);
        return Ok(row);
    }
    for v in record {
        row.push(match slave.get_by_reference(v.kind, v.value_reference)? {
            Value::Real(v) => v,
            Value::Integer(v) => f64::from(v),
            Value::Boolean(v) => f64::from(u8::from(v)),
            Value::String(_) => f64::NAN,
        });
    }
    Ok(row)
}
