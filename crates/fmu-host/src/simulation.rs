//! Running an FMU from start to stop: a table of its variables.

use super::Fmu;
use super::description::{Causality, ModelDescription, Value, VariableType};
use super::slave::{Slave, find};
use crate::error::{Error, Result, ensure};
use serde::Serialize;

/// What to run. The default is the FMU's default experiment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Simulation {
    /// Start, s.
    pub start_s: Option<f64>,
    /// Stop, s.
    pub stop_s: Option<f64>,
    /// Communication step, s.
    pub step_s: Option<f64>,
    /// Values of parameters and inputs, by name.
    pub values: Vec<(String, Value)>,
    /// Variables to record; all outputs when empty.
    pub record: Vec<String>,
}

/// Recorded variables: Reals, and the rest as numbers (false 0, true 1).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ValueTable {
    /// `time`, then the variables.
    pub names: Vec<String>,
    /// One row a communication point, the start included.
    pub rows: Vec<Vec<f64>>,
}

impl ValueTable {
    /// The values of one variable.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let at = self.names.iter().position(|n| n == name)?;
        Some(self.rows.iter().map(|r| r[at]).collect())
    }
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
    pub(super) fn new(d: &ModelDescription, s: &Simulation) -> Result<Self> {
        let e = &d.default_experiment;
        let start = s.start_s.or(e.start_time).unwrap_or(0.0);
        let stop = s.stop_s.or(e.stop_time).unwrap_or(start + 1.0);
        let step = s.step_s.or(e.step_size).unwrap_or((stop - start) / 500.0);
        let rises = start.is_finite() && stop.is_finite() && stop > start;
        let found = format_args!("{start} s to {stop} s");
        ensure(rises, "simulation", "a stop after the start", found)?;
        crate::error::positive("communication step", step)?;
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
}

/// Runs the FMU in a new instance.
///
/// # Errors
/// [`Error::Input`] for names that are not there, values that cannot be set and times that make no sense; the
/// errors of [`Fmu::instantiate`] and of [`Slave`]; [`Error::Numerical`] when a step is discarded.
pub fn simulate(fmu: &Fmu, simulation: &Simulation) -> Result<ValueTable> {
    let description = fmu.model_description();
    let times = Times::new(description, simulation)?;
    let record = recorded(description, simulation)?;
    let mut slave = fmu.instantiate(&description.model_name)?;
    start(&mut slave, &times, &simulation.values)?;
    let table = run(&mut slave, &times, &record, |_, _| Ok(()))?;
    slave.terminate()?;
    Ok(table)
}

/// Names and references of what is recorded.
pub(super) fn recorded(
    d: &ModelDescription,
    simulation: &Simulation,
) -> Result<Vec<(String, VariableType, u32)>> {
    let chosen = if simulation.record.is_empty() {
        d.variables
            .iter()
            .filter(|v| v.causality == Causality::Output && v.kind != VariableType::String)
            .collect()
    } else {
        let named = simulation.record.iter().map(|n| find(d, n));
        named.collect::<Result<Vec<_>>>()?
    };
    chosen
        .into_iter()
        .map(|v| match v.kind {
            VariableType::String => Err(Error::input(
                format!("variable `{}`", v.name),
                "a number or a truth value",
                "a string",
            )),
            kind => Ok((v.name.clone(), kind, v.value_reference)),
        })
        .collect()
}

/// Sets values and initialises: parameters and start values before the initialisation, inputs in it.
pub(super) fn start(slave: &mut Slave, times: &Times, values: &[(String, Value)]) -> Result<()> {
    let is_input = |slave: &Slave, name: &str| {
        find(slave.model_description(), name).map(|v| v.causality == Causality::Input)
    };
    for (name, value) in values {
        let variable = find(slave.model_description(), name)?;
        ensure(
            variable.settable(),
            format_args!("variable `{name}`"),
            "one that can be set",
            format!("{:?} {:?}", variable.causality, variable.variability).to_lowercase(),
        )?;
        if !is_input(slave, name)? {
            slave.set(name, value)?;
        }
    }
    let tolerance = slave.model_description().default_experiment.tolerance;
    slave.setup(times.start, Some(times.stop), tolerance)?;
    slave.enter_initialization()?;
    for (name, value) in values {
        if is_input(slave, name)? {
            slave.set(name, value)?;
        }
    }
    slave.exit_initialization()
}

/// Steps from start to stop; `before` is called with the time before each step, to set inputs.
pub(super) fn run(
    slave: &mut Slave,
    times: &Times,
    record: &[(String, VariableType, u32)],
    mut before: impl FnMut(&mut Slave, f64) -> Result<()>,
) -> Result<ValueTable> {
    let mut names = vec!["time".to_owned()];
    names.extend(record.iter().map(|(n, ..)| n.clone()));
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

fn row(slave: &Slave, time: f64, record: &[(String, VariableType, u32)]) -> Result<Vec<f64>> {
    let mut row = vec![time];
    if record
        .iter()
        .all(|(_, kind, _)| *kind == VariableType::Real)
    {
        let references: Vec<u32> = record.iter().map(|(.., r)| *r).collect();
        row.extend(slave.get_real(&references)?);
        return Ok(row);
    }
    for (_, kind, reference) in record {
        row.push(match slave.get_by_reference(*kind, *reference)? {
            Value::Real(v) => v,
            Value::Integer(v) => f64::from(v),
            Value::Boolean(v) => f64::from(u8::from(v)),
            Value::String(_) => f64::NAN,
        });
    }
    Ok(row)
}
