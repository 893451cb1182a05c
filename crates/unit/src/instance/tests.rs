//! Every kind of unit, driven without a shell.

mod after_changes;
#[allow(unsafe_code)]
mod allocations;
mod beside_tests;
mod damping;
mod differences;
mod followed;
pub(crate) mod several_models;
mod tested;
mod unknown;

use super::Instance;
use crate::aerodynamics::{GustForce, RationalAdmittance};
use crate::bridge::{Bridge, DampedPoint, Dampers, MassDamper, StripGroup, ViscousLink};
use crate::bridge_gusts::{BridgeGusts, TurbulenceOptions};
use crate::bridge_options::BridgeOptions;
use crate::force_options::ForceOptions;
use crate::lifecycle::State;
use crate::resources::Resources;
use crate::section::Dof;
use crate::trained_model::{Model, TrainedModel};
use std::sync::Arc;

/// Kinds of units.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Exported {
    Section(&'static str),
    Forces(&'static str),
    /// On strips of several models.
    Patched,
    Bridge,
    /// With dampers.
    Damped,
}

const KINDS: [Exported; 8] = [
    Exported::Section("continuous_laguerre"),
    Exported::Section("rational"),
    Exported::Section("discrete_laguerre"),
    Exported::Forces("rational"),
    Exported::Forces("discrete_laguerre"),
    Exported::Patched,
    Exported::Bridge,
    Exported::Damped,
];

fn fixture(name: &str) -> Vec<u8> {
    let root = env!("CARGO_MANIFEST_DIR");
    std::fs::read(format!("{root}/../../tests/data/models/{name}.json")).unwrap()
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
        dampers: Dampers::default(),
        structure_alone: false,
        groups: vec![StripGroup {
            name: "girder".into(),
            width_m: model.section.width_m,
            wind_factor: 1.0,
            nodes: vec![0],
            forces: 0,
        }],
        forces: vec![model.model.clone()],
        named: vec![0],
        tested_range: Some(model.tested_range),
        section_ranges: vec![model.tested_range],
        initial: vec![0.01, 0.002],
        gusts: None,
        onset_interval: None,
        onset: None,
    }
}

/// A mass of a twentieth of the section off its axis, and a dashpot against rotation.
fn dampers(model: &TrainedModel) -> Dampers {
    let at = |motion, offset_m| DampedPoint {
        node: 0,
        motion,
        offset_m,
    };
    let mass = MassDamper {
        name: "mass".into(),
        at: at(Dof::Vertical, 0.1),
        mass_kg: 0.05 * model.section.vertical.mass_kg_m,
        frequency_hz: 2.5,
        damping_ratio: 0.08,
    };
    let link = ViscousLink {
        name: "dashpot".into(),
        at: at(Dof::Torsion, 0.0),
        to: None,
        coefficient: 0.02,
    };
    Dampers {
        masses: vec![mass],
        links: vec![link],
    }
}

fn resources(kind: Exported) -> Resources {
    resources_in(kind, false)
}

fn gust_force() -> GustForce {
    GustForce {
        dofs: Dof::TWO.to_vec(),
        coefficients: vec![[0.3, -5.0], [0.05, 1.2]],
        admittance: RationalAdmittance::Sears,
        source: "test".into(),
    }
}

/// With gusts among the inputs, of a bridge also turbulence in the archive, or without.
fn resources_in(kind: Exported, gusts: bool) -> Resources {
    let force = gust_force();
    let gust_text = gusts.then(|| serde_json::to_string(&force).unwrap());
    let of_files = |name, force: Option<&str>| {
        let files = [
            force.map(str::as_bytes),
            gust_text.as_deref().map(str::as_bytes),
            None,
        ];
        Resources::from_bytes(&fixture(name), files).unwrap()
    };
    match kind {
        Exported::Section(name) => of_files(name, None),
        Exported::Forces(name) => {
            let options = ForceOptions::single(0.5).to_json().unwrap();
            of_files(name, Some(&options))
        }
        Exported::Patched => several_models::resources(gusts),
        Exported::Bridge | Exported::Damped => {
            let json = fixture("rational");
            let model = TrainedModel::from_json(std::str::from_utf8(&json).unwrap()).unwrap();
            let mut options = bridge_of(&model);
            if matches!(kind, Exported::Damped) {
                options.dampers = dampers(&model);
            }
            options.gusts = gusts.then(|| BridgeGusts {
                coefficients: vec![[[0.3, -5.0], [0.1, 0.2], [0.05, 1.2]]],
                admittance: force.admittance,
                strips: vec![vec![0]],
                source: force.source.clone(),
            });
            let wave = |phase: f64| {
                (0..64)
                    .map(|i| (0.3 * f64::from(i) + phase).sin())
                    .collect()
            };
            let field = gusts.then(|| TurbulenceOptions {
                step_s: 0.007,
                u: vec![wave(0.0)],
                w: vec![wave(1.0)],
            });
            let field = field.map(|field| serde_json::to_string(&field).unwrap());
            let options = options.to_json().unwrap();
            let turbulence = field.as_deref().map(str::as_bytes);
            Resources::of_bridge(&json, options.as_bytes(), turbulence).unwrap()
        }
    }
}

fn driven(kind: Exported, gusts: bool) -> Instance {
    Instance::new(resources_in(kind, gusts)).unwrap()
}

/// A new instance whose importer integrates, or does not; `None` where it cannot.
fn instance(kind: Exported, integrated: bool) -> Option<Instance> {
    let instance = Instance::new(resources(kind)).unwrap();
    if integrated {
        instance.for_model_exchange().ok()
    } else {
        Some(instance)
    }
}

fn index(instance: &Instance, name: &str) -> u32 {
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
