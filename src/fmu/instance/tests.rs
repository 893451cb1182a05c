//! Every kind of unit, driven without a shell.

mod after_changes;
#[allow(unsafe_code)]
mod allocations;
mod followed;
mod unknown;

use super::Instance;
use crate::bridge::Bridge;
use crate::fmu::bridge_options::{BridgeOptions, GroupOptions};
use crate::fmu::force_options::ForceOptions;
use crate::fmu::lifecycle::State;
use crate::fmu::resources::{OptionFiles, Resources};
use crate::trained_model::{Model, TrainedModel};
use std::sync::Arc;

/// Kinds of units.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Section(&'static str),
    Forces(&'static str),
    Bridge,
}

const KINDS: [Kind; 6] = [
    Kind::Section("continuous_laguerre"),
    Kind::Section("rational"),
    Kind::Section("discrete_laguerre"),
    Kind::Forces("rational"),
    Kind::Forces("discrete_laguerre"),
    Kind::Bridge,
];

fn fixture(name: &str) -> Vec<u8> {
    let root = env!("CARGO_MANIFEST_DIR");
    std::fs::read(format!("{root}/tests/data/models/{name}.json")).unwrap()
}

/// The section of a model as a bridge of one node.
fn bridge_of(model: &TrainedModel) -> BridgeOptions {
    let force: Arc<dyn crate::aerodynamics::Transfer> = match &model.model {
        Model::Rational(m) => Arc::new(m.clone()),
        other => panic!("the fixture is rational, not {}", other.kind()),
    };
    let bridge = Bridge::of_section(&model.section, force).unwrap();
    BridgeOptions {
        name: "section".into(),
        air_density_kg_m3: bridge.air_density_kg_m3,
        nodes: bridge.nodes,
        modes: bridge.modes,
        groups: vec![GroupOptions {
            name: "girder".into(),
            width_m: model.section.width_m,
            wind_factor: 1.0,
            nodes: vec![0],
            forces: 0,
        }],
        forces: vec![model.model.clone()],
        named: vec![0],
        tested_range: Some(model.tested_range),
        initial: vec![0.01, 0.002],
        gusts: None,
        onset_interval: None,
        onset: None,
    }
}

fn resources(kind: Kind) -> Resources {
    match kind {
        Kind::Section(name) => {
            Resources::from_bytes(&fixture(name), OptionFiles::default()).unwrap()
        }
        Kind::Forces(name) => {
            let options = ForceOptions::single(0.5).to_json().unwrap();
            let force = Some(options.as_bytes());
            let files = OptionFiles {
                force,
                ..OptionFiles::default()
            };
            Resources::from_bytes(&fixture(name), files).unwrap()
        }
        Kind::Bridge => {
            let json = fixture("rational");
            let model = TrainedModel::from_json(std::str::from_utf8(&json).unwrap()).unwrap();
            let options = bridge_of(&model).to_json().unwrap();
            Resources::of_bridge(&json, options.as_bytes(), None).unwrap()
        }
    }
}

/// A new instance whose importer integrates, or does not; `None` where it cannot.
fn instance(kind: Kind, integrated: bool) -> Option<Instance> {
    let instance = Instance::new(resources(kind)).unwrap();
    if integrated {
        instance.for_model_exchange().ok()
    } else {
        Some(instance)
    }
}

fn place(instance: &Instance, name: &str) -> u32 {
    let found = instance.table().find_name(name);
    found.unwrap_or_else(|| panic!("no variable `{name}`")) as u32
}

/// Ready for a step, or between events.
fn start(instance: &mut Instance) {
    instance.set_up_experiment(0.0, None).unwrap();
    instance.enter_initialization();
    instance.exit_initialization().unwrap();
    if instance.state() == State::EventMode {
        instance.enter(State::ContinuousTimeMode);
        instance.enter(State::EventMode);
    }
}
