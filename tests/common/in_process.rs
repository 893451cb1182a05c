//! What an exported model must give, computed in process: onset by eigenvalues, trajectories to the last bit.

use aerodeck::aerodynamics::{Realizable, Transfer};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::flutter::{OnsetSearch, divergence_speed, find_onset, trace_modes};
use aerodeck::response::{Inputs, Outputs, SectionState, Stepper};
use aerodeck::section::SectionModel;
use aerodeck::trained_model::TrainedModel;
use aerodeck::units::ReducedFrequency;
use serde_json::{Map, Value, json};
use std::path::Path;

/// Names of the outputs in the order of [`SteppedSection::outputs`].
const OUTPUTS: [&str; 8] = [
    "heave",
    "heave_rate",
    "heave_acceleration",
    "lift",
    "rotation",
    "rotation_rate",
    "rotation_acceleration",
    "moment",
];
const INPUTS: [&str; 3] = ["wind_speed", "external_lift", "external_moment"];

/// Everything that the suite compares with; `golden` is the committed description of the model, where there is one.
pub fn expectations(model: &TrainedModel, golden: Option<&Path>) -> Value {
    let coupled = couple(model, &model.section);
    let search = find_onset(
        model.model.kind(),
        &coupled,
        &OnsetSearch {
            speed_max_m_s: 50.0,
            ..OnsetSearch::default()
        },
        Some(model.tested_range),
    );
    let search = search.unwrap();
    let onset = search.onset().unwrap();
    json!({
        "description": golden,
        "onset": { "speed_m_s": onset.at.speed_m_s, "frequency_hz": onset.at.frequency_hz },
        "default_mode": least_damped_mode(&coupled, model.experiment.wind_speed_m_s),
        "tuned": [
            tuned(model, &[]),
            tuned(model, &[("mass", 18.0), ("air_density", 1.25)]),
            tuned(model, &[("torsion_frequency", 4.0), ("torsion_damping_ratio", 0.01)]),
            tuned(model, &[("width", 0.55), ("inertia", 0.7), ("heave_frequency", 2.2), ("heave_damping_ratio", 0.02)]),
        ],
        "trajectories": [released(model), driven(model), retuned(model)],
    })
}

fn couple(model: &TrainedModel, section: &SectionModel) -> CoupledSection {
    CoupledSection::new(section.structure().unwrap(), model.model.realize()).unwrap()
}

/// Growth rate and frequency of the structural mode that decays slowest at a wind speed.
fn least_damped_mode(section: &CoupledSection, speed_m_s: f64) -> Value {
    let curves = trace_modes("", section, &[speed_m_s]).unwrap();
    let slowest = curves
        .branches
        .iter()
        .filter_map(|branch| branch.points.last())
        .max_by(|a, b| a.eigenvalue.re.total_cmp(&b.eigenvalue.re))
        .unwrap();
    json!({ "growth_1_s": slowest.eigenvalue.re, "frequency_hz": slowest.frequency_hz })
}

fn set_parameter(section: &mut SectionModel, name: &str, value: f64) {
    let place = match name {
        "width" => &mut section.width_m,
        "air_density" => &mut section.air_density_kg_m3,
        "mass" => &mut section.vertical.mass_kg_m,
        "heave_frequency" => section.vertical.frequency_hz.as_mut().unwrap(),
        "heave_damping_ratio" => &mut section.vertical.damping_ratio,
        "inertia" => &mut section.torsion.inertia_kg_m2_m,
        "torsion_frequency" => section.torsion.frequency_hz.as_mut().unwrap(),
        "torsion_damping_ratio" => &mut section.torsion.damping_ratio,
        other => panic!("no parameter `{other}`"),
    };
    *place = value;
}

/// Onset and divergence with other parameters.
fn tuned(model: &TrainedModel, parameters: &[(&str, f64)]) -> Value {
    let mut section = model.section.clone();
    for (name, value) in parameters {
        set_parameter(&mut section, name, *value);
    }
    let coupled = couple(model, &section);
    let limit = model.experiment.onset_search_limit_m_s;
    let search = OnsetSearch {
        speed_max_m_s: limit,
        ..OnsetSearch::default()
    };
    let found = find_onset("", &coupled, &search, Some(model.tested_range)).unwrap();
    let onset = found.onset();
    let steady = model
        .model
        .transfer(ReducedFrequency::from_full_width(0.0))
        .unwrap();
    let divergence = divergence_speed(coupled.structure(), &steady).unwrap();
    let divergence = divergence.filter(|speed| *speed <= limit);
    json!({
        "parameters": parameters.iter().map(|(n, v)| ((*n).to_owned(), json!(v))).collect::<Map<_, _>>(),
        "calculated": {
            "onset_speed": onset.map_or(limit, |o| o.at.speed_m_s),
            "onset_frequency": onset.map_or(0.0, |o| o.at.frequency_hz),
            "onset_reduced_velocity": onset.map_or(0.0, |o| o.at.reduced_velocity.v_star()),
            "divergence_speed": divergence.unwrap_or(limit),
            "onset_found": onset.is_some(),
            "onset_in_tested_range": onset.is_some_and(|o| o.in_tested_range == Some(true)),
            "divergence_found": divergence.is_some(),
        },
    })
}

/// A double as the sixteen hexadecimal digits of its bits.
fn bits(value: f64) -> Value {
    Value::String(format!("{:016x}", value.to_bits()))
}

fn named(values: &[(&str, f64)]) -> Value {
    values
        .iter()
        .map(|(name, value)| ((*name).to_owned(), bits(*value)))
        .collect::<Map<_, _>>()
        .into()
}

/// A run in process, written down call by call as an importer would make it.
struct SteppedSection<'a> {
    model: &'a TrainedModel,
    section: SectionModel,
    stepper: Stepper,
    state: SectionState,
    inputs: Inputs,
    time: f64,
    steps: Vec<Value>,
}

impl<'a> SteppedSection<'a> {
    fn new(model: &'a TrainedModel) -> Self {
        let stepper = Stepper::new(couple(model, &model.section));
        let e = &model.experiment;
        let release = [e.initial_vertical_m, e.initial_rotation_rad];
        let state = stepper.released(&release, &[0.0; 2]).unwrap();
        Self {
            model,
            section: model.section.clone(),
            stepper,
            state,
            inputs: Inputs::steady(e.wind_speed_m_s, 2),
            time: 0.0,
            steps: Vec::new(),
        }
    }

    fn outputs(&mut self) -> Value {
        let mut out = Outputs::default();
        self.stepper
            .outputs(&self.state, &self.inputs, &mut out)
            .unwrap();
        (0..2)
            .flat_map(|i| {
                [
                    out.displacement[i],
                    out.rate[i],
                    out.acceleration[i],
                    out.self_excited_force[i],
                ]
            })
            .map(bits)
            .collect()
    }

    fn input(&mut self, name: &str) -> (&mut f64, &mut f64) {
        let inputs = &mut self.inputs;
        match INPUTS.iter().position(|input| *input == name) {
            Some(0) => (&mut inputs.wind_speed_m_s, &mut inputs.wind_speed_rate_m_s2),
            Some(i) => (&mut inputs.force[i - 1], &mut inputs.force_rate[i - 1]),
            None => panic!("no input `{name}`"),
        }
    }

    /// Sets values, then rates of inputs, which stay until set anew, then steps.
    fn step(&mut self, values: &[(&str, f64)], rates: &[(&str, f64)], size: f64) {
        for (name, value) in values {
            if INPUTS.contains(name) {
                *self.input(name).0 = *value;
            } else {
                set_parameter(&mut self.section, name, *value);
                self.stepper = Stepper::new(couple(self.model, &self.section));
            }
        }
        for (name, value) in rates {
            *self.input(name).1 = *value;
        }
        self.stepper
            .advance(&mut self.state, &self.inputs, size)
            .unwrap();
        for name in INPUTS {
            let (value, rate) = self.input(name);
            *value += *rate * size;
        }
        let time = bits(self.time);
        self.time += size;
        let outputs = self.outputs();
        self.steps.push(json!({
            "time": time, "size": bits(size), "set": named(values), "rates": named(rates), "outputs": outputs,
        }));
    }

    fn written(self, name: &str) -> Value {
        let initial = SteppedSection::new(self.model).outputs();
        json!({
            "name": name, "outputs": OUTPUTS, "initial_outputs": initial, "steps": self.steps,
        })
    }
}

/// The default experiment.
fn released(model: &TrainedModel) -> Value {
    let mut run = SteppedSection::new(model);
    for _ in 0..1000 {
        run.step(&[], &[], 0.01);
    }
    run.written("released")
}

/// Steps of many sizes, wind and forces that jump and ramp.
fn driven(model: &TrainedModel) -> Value {
    let mut run = SteppedSection::new(model);
    for n in 0..300 {
        let size = [0.01, 0.003_7, 0.02, 0.01, 0.010_000_000_000_000_002][n % 5];
        let phase = n as f64 * 0.05;
        let lift = 3.0 * phase.sin();
        let moment = 0.2 * phase.cos();
        match n % 3 {
            0 => run.step(
                &[("wind_speed", 20.0 + lift), ("external_lift", lift)],
                &[("wind_speed", 4.0 * moment), ("external_lift", 1.5)],
                size,
            ),
            1 => run.step(
                &[("wind_speed", 25.0), ("external_moment", moment)],
                &[],
                size,
            ),
            _ => run.step(&[], &[("external_moment", -0.3)], size),
        }
    }
    run.written("driven")
}

/// Parameters changed between steps.
fn retuned(model: &TrainedModel) -> Value {
    let mut run = SteppedSection::new(model);
    for n in 0..200 {
        match n {
            50 => run.step(&[("mass", 17.0), ("torsion_frequency", 4.5)], &[], 0.01),
            90 => run.step(&[("width", 0.52), ("air_density", 1.25)], &[], 0.01),
            130 => run.step(
                &[("heave_damping_ratio", 0.02), ("wind_speed", 33.0)],
                &[],
                0.01,
            ),
            _ => run.step(&[], &[], 0.01),
        }
    }
    run.written("retuned")
}

/// A section with a lateral support, released and pushed sideways, and its onset.
#[allow(dead_code)] // not every test has such a model
pub fn three_dof(model: &TrainedModel) -> Value {
    let coupled = couple(model, &model.section);
    let search = OnsetSearch {
        speed_max_m_s: model.experiment.onset_search_limit_m_s,
        ..OnsetSearch::default()
    };
    let found = find_onset("", &coupled, &search, Some(model.tested_range)).unwrap();
    let onset = found.onset().unwrap();
    let onset = json!({ "speed_m_s": onset.at.speed_m_s, "frequency_hz": onset.at.frequency_hz });
    let mut stepper = Stepper::new(coupled);
    let e = &model.experiment;
    let release = [e.initial_vertical_m, 0.0, e.initial_rotation_rad];
    let mut state = stepper.released(&release, &[0.0; 3]).unwrap();
    let mut inputs = Inputs::steady(e.wind_speed_m_s, 3);
    let mut steps = Vec::new();
    let mut time = 0.0;
    for n in 0..400 {
        let size = [0.01, 0.0037, 0.02][n % 3];
        let drag = (0.1 * n as f64).sin();
        inputs.force[1] = drag;
        stepper.advance(&mut state, &inputs, size).unwrap();
        let mut out = Outputs::default();
        stepper.outputs(&state, &inputs, &mut out).unwrap();
        let outputs: Value = (0..3)
            .flat_map(|i| {
                [
                    out.displacement[i],
                    out.rate[i],
                    out.acceleration[i],
                    out.self_excited_force[i],
                ]
            })
            .map(bits)
            .collect();
        steps.push(json!({
            "time": bits(time), "size": bits(size), "set": named(&[("external_drag", drag)]), "outputs": outputs,
        }));
        time += size;
    }
    let words = [("heave", "lift"), ("sway", "drag"), ("rotation", "moment")];
    let outputs: Vec<String> = words
        .iter()
        .flat_map(|(motion, force)| {
            let response = |suffix: &str| format!("{motion}{suffix}");
            [
                response(""),
                response("_rate"),
                response("_acceleration"),
                (*force).to_owned(),
            ]
        })
        .collect();
    json!({ "onset": onset, "outputs": outputs, "steps": steps })
}
