//! A bridge in parts: its structure alone, the forces on its strips, and both as a system.

use crate::bridges::{DECKS, THREE, TWO, langenuen, langenuen_text, lively, read};
use aerodeck::bridge::BridgeMode;
use aerodeck::fmu::description_fmi3;
use aerodeck::fmu::importer::{Fmu, Slave, Value};
use aerodeck::fmu::package::{
    FmiVersion, Label, Overwrite, Runtime, package, package_bridge, write_archive,
};
use aerodeck::fmu::resources::Resources;
use aerodeck::study::bridge::{BridgeExportOptions, BridgeStudy, SectionForcePart};
use std::f64::consts::TAU;

fn runtimes() -> [Runtime; 1] {
    [Runtime::embedded().unwrap()]
}

fn opened(bytes: &[u8]) -> Fmu {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.fmu");
    write_archive(&path, bytes, Overwrite::Refuse).unwrap();
    Fmu::open(&path).unwrap()
}

fn structure(study: &BridgeStudy) -> Fmu {
    let export = study.structure(&BridgeExportOptions::default()).unwrap();
    let two = FmiVersion::Two;
    opened(&package_bridge(&export, &runtimes(), &Label::default(), two).unwrap())
}

fn packed(forces: &SectionForcePart) -> Fmu {
    let export = aerodeck::fmu::package::Export {
        force: Some(forces.options.clone()),
        ..aerodeck::fmu::package::GrowthPolicy::Allow.into()
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
    slave.setup(0.0, None, None).unwrap();
    slave.enter_initialization().unwrap();
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
        let all = study.section_forces(&wanted, None).unwrap();
        let [forces] = &all[..] else {
            panic!("{} sections", all.len());
        };
        assert_eq!(forces.options.strips.len(), study.by_model.nodes.len());
        let json = forces.model.to_json().unwrap();
        let options = forces.options.to_json().unwrap();
        let files = aerodeck::fmu::resources::OptionFiles {
            force: Some(options.as_bytes()),
            ..Default::default()
        };
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

/// Two sections of different widths in a profile: a unit each, and every node once.
#[test]
fn every_section_is_a_component() {
    let one = langenuen_text("LN21-5200", TWO, "linear_v_hat");
    let (before, after) = one.split_once("[[section]]").unwrap();
    let (section, rest) = after.split_once("[flutter]").unwrap();
    let west = section.replace("\"girder\"", "\"west side\"\nto = \"1151\"");
    let east = section
        .replace("\"girder\"", "\"east\"\nfrom = \"1156\"")
        .replace("31.0", "30.0");
    let text = format!(
        "{before}[[section]]{west}[[section]]{east}[wind]\nprofile = [{{ along_m = -617.5, factor = 0.9 }}, {{ along_m = 617.5, factor = 1.0 }}]\n[flutter]{rest}"
    );
    let study = read(&text.replace(
        "damping_ratio = 0.002",
        "damping_ratio = 0.002\nselect = [2, 3, 5, 23]",
    ));
    let wanted = BridgeExportOptions {
        allow_unstable: true,
        ..BridgeExportOptions::default()
    };
    let verdict = study.verdict().unwrap();
    let system = study
        .system(&wanted, &verdict, &runtimes(), &Label::default())
        .unwrap();
    let names: Vec<&str> = system.components.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["structure", "force_west_side", "force_east"]);
    // heave and rotation with their rates there, lift and moment back
    assert_eq!(system.connections.len(), 6 * study.by_model.nodes.len());
    let forces = study.section_forces(&wanted, None).unwrap();
    assert_eq!(forces[1].options.strips[0].width_m, 30.0);
    let factors: Vec<f64> = forces
        .iter()
        .flat_map(|f| &f.options.strips)
        .map(|s| s.wind_factor)
        .collect();
    assert!(factors.is_sorted() && factors[0] < 0.93 && *factors.last().unwrap() > 0.97);
    assert!(system.package().unwrap().len() > 100_000);
}

/// Gusts belong to the forces.
#[test]
fn what_a_structure_does_not_have_is_refused() {
    let wanted = BridgeExportOptions {
        gust_strips: Some(3),
        ..BridgeExportOptions::default()
    };
    let refused = langenuen("LN21-5200", TWO).structure(&wanted).unwrap_err();
    assert!(
        refused.to_string().contains("not to the structure"),
        "{refused}"
    );
}
