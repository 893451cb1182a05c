//! Running an FMU to see whether it keeps what it promises.

use super::description::{
    Causality, DefaultExperiment, FILE, Initial, ScalarVariable, Value, VariableType,
};
use super::findings::{FmuFindings, Trial};
use super::library::OwnFunctions;
use super::simulation::{Times, ValueTable, run as step_through, start};
use super::slave::Slave;
use super::{Fmu, log};
use crate::error::{Error, Result, ensure};

/// Most communication steps of a trial.
const MAX_STEPS: usize = 1000;
/// Relative difference up to which a replay counts as the same: solvers of other tools may keep a warm start.
const SAME: f64 = 1e-9;

type TrialFunction = fn(&Plan<'_>) -> Result<String>;

/// Runs every trial that the capability flags allow.
pub(super) fn run(fmu: &Fmu, findings: &mut FmuFindings) -> (Vec<Trial>, Vec<String>) {
    let capabilities = fmu.description.co_simulation.clone().unwrap_or_default();
    let plan = match Plan::new(fmu) {
        Ok(plan) => plan,
        Err(e) => {
            findings.error(FILE, "something to run", e.to_string());
            return (Vec::new(), Vec::new());
        }
    };
    let once = capabilities.can_be_instantiated_only_once_per_process;
    let state = capabilities.can_get_and_set_fmu_state;
    let list: [(&str, bool, TrialFunction); 8] = [
        ("default experiment", true, default_experiment),
        ("reset and replay", !once, reset_and_replay),
        ("two instances side by side", !once, side_by_side),
        ("state saved and restored", state && !once, restored_state),
        (
            "state serialised and read by another instance",
            capabilities.can_serialize_fmu_state && !once,
            serialised_state,
        ),
        (
            "changing communication steps",
            capabilities.can_handle_variable_communication_step_size && !once,
            changing_steps,
        ),
        (
            "directional derivatives",
            capabilities.provides_directional_derivative && !once,
            directional_derivatives,
        ),
        (
            "output derivatives",
            capabilities.max_output_derivative_order > 0 && !once,
            output_derivatives,
        ),
    ];
    if !once
        && fmu
            .instantiate_with_guid("wrong", "{not the guid of this FMU}")
            .is_ok()
    {
        let expected = "another guid to be refused";
        findings.warning("fmi2Instantiate", expected, "an instance");
    }
    let mut trials = vec![trial("platform and version", versions(fmu))];
    for (name, wanted, function) in list {
        if wanted {
            trials.push(trial(name, function(&plan)));
        }
    }
    (trials, plan.messages.take())
}

fn trial(name: &str, outcome: Result<String>) -> Trial {
    let (passed, detail) = match outcome {
        Ok(detail) => (true, detail),
        Err(e) => (false, e.to_string()),
    };
    Trial {
        name: name.to_owned(),
        passed,
        detail,
    }
}

fn versions(fmu: &Fmu) -> Result<String> {
    let loaded = fmu.load()?;
    // SAFETY: both take nothing and answer with a constant C string
    let (platform, version) = unsafe {
        let platform = match &loaded.own {
            OwnFunctions::Two(own) => log::text((own.get_types_platform)()),
            // FMI 3.0 knows no other
            OwnFunctions::Three(_) => "default".to_owned(),
        };
        (platform, log::text((loaded.shared.get_version)()))
    };
    let is_described = match fmu.description.is_fmi3() {
        false => version == "2.0",
        true => version.starts_with("3."),
    };
    let place = "fmi2GetTypesPlatform, fmi2GetVersion, fmi3GetVersion";
    let expected = "`default`, the version of the description";
    let found = format_args!("`{platform}`, `{version}`");
    let holds = platform == "default" && is_described;
    ensure(holds, place, expected, found)?;
    Ok(format!("platform {platform}, version {version}"))
}

/// What all trials share.
struct Plan<'a> {
    fmu: &'a Fmu,
    times: Times,
    /// All outputs that are no texts.
    record: Vec<&'a ScalarVariable>,
    messages: std::cell::RefCell<Vec<String>>,
}

impl<'a> Plan<'a> {
    fn new(fmu: &'a Fmu) -> Result<Self> {
        let d = fmu.model_description();
        let mut times = Times::new(d, DefaultExperiment::default())?;
        if times.steps() > MAX_STEPS {
            times.stop = times.at(MAX_STEPS);
        }
        let is_recorded = |v: &&ScalarVariable| {
            v.causality == Causality::Output && v.kind != VariableType::String
        };
        Ok(Self {
            fmu,
            times,
            record: d.variables.iter().filter(is_recorded).collect(),
            messages: std::cell::RefCell::default(),
        })
    }

    /// A new instance that logs all it has to say.
    fn instance(&self) -> Result<Slave> {
        Slave::new(&self.fmu.load()?, "trial", &self.fmu.description.guid, true)
    }

    fn initialised(&self) -> Result<Slave> {
        let mut slave = self.instance()?;
        start(&mut slave, &self.times, &[])?;
        Ok(slave)
    }

    fn run(&self, slave: &mut Slave) -> Result<ValueTable> {
        let table = self.steps(slave, &self.times);
        self.messages.borrow_mut().extend(slave.take_log());
        table
    }

    fn steps(&self, slave: &mut Slave, times: &Times) -> Result<ValueTable> {
        step_through(slave, times, &self.record, |_, _| Ok(()))
    }

    /// The second half of the run, from `half` on.
    fn half(&self) -> (Times, Times) {
        let half = self.times.steps() / 2;
        let (mut first, mut second) = (self.times, self.times);
        first.stop = self.times.at(half);
        second.start = first.stop;
        (first, second)
    }
}

fn default_experiment(plan: &Plan<'_>) -> Result<String> {
    let mut slave = plan.instance()?;
    check_starts(&mut slave, &plan.times)?;
    slave.exit_initialization()?;
    let table = plan.run(&mut slave)?;
    finite(&table)?;
    slave.terminate()?;
    let (steps, outputs) = (table.rows.len() - 1, plan.record.len());
    let Times { start, step, .. } = plan.times;
    Ok(format!(
        "{steps} steps of {step} s from {start} s, {outputs} outputs finite"
    ))
}

/// Brings a new instance into the initialisation mode, where it must have the start values that its description states.
pub(super) fn check_starts(slave: &mut Slave, times: &Times) -> Result<()> {
    times.initialise(slave)?;
    for v in &slave.model_description().variables {
        if v.causality == Causality::Independent {
            continue;
        }
        let value = slave.get_by_reference(v.kind, v.value_reference)?;
        let is_input = v.causality == Causality::Input;
        let (expected, found) = match &v.start {
            _ if !is_input && v.effective_initial() != Some(Initial::Exact) => continue,
            Some(stated) if same_start(stated, &value) => continue,
            Some(stated) => (format!("its start value {stated}"), value.to_string()),
            None => ("a start value".to_owned(), "none".to_owned()),
        };
        let place = format!("variable `{}` in the initialisation mode", v.name);
        return Err(Error::input(place, expected, found));
    }
    Ok(())
}

/// Start values pass through decimal text.
fn same_start(stated: &Value, found: &Value) -> bool {
    match (stated, found) {
        (Value::Real(a), Value::Real(b)) => (a - b).abs() <= 1e-12 * a.abs().max(b.abs()),
        (a, b) => a == b,
    }
}

fn finite(table: &ValueTable) -> Result<()> {
    for row in &table.rows {
        for (name, value) in table.names.iter().zip(row) {
            let place = format_args!("output `{name}` at {} s", row[0]);
            ensure(value.is_finite(), place, "a finite number", value)?;
        }
    }
    Ok(())
}

/// Says how far two runs agree, or refuses. Times are not compared: the second may start later.
fn compared(what: &str, first: &ValueTable, b: &[Vec<f64>]) -> Result<String> {
    let (mut identical, names, a) = (true, &first.names, &first.rows);
    for (x, y) in a.iter().zip(b) {
        for at in 1..names.len() {
            let (p, q) = (x[at], y[at]);
            identical &= p.to_bits() == q.to_bits();
            let scale = p.abs().max(q.abs()).max(f64::MIN_POSITIVE);
            let same = (p - q).abs() <= SAME * scale || (p - q).is_nan();
            let place = format_args!("{what}, output `{}` at {} s", names[at], x[0]);
            ensure(same, place, format_args!("{p} as before"), q)?;
        }
    }
    let steps = a.len().min(b.len()).saturating_sub(1);
    Ok(match identical {
        true => format!("{steps} steps identical to the last bit"),
        false => format!("{steps} steps equal within {SAME:e}"),
    })
}

fn reset_and_replay(plan: &Plan<'_>) -> Result<String> {
    let mut slave = plan.initialised()?;
    let first = plan.run(&mut slave)?;
    slave.reset()?;
    start(&mut slave, &plan.times, &[])?;
    let second = plan.run(&mut slave)?;
    compared("after fmi2Reset", &first, &second.rows)
}

fn side_by_side(plan: &Plan<'_>) -> Result<String> {
    let alone = plan.run(&mut plan.initialised()?)?;
    let (mut a, mut b) = (plan.initialised()?, plan.initialised()?);
    let (first, second) = plan.half();
    // in turns: halves of one between halves of the other
    let mut rows = plan.steps(&mut a, &first)?.rows;
    let other = plan.run(&mut b)?;
    rows.pop();
    rows.extend(plan.steps(&mut a, &second)?.rows);
    compared("beside another instance", &alone, &rows)?;
    compared("another instance", &alone, &other.rows)
}

fn restored_state(plan: &Plan<'_>) -> Result<String> {
    let mut slave = plan.initialised()?;
    let (first, second) = plan.half();
    plan.steps(&mut slave, &first)?;
    let state = slave.get_state()?;
    let before = plan.steps(&mut slave, &second)?;
    slave.set_state(&state)?;
    let after = plan.steps(&mut slave, &second)?;
    compared("restored state", &before, &after.rows)
}

fn serialised_state(plan: &Plan<'_>) -> Result<String> {
    let mut slave = plan.initialised()?;
    let (first, second) = plan.half();
    plan.steps(&mut slave, &first)?;
    let bytes = slave.serialize_state(&slave.get_state()?)?;
    let before = plan.steps(&mut slave, &second)?;
    let mut other = plan.initialised()?;
    let state = other.deserialize_state(&bytes)?;
    other.set_state(&state)?;
    let after = plan.steps(&mut other, &second)?;
    let agreement = compared("serialised state", &before, &after.rows)?;
    Ok(format!("{} bytes, {agreement}", bytes.len()))
}

fn changing_steps(plan: &Plan<'_>) -> Result<String> {
    let mut slave = plan.initialised()?;
    let mut time = plan.times.start;
    let mut steps = 0;
    for factor in [1.0, 0.5, 0.1, 1.7, 1.0 + 1e-13, 0.3].into_iter().cycle() {
        let step = factor * plan.times.step;
        if time + step > plan.times.stop || steps == MAX_STEPS {
            break;
        }
        slave.whole_step(time, step)?;
        time += step;
        steps += 1;
    }
    for output in &plan.record {
        if let Value::Real(v) = slave.get_by_reference(output.kind, output.value_reference)? {
            let place = format_args!("output `{}`", output.name);
            ensure(v.is_finite(), place, "a finite number", v)?;
        }
    }
    let step = plan.times.step;
    Ok(format!("{steps} steps of 0.1 to 1.7 times {step} s"))
}

fn directional_derivatives(plan: &Plan<'_>) -> Result<String> {
    let slave = plan.initialised()?;
    let d = plan.fmu.model_description();
    let real = |index: usize| {
        d.variable_at(index)
            .filter(|v| v.kind == VariableType::Real)
    };
    let mut tried = 0;
    for unknown in &d.outputs {
        for on in unknown.dependencies.iter().flatten() {
            let (Some(v), Some(known)) = (real(unknown.index), real(*on)) else {
                continue;
            };
            let (of, along) = ([v.value_reference], [known.value_reference]);
            let answer = slave.directional_derivative(&of, &along, &[1.0])?[0];
            let place = format_args!("derivative of `{}` along `{}`", v.name, known.name);
            ensure(answer.is_finite(), place, "a finite number", answer)?;
            tried += 1;
        }
    }
    Ok(format!("{tried} of them finite"))
}

fn output_derivatives(plan: &Plan<'_>) -> Result<String> {
    let mut slave = plan.initialised()?;
    slave.do_step(plan.times.start, plan.times.step)?;
    let reals = plan.record.iter().filter(|v| v.kind == VariableType::Real);
    let references: Vec<u32> = reals.map(|v| v.value_reference).collect();
    for derivative in slave.output_derivatives(&references)? {
        let (place, is_finite) = ("fmi2GetRealOutputDerivatives", derivative.is_finite());
        ensure(is_finite, place, "finite numbers", derivative)?;
    }
    let capabilities = plan.fmu.description.co_simulation.as_ref();
    let order = capabilities.map_or(0, |c| c.max_output_derivative_order);
    let outputs = references.len();
    Ok(format!("{outputs} outputs, highest order {order}"))
}
