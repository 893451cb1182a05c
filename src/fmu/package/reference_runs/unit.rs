//! The unit whose runs are recorded, in this process.

use super::plan::{PlannedRun, ReferenceSet, Stimulus, digits};
use crate::error::{Error, Result};
use crate::fmu::description::number;
use crate::fmu::importer::array_element_name;
use crate::fmu::instance::Instance;
use crate::fmu::refusal::Refusal;
use crate::fmu::vocabulary::{
    Causality, FmiVersion, Groups, OnsetBounds, Resources, Response, Role, StartValue, Variable,
    array_of,
};
use crate::section::{Dof, Translation};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Length of the smoke test and its communication step, s.
const SMOKE_S: f64 = 10.0;
const SMOKE_STEP_S: f64 = 0.1;
/// Periods at the onset that a run of the validation lasts, and communication steps of each.
const PERIODS: f64 = 20.0;
const STEPS_PER_PERIOD: f64 = 8.0;
/// Wind speeds of the validation over the onset.
const LEVELS: [(&str, f64); 3] = [("below", 0.9), ("at", 1.0), ("above", 1.1)];
/// Most inputs that move beside the wind, and most outputs that are recorded: enough to tell one unit from another.
const MAX_STIMULI: usize = 12;
const MAX_RECORDED: usize = 24;
/// Motion that is prescribed, over the width, and rotation.
const AMPLITUDE: f64 = 0.01;
/// Gusts over the mean wind.
const INTENSITY: f64 = 0.05;

/// A unit to be run.
pub(super) struct ReferenceUnit {
    /// As it is before the initialisation.
    instance: RefCell<Instance>,
    variables: Vec<Variable>,
    /// Places of the variables that are listed, with the name of each in the description of its version.
    listed: BTreeMap<usize, String>,
    version: FmiVersion,
    wind_m_s: f64,
    width_m: f64,
    density_kg_m3: f64,
    /// Frequencies in still air of vertical, lateral and torsional motion, Hz.
    frequencies_hz: [f64; 3],
}

impl ReferenceUnit {
    pub(super) fn new(resources: Resources, reals_only: bool, version: FmiVersion) -> Result<Self> {
        let table = &resources.table;
        let groups = Groups::new(table);
        let mut listed = BTreeMap::new();
        for (place, v) in table.variables().iter().enumerate() {
            let real = matches!(v.value, StartValue::Real(_));
            if !v.is_listed || (reals_only && !real) {
                continue;
            }
            let array = array_of(v.role, &v.name).filter(|_| version == FmiVersion::Three);
            let name = array.and_then(|array| {
                let group = &groups.all()[groups.reference_of(place)?];
                let element = group.iter().position(|p| *p as usize == place)?;
                Some(array_element_name(&array, Some(element)))
            });
            listed.insert(place, name.unwrap_or_else(|| v.name.clone()));
        }
        let section = &resources.model.section;
        let translation = |t: &Translation| t.frequency_hz.unwrap_or(1.0);
        Ok(Self {
            variables: table.variables().to_vec(),
            listed,
            version,
            wind_m_s: resources.model.experiment.wind_speed_m_s,
            width_m: section.width_m,
            density_kg_m3: section.air_density_kg_m3,
            frequencies_hz: [
                translation(&section.vertical),
                section.lateral.as_ref().map_or(1.0, translation),
                section.torsion.frequency_hz.unwrap_or(1.0),
            ],
            instance: Instance::new(resources)?.into(),
        })
    }

    fn variables(&self, wanted: impl Fn(&Variable) -> bool) -> impl Iterator<Item = (usize, &str)> {
        let all = self.listed.iter();
        let chosen = all.filter(move |(place, _)| wanted(&self.variables[**place]));
        chosen.map(|(place, name)| (*place, name.as_str()))
    }

    /// Parameters with their start values; of FMI 3.0 those that are no arrays, which a parameter set cannot hold.
    pub(super) fn parameters(&self) -> Vec<(String, f64)> {
        let own = self.variables(|v| {
            let is_array = self.version == FmiVersion::Three && array_of(v.role, &v.name).is_some();
            v.causality == Causality::Parameter && !is_array
        });
        let started = own.filter_map(|(place, name)| match self.variables[place].value {
            StartValue::Real(Some(start)) => Some((name.to_owned(), start)),
            _ => None,
        });
        started.collect()
    }

    fn wind(&self) -> Option<usize> {
        let mut winds = self.variables(|v| v.role == Role::WindSpeed);
        winds.next().map(|(place, _)| place)
    }

    /// What is run: short to see whether it runs at all, and around the onset where there is one.
    pub(super) fn sets(&self, bounds: Option<&OnsetBounds>) -> Result<Vec<ReferenceSet>> {
        let mut sets = vec![ReferenceSet {
            name: "smoke_test",
            role: "experiment/smoke-test",
            title: "Smoke test",
            meaning: "Ten seconds in which everything that comes from outside moves",
            runs: vec![PlannedRun {
                name: "smoke_test".to_owned(),
                meaning: format!("{SMOKE_S} s at about {} m/s", self.wind_m_s),
                step_s: SMOKE_STEP_S,
                steps: (SMOKE_S / SMOKE_STEP_S).round() as usize,
                wind_m_s: self.wind_m_s,
                driven: true,
            }],
        }];
        if self.wind().is_none() {
            return Ok(sets);
        }
        let onset = self.onset();
        let (speed, period, what) = match onset {
            Some((speed, frequency)) => (speed, 1.0 / frequency, "the onset"),
            None => (self.wind_m_s, 1.0, "the wind of the default experiment"),
        };
        let run = |name: &str, meaning: String, wind_m_s: f64| PlannedRun {
            name: name.to_owned(),
            meaning,
            step_s: digits(period / STEPS_PER_PERIOD, 2),
            steps: (PERIODS * STEPS_PER_PERIOD) as usize,
            wind_m_s,
            driven: onset.is_none(),
        };
        let levels = LEVELS.map(|(level, factor)| {
            let wind = digits(factor * speed, 4);
            run(level, format!("{factor} of {what}, {wind} m/s"), wind)
        });
        sets.push(ReferenceSet {
            name: "validation",
            role: "experiment/validation",
            title: "Below, at and above the onset",
            meaning: "Motion that decays, stays and grows; without an onset, three wind speeds",
            runs: levels.into(),
        });
        if let Some(bounds) = bounds {
            let ends = [
                ("onset_low", bounds.low_m_s),
                ("onset_high", bounds.high_m_s),
            ];
            let end = |(name, speed): (&str, f64)| {
                run(
                    name,
                    format!("The end of the interval at {speed} m/s"),
                    speed,
                )
            };
            sets.push(ReferenceSet {
                name: "uncertainty",
                role: "experiment/uncertainty-analysis",
                title: "Ends of the interval of the onset",
                meaning: "Wind at both ends of the 95 % interval that the scatter of the data leaves for the onset",
                runs: ends.map(end).into(),
            });
        }
        Ok(sets)
    }

    /// Speed and frequency of the onset with the parameters as they are, where there is one.
    fn onset(&self) -> Option<(f64, f64)> {
        let place = |name: &str| {
            let place = self.variables.iter().position(|v| v.name == name)?;
            u32::try_from(place).ok()
        };
        let references = [place("onset_speed")?, place("onset_frequency")?];
        let found = place("onset_found")?;
        let mut instance = self.instance.borrow_mut();
        let mut values = [0.0; 2];
        let mut read = || -> std::result::Result<bool, Refusal> {
            instance.set_up_experiment(0.0, None)?;
            instance.enter_initialization();
            instance.exit_initialization()?;
            instance.reals(&references, &mut values)?;
            instance.boolean(found)
        };
        let is_found = read();
        instance.reset();
        let [speed, frequency] = values;
        let known = matches!(is_found, Ok(true)) && speed > 0.0 && frequency > 0.0;
        known.then_some((speed, frequency))
    }

    /// Inputs and outputs of the run as text, or nothing where the unit refuses a step of it.
    pub(super) fn run(&self, planned: &PlannedRun) -> Result<Option<[String; 2]>> {
        let inputs = self.stimuli(planned);
        let recorded = self.recorded();
        let mut instance = self.instance.borrow_mut();
        instance.reset();
        let done = recorded_run(&mut instance, planned, &inputs, &recorded);
        instance.reset();
        let Ok([set, read]) = done else {
            return Ok(None);
        };
        let named = |places: &mut dyn Iterator<Item = usize>| -> Vec<&str> {
            places.map(|place| self.listed[&place].as_str()).collect()
        };
        Ok(Some([
            csv(&named(&mut inputs.iter().map(|s| s.place)), &set)?,
            csv(&named(&mut recorded.iter().copied()), &read)?,
        ]))
    }

    /// Motion and forces, the same share of each kind, and the onset.
    fn recorded(&self) -> Vec<usize> {
        let moving = |v: &Variable| {
            v.causality == Causality::Output
                && match v.role {
                    Role::Computed(_) => v.name == "flutter_speed",
                    _ => matches!(v.value, StartValue::Real(_)),
                }
        };
        let all: Vec<usize> = self.variables(moving).map(|(place, _)| place).collect();
        let every = all.len().div_ceil(MAX_RECORDED).max(1);
        all.into_iter().step_by(every).collect()
    }

    fn stimuli(&self, planned: &PlannedRun) -> Vec<Stimulus> {
        let wind = self.wind().map(|place| Stimulus {
            place,
            mean: planned.wind_m_s,
            amplitude: match planned.driven {
                true => 0.02 * planned.wind_m_s,
                false => 0.0,
            },
            frequency_hz: 0.3,
            phase: 0.0,
        });
        let others =
            self.variables(|v| v.causality == Causality::Input && v.role != Role::WindSpeed);
        let others = others.filter_map(|(place, _)| self.stimulus(place, planned));
        let mut others: Vec<Stimulus> = match planned.driven {
            true => others.collect(),
            false => Vec::new(),
        };
        // whole strips: of FMI 3 each is an element of arrays, which are set as a whole
        let strip_of = |s: &Stimulus| match self.variables[s.place].role {
            Role::Motion(s, ..) | Role::Gust(s, _) | Role::NodeForce(s, _) => Some(s),
            _ => None,
        };
        if let Some(first_out) = others.get(MAX_STIMULI).map(strip_of) {
            others.truncate(MAX_STIMULI);
            others.retain(|s| first_out.is_none() || strip_of(s) != first_out);
        }
        wind.into_iter().chain(others).collect()
    }

    /// How one input moves: motions with the rates that belong to them, forces and gusts each with a phase of its own.
    fn stimulus(&self, place: usize, planned: &PlannedRun) -> Option<Stimulus> {
        let (width, wind) = (self.width_m, planned.wind_m_s);
        let force = |dof: Dof| {
            let arm = if dof == Dof::Torsion { width } else { 1.0 };
            AMPLITUDE * 0.5 * self.density_kg_m3 * wind * wind * width * arm
        };
        let at = |frequency_hz: f64, amplitude: f64, phase: f64| Stimulus {
            place,
            mean: 0.0,
            amplitude,
            frequency_hz,
            phase,
        };
        Some(match self.variables[place].role {
            Role::ExternalForce(dof) => at(0.7, force(dof), place as f64),
            Role::NodeForce(_, dof) => at(0.7, force(dof), place as f64),
            Role::Gust(..) => at(0.4, INTENSITY * wind, place as f64),
            Role::Motion(strip, of, dof) => {
                let (which, amplitude) = match dof {
                    Dof::Vertical => (0, AMPLITUDE * width),
                    Dof::Lateral => (1, AMPLITUDE * width),
                    Dof::Torsion => (2, AMPLITUDE),
                };
                let (frequency, phase) = (self.frequencies_hz[which], strip as f64);
                let omega = TAU * frequency;
                match of {
                    Response::Displacement => at(frequency, amplitude, phase),
                    Response::Rate => at(frequency, omega * amplitude, phase + 0.25 * TAU),
                    _ => at(frequency, omega * omega * amplitude, phase + 0.5 * TAU),
                }
            }
            _ => return None,
        })
    }
}

/// Time and values at every communication point, of the inputs and of the outputs.
fn recorded_run(
    instance: &mut Instance,
    planned: &PlannedRun,
    inputs: &[Stimulus],
    recorded: &[usize],
) -> std::result::Result<[Vec<Vec<f64>>; 2], Refusal> {
    let references = |places: &mut dyn Iterator<Item = usize>| -> Vec<u32> {
        places.filter_map(|p| u32::try_from(p).ok()).collect()
    };
    let of_inputs = references(&mut inputs.iter().map(|s| s.place));
    let of_outputs = references(&mut recorded.iter().copied());
    let (mut set, mut read) = (Vec::new(), Vec::new());
    let with_time = |time: f64, values: Vec<f64>| [vec![time], values].concat();
    let mut now = |instance: &mut Instance, time: f64| -> std::result::Result<(), Refusal> {
        let mut values = vec![0.0; of_outputs.len()];
        instance.reals(&of_outputs, &mut values)?;
        read.push(with_time(time, values));
        Ok(())
    };
    let driven = |time: f64| -> Vec<f64> { inputs.iter().map(|s| s.at(time)).collect() };
    instance.set_up_experiment(0.0, Some(planned.stop_s()))?;
    instance.enter_initialization();
    instance.set_reals(&of_inputs, &driven(0.0))?;
    instance.exit_initialization()?;
    now(instance, 0.0)?;
    for step in 0..planned.steps {
        let [from, to] = [step, step + 1].map(|step| step as f64 * planned.step_s);
        let values = driven(from);
        instance.set_reals(&of_inputs, &values)?;
        set.push(with_time(from, values));
        instance.do_step(from, planned.step_s)?;
        now(instance, to)?;
    }
    set.push(with_time(planned.stop_s(), driven(planned.stop_s())));
    Ok([set, read])
}

/// Comma, quoted names, shortest decimals that give the same numbers back.
fn csv(names: &[&str], rows: &[Vec<f64>]) -> Result<String> {
    let mut text = String::from("\"time\"");
    for name in names {
        let _ = write!(text, ",\"{name}\"");
    }
    text.push('\n');
    for row in rows {
        let numbers = row.iter().map(|x| number(*x)).collect::<Result<Vec<_>>>();
        let grew = |_| Error::Numerical("a run that grew without end".into());
        text += &numbers.map_err(grew)?.join(",");
        text.push('\n');
    }
    Ok(text)
}
