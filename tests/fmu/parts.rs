//! A bridge in parts: its structure alone, the forces on its strips, and both as a system.

use crate::bridges::{DECKS, THREE, TWO, langenuen, langenuen_text, lively, read};
use crate::patchwork::patchwork;
use aerodeck::aerodynamics::{RationalAdmittance, Transfer};
use aerodeck::bridge::BridgeMode;
use aerodeck::fmu::bridge_gusts::BridgeGusts;
use aerodeck::fmu::description_fmi3;
use aerodeck::fmu::force_options::StripsOfModel;
use aerodeck::fmu::importer::{Fmu, Slave, Value, replay};
use aerodeck::fmu::package::{Export, FmiVersion, Label, Runtime, package, write_archive};
use aerodeck::fmu::resources::Resources;
use aerodeck::fmu::variables::Causality;
use aerodeck::study::bridge::{BridgeExportOptions, BridgeStudy, SectionForcePart};
use std::f64::consts::TAU;

fn runtimes() -> [Runtime; 1] {
    [Runtime::embedded().unwrap()]
}

fn opened(bytes: &[u8]) -> Fmu {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.fmu");
    write_archive(&path, bytes, false).unwrap();
    Fmu::open(&path).unwrap()
}

fn structure(study: &BridgeStudy) -> Fmu {
    let (model, whole) = study.export(&BridgeExportOptions::default()).unwrap();
    let (model, export) = study.structure(model, whole, true).unwrap();
    opened(&package(&model, &runtimes(), export).unwrap())
}

fn packed(forces: &SectionForcePart) -> Fmu {
    let export = Export {
        force: Some(forces.options.clone()),
        allow_unstable: true,
        ..Export::default()
    };
    opened(&package(&forces.model, &runtimes(), export).unwrap())
}

fn real(slave: &Slave, name: &str) -> f64 {
    match slave.get(name).unwrap() {
        Value::Real(value) => value,
        other => panic!("{name} is {other}"),
    }
}

/// A mode at rest under a force that is held from the beginning: its coordinate some time later.
fn held(mode: &BridgeMode, force: f64, time: f64) -> f64 {
    let (omega, zeta) = (TAU * mode.frequency_hz, mode.damping_ratio);
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    let (sine, cosine) = (damped * time).sin_cos();
    let decay = (-zeta * omega * time).exp();
    let rest = force / (mode.generalised_mass * omega * omega);
    rest * (1.0 - decay * (cosine + zeta * omega / damped * sine))
}

/// In no wind: the closed form of every mode, in steps of any size; no word of wind in its description.
#[test]
fn a_structure_alone_moves_as_its_modes_do() {
    let study = lively();
    let fmu = structure(&study);
    let names: Vec<&str> = fmu
        .model_description()
        .variables
        .iter()
        .map(|v| v.name.as_str())
        .collect();
    for of_wind in [
        "wind",
        "onset",
        "damping_now",
        "air_density",
        "].force",
        "divergence",
    ] {
        assert!(!names.iter().any(|n| n.contains(of_wind)), "{of_wind}");
    }
    let report = fmu.check();
    assert!(report.passed() && report.ran.is_some(), "{report:#?}");
    let mut slave = fmu.instantiate("structure").unwrap();
    slave.enter_initialization(0.0, None, None).unwrap();
    let bridge = &study.by_model;
    for mode in &bridge.modes {
        let name = format!("mode[{}].initial_coordinate", mode.number);
        slave.set(&name, &Value::Real(0.0)).unwrap();
    }
    slave.exit_initialization().unwrap();
    let force = [2e5, -3e4, 4e6];
    for (of, value) in ["lift", "drag", "moment"].iter().zip(force) {
        let name = format!("node[1156].external_{of}");
        slave.set(&name, &Value::Real(value)).unwrap();
    }
    let node = |name: &str| bridge.nodes.iter().position(|n| n.name == name).unwrap();
    let mut time = 0.0;
    for step in [0.01, 0.37, 5.0, 0.002] {
        slave.do_step(time, step).unwrap();
        time += step;
        let (of_force, of_motion) = (node("1156"), node("1081"));
        for (i, of) in ["heave", "sway", "rotation"].iter().enumerate() {
            let of_mode = |m: &BridgeMode| {
                let work: f64 = (0..3).map(|j| m.shape[of_force][j] * force[j]).sum();
                m.shape[of_motion][i] * held(m, work, time)
            };
            let expected: f64 = bridge.modes.iter().map(of_mode).sum();
            let found = real(&slave, &format!("node[1081].{of}"));
            let scale: f64 = bridge.modes.iter().map(|m| of_mode(m).abs()).sum();
            assert!(
                (found - expected).abs() <= 1e-10 * scale,
                "{of}: {found}, {expected}"
            );
        }
    }
}

/// Every embedded deck with two and three motions: as many strips as nodes, named by them, in both versions of FMI.
#[test]
fn the_forces_of_every_girder_are_packed() {
    for (deck, motions) in DECKS.iter().flat_map(|d| [(d, TWO), (d, THREE)]) {
        let select = "damping_ratio = 0.002\nselect = [2, 3, 5, 12, 14, 16, 17, 23]";
        let text = langenuen_text(deck, motions, "linear_v_hat");
        let study = read(&text.replace("damping_ratio = 0.002", select));
        let wanted = BridgeExportOptions {
            allow_unstable: true,
            ..BridgeExportOptions::default()
        };
        let all = study
            .section_forces(&study.export(&wanted).unwrap().0, None)
            .unwrap();
        let [forces] = &all[..] else {
            panic!("{} sections", all.len());
        };
        assert_eq!(forces.options.strips.len(), study.by_model.nodes.len());
        let json = forces.model.to_json().unwrap();
        let options = forces.options.to_json().unwrap();
        let files = [Some(options.as_bytes()), None, None];
        let resources = Resources::from_bytes(json.as_bytes(), files).unwrap();
        assert!(
            resources
                .table
                .find_name("node[1156].total_moment")
                .is_some()
        );
        let text = description_fmi3::model_description(&resources, &Label::default()).unwrap();
        assert!(
            text.contains("name=\"total_moment\"") && !text.contains("node["),
            "{deck}"
        );
        let report = packed(forces).check();
        assert!(
            report.passed() && report.ran.is_some(),
            "{deck}: {report:#?}"
        );
    }
}

/// Sections of several kinds of forces in a profile: one unit with a strip at every node, without a fault in both versions, which
/// repeats its runs; and one component of the system.
#[test]
fn all_sections_are_one_unit() {
    let study = patchwork();
    let wanted = BridgeExportOptions {
        allow_unstable: true,
        ..BridgeExportOptions::default()
    };
    let each = study
        .section_forces(&study.export(&wanted).unwrap().0, None)
        .unwrap();
    let names: Vec<&str> = each.iter().map(|f| f.sections[0].as_str()).collect();
    // in the order of the nodes
    assert_eq!(names, ["west side", "middle", "east", "fairing", "end"]);
    let forces = study.joined(each.clone()).unwrap();
    let nodes = study.by_model.nodes.iter();
    let numbers = nodes.map(|n| n.name.parse().unwrap());
    let in_sections: Vec<u32> = numbers.filter(|n| *n != 1301).collect();
    assert_eq!(forces.options.nodes, in_sections);
    let strips = &forces.options.strips;
    let factors: Vec<f64> = strips.iter().map(|s| s.wind_factor).collect();
    assert!(factors.is_sorted() && factors[0] < 0.93 && *factors.last().unwrap() > 0.97);
    assert_eq!(
        [strips[0].width_m, strips[strips.len() - 1].width_m],
        [31.0, 30.0]
    );
    let parts = forces.options.parts(&forces.model, None);
    let filters: Vec<usize> = parts.iter().map(|p| p.filters).collect();
    assert_eq!(filters, [6, 6, 4, 4, 0]);
    for version in [FmiVersion::Two, FmiVersion::Three] {
        let export = forces.packed(&Label::default(), version);
        let fmu = opened(&package(&forces.model, &runtimes(), export).unwrap());
        let report = fmu.check();
        assert!(report.passed() && report.ran.is_some(), "{report:#?}");
        assert_eq!(report.findings, []);
        for run in replay(&fmu).unwrap() {
            assert_eq!(run.difference, 0.0, "{run:#?}");
        }
    }
    let verdict = study.verdict().unwrap();
    let system = study
        .system(&wanted, &verdict, &runtimes(), &Label::default())
        .unwrap();
    let names: Vec<&str> = system.components.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["structure", "force"]);
    // motions with their rates there, a force each back
    let of = |f: &SectionForcePart| 3 * f.model.model.dofs().len() * f.options.strips.len();
    assert_eq!(system.connections.len(), each.iter().map(of).sum::<usize>());
    assert!(system.package().unwrap().len() > 100_000);
}

/// Each of its strips is that of the unit of its section alone, under the same motion and gusts, bit for bit.
#[test]
fn the_unit_of_all_sections_is_the_units_of_each() {
    let study = patchwork();
    let wanted = BridgeExportOptions {
        allow_unstable: true,
        ..BridgeExportOptions::default()
    };
    let gusts = Some(RationalAdmittance::Liepmann);
    let each = study
        .section_forces(&study.export(&wanted).unwrap().0, gusts)
        .unwrap();
    let all = study.joined(each.clone()).unwrap();
    let started = |forces: &SectionForcePart| {
        let export = forces.packed(&Label::default(), FmiVersion::Two);
        let fmu = opened(&package(&forces.model, &runtimes(), export).unwrap());
        let mut slave = fmu.instantiate("forces").unwrap();
        slave.enter_initialization(0.0, None, None).unwrap();
        slave.exit_initialization().unwrap();
        (fmu, slave)
    };
    let (_, mut whole) = started(&all);
    for forces in &each {
        let (fmu, mut part) = started(forces);
        whole.reset().unwrap();
        whole.enter_initialization(0.0, None, None).unwrap();
        whole.exit_initialization().unwrap();
        let variables = &fmu.model_description().variables;
        let named = |causality| {
            let own = variables.iter().filter(move |v| v.causality == causality);
            own.map(|v| v.name.as_str())
        };
        for step in 0..4 {
            let time = 0.05 * f64::from(step);
            for (i, name) in named(Causality::Input).enumerate() {
                let value = match name {
                    "wind_speed" => 30.0 + time,
                    _ => 0.02 * (2.0 * time + i as f64).sin(),
                };
                whole.set(name, &Value::Real(value)).unwrap();
                part.set(name, &Value::Real(value)).unwrap();
            }
            whole.do_step(time, 0.05).unwrap();
            part.do_step(time, 0.05).unwrap();
            for name in named(Causality::Output) {
                let [a, b] = [real(&whole, name), real(&part, name)];
                assert!(a != 0.0 && a.to_bits() == b.to_bits(), "{name}: {a} {b}");
            }
        }
    }
}

/// In FMI 3.0 arrays say of which nodes they are.
#[test]
fn arrays_of_some_nodes_are_named() {
    let study = patchwork();
    let wanted = BridgeExportOptions {
        allow_unstable: true,
        ..BridgeExportOptions::default()
    };
    let forces = study
        .joined(
            study
                .section_forces(&study.export(&wanted).unwrap().0, None)
                .unwrap(),
        )
        .unwrap();
    let export = forces.packed(&Label::default(), FmiVersion::Three);
    let fmu = opened(&package(&forces.model, &runtimes(), export).unwrap());
    let variables = &fmu.model_description().variables;
    let names = |array: &str| -> Vec<u32> {
        let own = variables
            .iter()
            .filter(|v| v.name.starts_with(&format!("{array}[")));
        let name = own.map(|v| match &v.start {
            Some(Value::String(name)) => name.parse().unwrap(),
            other => panic!("{}: {other:?}", v.name),
        });
        name.collect()
    };
    let parts = forces.options.parts(&forces.model, None);
    let nodes = |wanted: &dyn Fn(&StripsOfModel<'_>) -> bool| -> Vec<u32> {
        let parts = parts.iter().filter(|p| wanted(p));
        let nodes = parts.flat_map(|p| &forces.options.nodes[p.strips.clone()]);
        nodes.copied().collect()
    };
    assert_eq!(names("node_name"), forces.options.nodes);
    assert_eq!(names("node_name_2"), nodes(&|p| p.filters > 0));
    assert_eq!(names("node_name_3"), nodes(&|p| p.filters > 4));
    assert_eq!(
        names("node_name_4"),
        nodes(&|p| p.model.section.lateral.is_some())
    );
    let text = |array: &str| {
        let first = variables.iter().find(|v| v.name == array).unwrap();
        first.description.clone().unwrap()
    };
    assert!(text("sway[1]").contains("the first of 31, named in node_name_4"));
    assert!(text("filter[6,1]").contains("the first of 42, named in node_name_3"));
    assert!(text("node_name_4[1]").contains("nodes that have sway"));
}

/// Gusts belong to the forces.
#[test]
fn what_a_structure_does_not_have_is_refused() {
    let study = langenuen("LN21-5200", TWO);
    let (model, mut whole) = study.export(&BridgeExportOptions::default()).unwrap();
    whole.bridge.as_mut().unwrap().gusts = Some(BridgeGusts {
        coefficients: Vec::new(),
        admittance: RationalAdmittance::None,
        strips: Vec::new(),
        source: String::new(),
    });
    let refused = study.structure(model, whole, true).unwrap_err();
    assert!(
        refused.to_string().contains("not to the structure"),
        "{refused}"
    );
}
