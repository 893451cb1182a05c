//! FMUs of whole bridges: what their parameters change, and bridges that are not as most.

use crate::bridges::{SEARCH, TWO, coupled, langenuen, langenuen_text, lively, read};
use aerodeck::flutter::{OnsetSearch, find_onset};
use aerodeck::fmu::importer::{CheckReport, Fmu, Slave, Value};
use aerodeck::fmu::package::{Export, Runtime, package, write_archive};
use aerodeck::study::bridge::BridgeExportOptions;
use aerodeck::trained_model::TrainedModel;
use std::time::{Duration, Instant};

fn opened(model: &TrainedModel, export: &Export) -> (tempfile::TempDir, Fmu) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bridge.fmu");
    let runtimes = [Runtime::embedded().unwrap()];
    let bytes = package(model, &runtimes, export.clone()).unwrap();
    write_archive(&path, &bytes, false).unwrap();
    let fmu = Fmu::open(&path).unwrap();
    (folder, fmu)
}

fn timed(slave: &Slave, name: &str) -> (f64, Duration) {
    let start = Instant::now();
    match slave.get(name).unwrap() {
        Value::Real(value) => (value, start.elapsed()),
        other => panic!("{name} is {other}"),
    }
}

/// The onset that is read first after a parameter was set is that of the parameter, found by eigenvalues in another bridge.
#[test]
fn the_onset_is_that_of_the_parameters() {
    let study = langenuen("LN21-5200", TWO);
    let (model, export) = study.export(&BridgeExportOptions::default()).unwrap();
    assert!(export.bridge.as_ref().unwrap().onset.is_some());
    let (_folder, fmu) = opened(&model, &export);
    let mut slave = fmu.instantiate("bridge").unwrap();
    slave.enter_initialization(0.0, None, None).unwrap();
    slave.exit_initialization().unwrap();
    let (_, damping) = timed(&slave, "damping_now");
    let (_, again) = timed(&slave, "damping_now");
    eprintln!("damping_now: {damping:?}, once more {again:?}");
    let own = export.bridge.as_ref().unwrap().air_density_kg_m3;
    for density in [own, 1.6, 1.2, 2.0] {
        slave.set("air_density", &Value::Real(density)).unwrap();
        let (found, took) = timed(&slave, "onset_speed");
        let mut other = study.by_model.clone();
        other.air_density_kg_m3 = density;
        let search = OnsetSearch {
            speeds: 60,
            ..SEARCH
        };
        let expected = find_onset("bridge", &coupled(&other), &search, None).unwrap();
        let expected = expected.onset().unwrap().at.speed_m_s;
        eprintln!("{density} kg/m³: {found} m/s in {took:?}, searched {expected}");
        // a motion that is followed settles to 1e-9
        assert!((found / expected - 1.0).abs() < 1e-8, "{found}, {expected}");
    }
}

/// The smallest damping in winds that go up, down and far, below and above the onset, and after a parameter: that of all
/// eigenvalues of another bridge, whatever was read before.
#[test]
fn the_damping_is_that_of_the_present_wind() {
    for (study, tolerance) in [(langenuen("LN21-5200", TWO), 1e-9), (lively(), 1e-11)] {
        let (model, export) = study.export(&BridgeExportOptions::default()).unwrap();
        let (_folder, fmu) = opened(&model, &export);
        let mut slave = fmu.instantiate("bridge").unwrap();
        slave.enter_initialization(0.0, None, None).unwrap();
        slave.exit_initialization().unwrap();
        let own = export.bridge.as_ref().unwrap().air_density_kg_m3;
        for density in [own, 1.6, own] {
            slave.set("air_density", &Value::Real(density)).unwrap();
            let mut other = study.by_model.clone();
            other.air_density_kg_m3 = density;
            let section = coupled(&other);
            for wind in [30.0, 30.25, 30.0, 44.0, 61.0, 95.0, 60.0, 3.0, 0.0, 12.0] {
                slave.set("wind_speed", &Value::Real(wind)).unwrap();
                let (found, took) = timed(&slave, "damping_now");
                let all = section.at(wind).unwrap().eigenvalues().unwrap();
                let oscillating = all.iter().filter(|z| z.im > 0.0);
                let expected = oscillating.map(|z| -z.re / z.norm()).fold(1.0, f64::min);
                eprintln!("{density} kg/m³, {wind} m/s: {found} in {took:?}");
                assert!(
                    (found - expected).abs() < tolerance,
                    "{density} kg/m³, {wind} m/s: {found}, {expected}"
                );
            }
        }
    }
}

/// The numbers of the modes that move mainly so: vertical 0, lateral 1, rotation 2.
fn modes_in(motion: usize) -> Vec<usize> {
    let study = langenuen("LN21-5200", TWO);
    let half = 0.5 * study.by_model.width_m();
    let main = |shape: &[[f64; 3]]| {
        let scale = [1.0, 1.0, half];
        let sum = |i: usize| shape.iter().map(|s| (s[i] * scale[i]).powi(2)).sum::<f64>();
        (0..3).max_by(|a, b| sum(*a).total_cmp(&sum(*b))).unwrap()
    };
    let modes = study.by_model.modes.iter();
    modes
        .filter(|m| main(&m.shape) == motion)
        .map(|m| m.number)
        .take(3)
        .collect()
}

fn checked(model: &TrainedModel, export: &Export) -> (CheckReport, Fmu) {
    let (_folder, fmu) = opened(model, export);
    let report = fmu.check();
    assert!(report.passed(), "{report:#?}");
    assert!(report.ran.is_some());
    (report, fmu)
}

/// A bridge of torsional modes alone, with all variables and with real ones; its filters are those of all modes.
#[test]
fn a_bridge_of_torsional_modes_is_exported() {
    let select = format!("damping_ratio = 0.002\nselect = {:?}", modes_in(2));
    let text = langenuen_text("LN21-5200", TWO, "linear_v_hat");
    let study = read(&text.replace("damping_ratio = 0.002", &select));
    assert_eq!(study.by_model.modes.len(), 3);
    let (model, mut export) = study
        .export(&BridgeExportOptions {
            allow_unstable: true,
            ..BridgeExportOptions::default()
        })
        .unwrap();
    let (_, fmu) = checked(&model, &export);
    let filters = fmu.model_description().variable("filters").unwrap();
    let of_all = coupled(&study.by_model).aerodynamics().states();
    assert_eq!(filters.start, Some(Value::Integer(of_all as i32)));
    export.reals_only = true;
    let (_, fmu) = checked(&model, &export);
    assert!(fmu.model_description().variable("filters").is_none());
    assert!(fmu.model_description().variable("flutter_speed").is_some());
}
