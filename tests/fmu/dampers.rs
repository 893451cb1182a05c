//! Dampers in FMUs of a bridge: growth of the stepped unit against eigenvalues, the structure alone against a damper outside.

use crate::bridges::{TWO, coupled, langenuen_text, lively, read};
use aerodeck::bridge::Bridge;
use aerodeck::flutter::{OnsetSearch, find_onset};
use aerodeck::fmu::description_fmi3::model_description;
use aerodeck::fmu::importer::{Fmu, Slave, Value};
use aerodeck::fmu::package::{Export, Label, Runtime, package, write_archive};
use aerodeck::fmu::resources::Resources;
use aerodeck::study::bridge::{BridgeExportOptions, BridgeStudy};
use aerodeck::trained_model::TrainedModel;
use std::f64::consts::TAU;
use std::time::Instant;

fn opened(model: &TrainedModel, export: Export) -> Fmu {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bridge.fmu");
    let runtimes = [Runtime::embedded().unwrap()];
    let bytes = package(model, &runtimes, export).unwrap();
    write_archive(&path, &bytes, false).unwrap();
    Fmu::open(&path).unwrap()
}

fn real(slave: &Slave, name: &str) -> f64 {
    match slave.get(name).unwrap() {
        Value::Real(value) => value,
        other => panic!("{name} is {other}"),
    }
}

fn set(slave: &mut Slave, name: &str, value: f64) {
    slave.set(name, &Value::Real(value)).unwrap();
}

pub const BLOCKS: &str = "[[damper]]\nnode = \"1156\"\nmotion = \"torsion\"\narm_m = 13.0\nmass_kg = 60e3\nfrequency_hz = 0.34\ndamping_ratio = 0.1\n\
     [[damper]]\nnode = \"1081\"\nmotion = \"lateral\"\nmass_kg = 40e3\nfrequency_hz = 0.055\ndamping_ratio = 0.08\n\
     [[damper]]\nnode = \"1001\"\nmotion = \"vertical\"\ncoefficient = 1e5\n";

fn damped() -> BridgeStudy {
    let plain = lively();
    read(&(plain.file.text + BLOCKS))
}

/// The eigenvalue of the state with the largest real part, rad/s.
fn fastest(bridge: &Bridge, speed: f64) -> (f64, f64) {
    let all = coupled(bridge).at(speed).unwrap().eigenvalues().unwrap();
    let most = all.iter().max_by(|a, b| a.re.total_cmp(&b.re)).unwrap();
    (most.re, most.im.abs())
}

/// Well below, below and above the onset, with dampers as in the file and tuned: what the unit calculates and how it grows.
#[test]
fn a_damped_bridge_grows_as_its_eigenvalues_say() {
    let study = damped();
    let (model, export) = study.export(&BridgeExportOptions::default()).unwrap();
    let fmu = opened(&model, export);
    let report = fmu.check();
    assert!(report.passed() && report.ran.is_some(), "{report:#?}");
    let search = OnsetSearch {
        speeds: 60,
        ..crate::bridges::SEARCH
    };
    let searched = |bridge: &Bridge| {
        let found = find_onset("bridge", &coupled(bridge), &search, None).unwrap();
        found.onset().unwrap().at.speed_m_s
    };
    let mut tuned = study.by_model.clone();
    let cases = [
        (60e3, 0.34, 0.1, 1e5),
        (80e3, 0.34, 0.12, 3e5),
        (30e3, 0.31, 0.05, 0.0),
    ];
    for (mass, hertz, damping, coefficient) in cases {
        let mut slave = fmu.instantiate("bridge").unwrap();
        slave.enter_initialization(0.0, None, None).unwrap();
        for d in 0..2 {
            let damper = &mut tuned.dampers.masses[d];
            (damper.mass_kg, damper.frequency_hz, damper.damping_ratio) =
                (0.5 * mass, hertz, damping);
            let name = |of: &str| format!("damper[{}].{of}", d + 1);
            set(&mut slave, &name("mass"), 0.5 * mass);
            set(&mut slave, &name("frequency"), hertz);
            set(&mut slave, &name("damping_ratio"), damping);
        }
        tuned.dampers.links[0].coefficient = coefficient;
        set(&mut slave, "link[1].coefficient", coefficient);
        let onset = searched(&tuned);
        assert!((real(&slave, "onset_speed") / onset - 1.0).abs() < 1e-7);
        slave.exit_initialization().unwrap();
        assert!(real(&slave, "damper[1].stroke").abs() < 1e-12);
        for part in [0.5, 0.99, 1.05] {
            slave.reset().unwrap();
            slave.enter_initialization(0.0, None, None).unwrap();
            set(&mut slave, "wind_speed", part * onset);
            for d in 0..2 {
                let name = |of: &str| format!("damper[{}].{of}", d + 1);
                set(&mut slave, &name("mass"), 0.5 * mass);
                set(&mut slave, &name("frequency"), hertz);
                set(&mut slave, &name("damping_ratio"), damping);
            }
            set(&mut slave, "link[1].coefficient", coefficient);
            slave.exit_initialization().unwrap();
            let (growth, omega) = fastest(&tuned, part * onset);
            let found = real(&slave, "damping_now");
            let all = coupled(&tuned)
                .at(part * onset)
                .unwrap()
                .eigenvalues()
                .unwrap();
            let least = all.iter().filter(|z| z.im > 0.0).map(|z| -z.re / z.norm());
            assert!((found - least.fold(1.0, f64::min)).abs() < 1e-9);
            if part < 0.9 {
                continue;
            }
            // a whole number of periods apart, after the others have died out
            let period = TAU / omega;
            let (mut time, step) = (0.0, 40.0 * period);
            let mut sizes = Vec::new();
            for _ in 0..40 {
                slave.do_step(time, step).unwrap();
                time += step;
                sizes
                    .push(["coordinate", "rate"].map(|of| real(&slave, &format!("mode[23].{of}"))));
            }
            let size = |s: &[f64; 2]| (s[0] * omega).hypot(s[1] - growth * s[0]);
            let rate = (size(&sizes[39]) / size(&sizes[38])).ln() / step;
            eprintln!("{mass} kg at {part} of {onset} m/s: growth {rate}, eigenvalue {growth}");
            assert!((rate - growth).abs() < 1e-6 * omega, "{rate}, {growth}");
        }
    }
}

/// The structure with its damper against the structure without one, to which the test holds one: the difference is that of the
/// step in which both exchange forces, and half as large at half the step.
#[test]
fn a_damper_outside_does_what_one_inside_does() {
    let plain = lively();
    let block = "[[damper]]\nnode = \"1156\"\nmotion = \"vertical\"\nmass_kg = 50e3\nfrequency_hz = 0.14\ndamping_ratio = 0.07\n";
    let with = read(&(plain.file.text.clone() + block));
    let wanted = BridgeExportOptions {
        nodes: vec!["1156".to_owned()],
        ..BridgeExportOptions::default()
    };
    let [inside, outside] = [&with, &plain].map(|study| {
        let (model, whole) = study.export(&wanted).unwrap();
        let all = wanted.nodes.is_empty();
        let (model, export) = study.structure(model, whole, all).unwrap();
        opened(&model, export)
    });
    let start = |fmu: &Fmu| {
        let mut slave = fmu.instantiate("structure").unwrap();
        slave.enter_initialization(0.0, None, None).unwrap();
        for mode in &plain.by_model.modes {
            let value = if mode.number == 3 { 0.5 } else { 0.0 };
            set(
                &mut slave,
                &format!("mode[{}].initial_coordinate", mode.number),
                value,
            );
        }
        slave.exit_initialization().unwrap();
        slave
    };
    let (mass, omega, zeta) = (50e3, TAU * 0.14, 0.07);
    let end = 40.0;
    let mut exact = start(&inside);
    exact.do_step(0.0, end).unwrap();
    let expected = [
        real(&exact, "node[1156].heave"),
        real(&exact, "damper[1].stroke"),
    ];
    let run = |steps: u32| {
        let mut slave = start(&outside);
        let h = end / f64::from(steps);
        let node = |slave: &Slave| {
            ["heave", "heave_rate"].map(|of| real(slave, &format!("node[1156].{of}")))
        };
        let (mut u, mut v) = (node(&slave)[0], 0.0);
        for n in 0..steps {
            let [y, rate] = node(&slave);
            let force = mass * (omega * omega * (u - y) + 2.0 * zeta * omega * (v - rate));
            set(&mut slave, "node[1156].external_lift", force);
            slave.do_step(f64::from(n) * h, h).unwrap();
            v -= h * force / mass;
            u += h * v;
        }
        let y = node(&slave)[0];
        [y, u - y]
    };
    let [coarse, fine] = [4000, 8000].map(run);
    for i in 0..2 {
        let errors = [coarse[i] - expected[i], fine[i] - expected[i]];
        let extrapolated = 2.0 * fine[i] - coarse[i] - expected[i];
        eprintln!("{expected:?}: {errors:?}, {extrapolated}");
        assert!((errors[0] / errors[1] - 2.0).abs() < 0.1, "{errors:?}");
        assert!(extrapolated.abs() < 2e-4 * 0.5, "{extrapolated}");
    }
}

/// Where dampers are tuned so that another motion becomes critical, that is the onset, also where it is damped again before that
/// which was critical: what a search finds.
#[test]
fn the_onset_of_another_motion_is_followed() {
    let search = OnsetSearch {
        speeds: 60,
        ..crate::bridges::SEARCH
    };
    for mass in ["60e3", "120e3"] {
        let pair = format!(
            "[[damper]]\nnode = \"1156\"\nmotion = \"torsion\"\narm_m = 13.0\nmass_kg = {mass}\nfrequency_hz = 0.32\ndamping_ratio = 0.1\n"
        );
        let study = read(&(langenuen_text("LN21-5200", TWO, "modified_akima") + &pair));
        let (model, export) = study.export(&BridgeExportOptions::default()).unwrap();
        let fmu = opened(&model, export);
        let mut slave = fmu.instantiate("bridge").unwrap();
        slave.enter_initialization(0.0, None, None).unwrap();
        slave.exit_initialization().unwrap();
        let mut tuned = study.by_model.clone();
        // onsets at 0.22, 0.30 and 0.32 Hz
        for hertz in [0.32, 0.31, 0.30, 0.33, 0.315, 0.305, 0.31] {
            for (d, damper) in tuned.dampers.masses.iter_mut().enumerate() {
                damper.frequency_hz = hertz;
                set(&mut slave, &format!("damper[{}].frequency", d + 1), hertz);
            }
            let start = Instant::now();
            let found = ["onset_speed", "onset_frequency"].map(|of| real(&slave, of));
            let took = start.elapsed();
            let searched = find_onset("bridge", &coupled(&tuned), &search, None).unwrap();
            let expected = &searched.onset().unwrap().at;
            let expected = [expected.speed_m_s, expected.frequency_hz];
            eprintln!("{mass} kg, {hertz} Hz: {found:?} in {took:?}, searched {expected:?}");
            for (found, expected) in found.iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
            }
        }
    }
}

/// The structure of a system has the dampers, and they may be set there; the forces know nothing of them.
#[test]
fn dampers_are_part_of_the_structure_of_a_system() {
    let study = damped();
    let verdict = study.verdict().unwrap();
    let runtimes = [Runtime::embedded().unwrap()];
    let wanted = BridgeExportOptions::default();
    let system = study
        .system(&wanted, &verdict, &runtimes, &Label::default())
        .unwrap();
    let of = |i: usize, name: &str| {
        let mut values = system.components[i].values.iter();
        values.find(|(n, _)| n == name).map(|(_, value)| *value)
    };
    assert_eq!(of(0, "damper[2].mass"), Some(30e3));
    assert_eq!(of(0, "damper[3].frequency"), Some(0.055));
    assert_eq!(of(0, "link[1].coefficient"), Some(1e5));
    assert_eq!(of(1, "damper[1].mass"), None);
    // forces on nodes and motion of nodes, as without dampers
    assert_eq!(system.connections.len(), 6 * study.by_model.nodes.len());
}

/// FMI 3.0: dampers are arrays; and what lies in an archive without dampers knows nothing of them.
#[test]
fn dampers_are_arrays_in_fmi_3() {
    let (model, export) = damped().export(&BridgeExportOptions::default()).unwrap();
    let (model, bridge) = (
        model.to_json().unwrap(),
        export.bridge.unwrap().to_json().unwrap(),
    );
    let resources = Resources::of_bridge(model.as_bytes(), bridge.as_bytes(), None).unwrap();
    let text = model_description(&resources, &Label::default()).unwrap();
    for name in [
        "damper.stroke",
        "damper.mass",
        "damper.frequency",
        "damper.damping_ratio",
        "damper.normalised_rate",
        "link.coefficient",
    ] {
        assert!(text.contains(&format!("name=\"{name}\"")), "{name}");
    }
    let (_, plain) = lively().export(&BridgeExportOptions::default()).unwrap();
    assert!(!plain.bridge.unwrap().to_json().unwrap().contains("damper"));
}
