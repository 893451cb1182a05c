//! Strips of several models in one unit are the units of the models side by side.

use super::{fixture, gust_force, index, start};
use crate::aerodynamics::{GustForce, Lags, RationalModel};
use crate::force_options::{ForceOptions, FurtherModel, StripOptions};
use crate::instance::Instance;
use crate::resources::Resources;
use crate::section::Dof;
use crate::trained_model::{Model, TrainedModel};
use crate::variables::{Causality, Variable};
use nalgebra::DMatrix;

fn model(name: &str) -> TrainedModel {
    TrainedModel::from_json(std::str::from_utf8(&fixture(name)).unwrap()).unwrap()
}

/// Forces of three motions with so many lags, quasi-steady without.
fn three_motions(lags: &[f64]) -> TrainedModel {
    let like = model("rational");
    let matrix = |by: f64| DMatrix::from_fn(3, 3, |i, j| by * (1.0 + i as f64 - 0.4 * j as f64));
    let mut section = like.section.clone();
    section.lateral = Some(section.vertical.clone());
    TrainedModel {
        section,
        model: Model::Rational(RationalModel {
            dofs: Dof::THREE.to_vec(),
            a1: matrix(0.3),
            a2: matrix(-0.2),
            a3: matrix(0.05),
            lags: Lags::Shared(lags.to_vec()),
            lag_terms: lags.iter().map(|d| matrix(*d)).collect(),
        }),
        ..like
    }
}

/// Forces of gusts of a model.
fn gusts_of(model: &TrainedModel) -> GustForce {
    let dofs = model.section.dofs();
    GustForce {
        coefficients: dofs
            .iter()
            .map(|d| [0.1, 1.0 + *d as usize as f64])
            .collect(),
        dofs,
        ..gust_force()
    }
}

/// The models with the nodes of each.
fn sections() -> [(TrainedModel, &'static [u32]); 4] {
    [
        (model("rational"), &[11, 12, 13]),
        (three_motions(&[0.2]), &[21, 22]),
        (three_motions(&[]), &[25]),
        (model("continuous_laguerre"), &[31, 32, 33, 34, 35]),
    ]
}

/// Strips of every model, each of its own width, length and wind.
fn options(of: &[(TrainedModel, &[u32])], gusts: bool) -> ForceOptions {
    let strip = |model: usize, node: &u32| StripOptions {
        width_m: 0.4 + 0.01 * f64::from(*node),
        length_m: 1.0 + 0.1 * f64::from(*node),
        wind_factor: 1.0 - 0.005 * f64::from(*node),
        model,
    };
    let each = of.iter().enumerate();
    ForceOptions {
        strips: each
            .flat_map(|(m, (_, nodes))| nodes.iter().map(move |n| strip(m, n)))
            .collect(),
        further: of[1..]
            .iter()
            .map(|(model, _)| FurtherModel {
                model: model.clone(),
                gusts: gusts.then(|| gusts_of(model)),
            })
            .collect(),
        named_strips: true,
        nodes: of.iter().flat_map(|(_, nodes)| nodes.to_vec()).collect(),
        ..ForceOptions::single(0.5)
    }
}

fn resources_of(of: &[(TrainedModel, &[u32])], gusts: bool) -> Resources {
    let force = options(of, gusts).to_json().unwrap();
    let gusts = gusts.then(|| serde_json::to_string(&gusts_of(&of[0].0)).unwrap());
    let files = [
        Some(force.as_bytes()),
        gusts.as_deref().map(str::as_bytes),
        None,
    ];
    Resources::from_bytes(of[0].0.to_json().unwrap().as_bytes(), files).unwrap()
}

/// All of them in one unit.
pub(crate) fn resources(gusts: bool) -> Resources {
    resources_of(&sections(), gusts)
}

/// The unit of all, and those of single models.
fn units(gusts: bool, integrated: bool) -> Vec<Instance> {
    let all = sections();
    let mut each = vec![resources(gusts)];
    each.extend(all.chunks(1).map(|one| {
        // the widths are those of the nodes
        resources_of(one, gusts)
    }));
    let made = each.into_iter().filter_map(|r| {
        let unit = Instance::new(r).unwrap();
        match integrated {
            // of one model alone not without states
            true => unit.for_model_exchange().ok(),
            false => Some(unit),
        }
    });
    made.collect()
}

/// Names of the variables of strips of a kind.
fn named(unit: &Instance, wanted: impl Fn(&Variable) -> bool) -> Vec<String> {
    let all = unit.table().variables().iter();
    let of_strips = all.filter(|v| v.name.contains("node[") && wanted(v));
    of_strips.map(|v| v.name.clone()).collect()
}

fn set(unit: &mut Instance, name: &str, value: f64) {
    let at = index(unit, name);
    unit.set_reals(&[at], &[value]).unwrap();
}

fn get(unit: &mut Instance, name: &str) -> f64 {
    let mut value = [f64::NAN];
    let at = index(unit, name);
    unit.reals(&[at], &mut value).unwrap();
    value[0]
}

/// A number that is another for every name and time.
fn wave(name: &str, t: f64) -> f64 {
    let phase: f64 = name.bytes().map(f64::from).sum();
    0.01 * (3.0 * t + 0.37 * phase).sin()
}

/// The same motion, gusts and wind.
fn drive(units: &mut [Instance], t: f64) {
    for unit in units {
        set(unit, "wind_speed", 6.0 + t);
        for name in named(unit, |v| v.causality == Causality::Input) {
            set(unit, &name, wave(&name, t));
        }
    }
}

#[track_caller]
fn same(units: &mut [Instance], wanted: impl Fn(&Variable) -> bool) -> usize {
    let (all, each) = units.split_at_mut(1);
    let mut count = 0;
    for unit in each {
        for name in named(unit, &wanted) {
            let [a, b] = [get(&mut all[0], &name), get(unit, &name)];
            assert!(
                a.is_finite() && a.to_bits() == b.to_bits(),
                "{name}: {a} {b}"
            );
            count += 1;
        }
    }
    count
}

fn is_output(v: &Variable) -> bool {
    v.causality == Causality::Output
}

fn is_inner(v: &Variable) -> bool {
    v.causality == Causality::Local
}

/// Bit for bit in co-simulation, through changing wind and a changed width, from a saved state too.
#[test]
fn steps_are_those_of_each_model() {
    for gusts in [false, true] {
        let mut units = units(gusts, false);
        drive(&mut units, 0.0);
        units.iter_mut().for_each(start);
        let mut saved = Vec::new();
        let mut run = |units: &mut [Instance], from: usize| {
            for i in from..12 {
                let t = 0.02 * i as f64;
                drive(units, t);
                assert_eq!(same(units, is_output), 2 * (2 * 8 + 3 * 3));
                for unit in &mut *units {
                    unit.do_step(t, 0.02).unwrap();
                }
                same(units, is_output);
                same(units, is_inner);
                if i == 5 {
                    for node in ["node[12]", "node[22]", "node[35]"] {
                        let name = format!("{node}.width");
                        for unit in &mut *units {
                            if unit.table().find_name(&name).is_some() {
                                set(unit, &name, 0.7);
                            }
                        }
                    }
                    saved = units.iter().map(Instance::snapshot).collect();
                }
            }
            let outputs = named(&units[0], is_output);
            let read = outputs
                .iter()
                .map(|name| get(&mut units[0], name).to_bits());
            (read.collect::<Vec<_>>(), std::mem::take(&mut saved))
        };
        let (first, saved) = run(&mut units, 0);
        for (unit, snapshot) in units.iter_mut().zip(&saved) {
            let bytes = unit.serialize(snapshot).unwrap();
            let snapshot = unit.deserialize(&bytes).unwrap();
            unit.restore(&snapshot).unwrap();
        }
        assert_eq!(run(&mut units, 6).0, first);
    }
}

/// The same beside an importer that integrates: forces and rates of the instant, settled flow, derivatives.
#[test]
fn the_instant_is_that_of_each_model() {
    for gusts in [false, true] {
        let mut units = units(gusts, true);
        drive(&mut units, 0.0);
        units.iter_mut().for_each(start);
        let settled = same(&mut units, is_inner);
        assert!(settled > 60 && units.len() > 3, "{settled}");
        let count = units[0].state_count();
        let states: Vec<String> = units[0]
            .table()
            .state_rates()
            .iter()
            .map(|rate| {
                let variables = units[0].table().variables();
                let state = variables[*rate].derivative_of.unwrap();
                variables[state].name.clone()
            })
            .collect();
        let each: usize = units[1..].iter().map(Instance::state_count).sum();
        assert_eq!([count, states.len()], [each; 2]);
        let by_name = |unit: &Instance| -> Vec<f64> {
            let table = unit.table();
            let state = |rate: &usize| table.variables()[*rate].derivative_of.unwrap();
            let indices = table.state_rates();
            let names = indices.iter().map(|r| &table.variables()[state(r)].name);
            names.map(|name| wave(name, 0.5)).collect()
        };
        for unit in &mut units {
            unit.enter(crate::lifecycle::State::ContinuousTimeMode);
            let values = by_name(unit);
            unit.set_continuous_states(&values).unwrap();
        }
        drive(&mut units, 0.3);
        same(&mut units, is_output);
        same(&mut units, is_inner);
        derivatives(&mut units);
    }
}

/// Directional derivatives of every force and rate of a unit.
fn derivatives(units: &mut [Instance]) {
    let (all, each) = units.split_at_mut(1);
    let all = &mut all[0];
    for unit in each {
        let unknowns = named(unit, |v| is_output(v) || v.derivative_of.is_some());
        let knowns = named(unit, |v| {
            v.causality == Causality::Input || (is_inner(v) && v.derivative_of.is_none())
        });
        for known in knowns.iter().map(String::as_str).chain(["wind_speed"]) {
            let [a, b] = [&mut *all, unit].map(|unit| {
                let indices: Vec<u32> = unknowns.iter().map(|n| index(unit, n)).collect();
                let mut slopes = vec![f64::NAN; indices.len()];
                let known = index(unit, known);
                unit.directional_derivative(&indices, &[known], &[1.0], &mut slopes)
                    .unwrap();
                slopes
            });
            assert_eq!(a, b, "{known}");
        }
    }
}

/// Of a strip nothing depends on what another does.
#[test]
fn strips_depend_on_nothing_of_one_another() {
    let resources = resources(true);
    let variables = resources.table.variables();
    let node = |name: &str| {
        name.split_once("].")
            .map(|(n, _)| n.trim_start_matches("der(").to_owned())
    };
    let mut count = 0;
    for v in variables {
        for of in v.direct_inputs.iter().chain(&v.initial_dependencies) {
            let Some(other) = node(&variables[of.on].name) else {
                continue;
            };
            assert_eq!(Some(other), node(&v.name), "{}", v.name);
            count += 1;
        }
    }
    assert!(count > 300, "{count}");
}

#[test]
fn models_without_order_are_refused() {
    let all = sections();
    type Change = fn(&mut ForceOptions);
    let refused: [(Change, &str); 5] = [
        (
            |o| o.strips.reverse(),
            "strips: model: expected strips of 4 models",
        ),
        (|o| o.strips[2].model = 1, ""),
        (
            |o| o.strips[10].model = 4,
            "strips: model: expected strips of 4 models",
        ),
        (|o| o.further.push(o.further[0].clone()), "strips: model"),
        (|o| o.nodes.clear(), "nodes: expected the nodes of a bridge"),
    ];
    for (change, message) in refused {
        let mut options = options(&all, false);
        change(&mut options);
        match options.validate() {
            Ok(()) => assert_eq!(message, ""),
            Err(e) => assert!(
                !message.is_empty() && e.to_string().starts_with(message),
                "{e}"
            ),
        }
    }
    let mut options = options(&all, true);
    options.further[1].gusts = None;
    let json = all[0].0.to_json().unwrap();
    let gusts = serde_json::to_vec(&gusts_of(&all[0].0)).unwrap();
    let force = options.to_json().unwrap();
    let files = [Some(force.as_bytes()), Some(&gusts), None];
    let refused = Resources::from_bytes(json.as_bytes(), files).unwrap_err();
    assert!(
        refused.to_string().contains("strips of all models"),
        "{refused}"
    );
}
