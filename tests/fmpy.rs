//! Exports FMUs and lets FMPy, the importer most people use, judge and step them.
//!
//! Writes one FMU per model and `expected.json` (what the same models give in process) to a folder below the target
//! directory, then runs `tests/fmpy` with pytest in an environment of its own; see `common/python.rs`.
#[path = "common/bridge_fmu.rs"]
mod bridge_fmu;
#[allow(dead_code)] // the FMUs need one bridge
#[path = "common/bridges.rs"]
mod bridges;
#[path = "common/component.rs"]
mod component;
#[path = "common/in_process.rs"]
mod in_process;
#[path = "common/matrix.rs"]
#[allow(dead_code)] // its cells alone
mod matrix;
#[path = "common/matrix_fmus.rs"]
mod matrix_fmus;
#[path = "common/models.rs"]
#[allow(dead_code)] // how the fixtures are made is not needed here
mod models;
#[path = "common/patchwork.rs"]
mod patchwork;
#[path = "common/python.rs"]
mod python;
#[path = "common/three_dof.rs"]
#[allow(dead_code)] // one model of several
mod three_dof;

use aerodeck::aerodynamics::{GustForce, RationalAdmittance};
use aerodeck::files::derivatives::embedded;
use aerodeck::fmu::force_options::ForceOptions;
use aerodeck::fmu::package::{Export, FmiVersion, Runtime, write_fmu};
use aerodeck::identification::{Fitted, Form, FrequencyFit, fit_table};
use aerodeck::section::{Dof, SectionModel};
use aerodeck::trained_model::{Experiment, Provenance, SCHEMA_VERSION, TrainedModel};
use serde_json::{Map, Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The deck LN21-5200 with the section of Table 4.1, trained here on its measured derivatives.
fn measured_deck(form: Form) -> TrainedModel {
    let table = embedded::deck("LN21-5200").unwrap();
    let fit = FrequencyFit {
        form,
        ..FrequencyFit::default()
    };
    let Fitted { model, report } = fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &fit).unwrap();
    TrainedModel {
        schema_version: SCHEMA_VERSION,
        name: "LN21-5200".into(),
        section: SectionModel::table_4_1(),
        model,
        tested_range: report.tested_range,
        provenance: Provenance {
            source: "LN21-5200, measured derivatives".into(),
            licence: "as of the data".into(),
            method: report.method,
            aerodeck_version: env!("CARGO_PKG_VERSION").into(),
            notes: report.notes,
        },
        experiment: Experiment {
            wind_speed_m_s: 35.0,
            initial_vertical_m: 0.01,
            initial_rotation_rad: 0.01,
            stop_time_s: 10.0,
            step_size_s: 0.01,
            onset_search_limit_m_s: 80.0,
        },
    }
}

/// Writes the FMUs and what is expected of them.
fn export() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fmpy");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let runtimes = [Runtime::embedded().unwrap()];
    let mut expected = Map::new();
    let mut export = |name: &str, model: &TrainedModel, golden: Option<&Path>| {
        let fmu = folder.join(format!("{name}.fmu"));
        write_fmu(
            &fmu,
            model,
            &runtimes,
            false,
            Export {
                allow_unstable: true,
                ..Export::default()
            },
        )
        .unwrap();
        expected.insert(name.into(), in_process::expectations(model, golden));
    };
    for kind in models::KINDS {
        let text = fs::read_to_string(models::model_file(kind)).unwrap();
        let golden = format!("{}/modelDescription/{kind}.xml", env!("CARGO_MANIFEST_DIR"));
        let model = TrainedModel::from_json(&text).unwrap();
        export(kind, &model, Some(Path::new(&golden)));
    }
    let lag = Form::Rational {
        lags: 1,
        added_mass: false,
    };
    export("measured_laguerre", &measured_deck(Form::default()), None);
    export("measured_rational", &measured_deck(lag), None);
    let lateral = three_dof::trained(Form::default(), 3.9);
    let fmu = folder.join("three_dof.fmu");
    write_fmu(
        &fmu,
        &lateral,
        &runtimes,
        false,
        Export {
            allow_unstable: true,
            ..Export::default()
        },
    )
    .unwrap();
    export_forces(&folder, &runtimes);
    export_gusts(&folder, &runtimes);
    export_reals(&folder, &runtimes);
    export_fmi3(&folder, &runtimes);
    bridge_fmu::export(&folder, &runtimes);
    let files = models::KINDS.map(models::model_file);
    let named = models::KINDS.iter().zip(&files);
    let named: Vec<(&str, &Path)> = named.map(|(kind, file)| (*kind, file.as_ref())).collect();
    component::export(&folder, &named);
    let matrix = matrix_fmus::export(&folder, &runtimes, |_, _| true);
    let text = serde_json::to_string(&json!({
        "matrix": matrix, "models": Value::Object(expected), "three_dof": in_process::three_dof(&lateral),
    }))
    .unwrap();
    fs::write(folder.join("expected.json"), text).unwrap();
    folder
}

/// The full-scale section of a flat plate, and its forces alone on one strip and on three.
fn export_forces(folder: &Path, runtimes: &[Runtime]) {
    let text = fs::read_to_string(models::model_file("rational")).unwrap();
    let mut model = TrainedModel::from_json(&text).unwrap();
    model.section = SectionModel::iabse_1_1a();
    let fmu = folder.join("full_scale.fmu");
    write_fmu(&fmu, &model, runtimes, false, Export::default()).unwrap();
    let single = ForceOptions::single(model.section.width_m);
    let strips = ForceOptions {
        strips: vec![single.strips[0].clone(); 3],
        named_strips: true,
        ..single.clone()
    };
    for (name, options) in [("force", single), ("force_strips", strips)] {
        let export = Export {
            force: Some(options),
            ..Export::default()
        };
        let fmu = folder.join(format!("{name}.fmu"));
        write_fmu(&fmu, &model, runtimes, false, export).unwrap();
    }
}

/// The section and its forces again, with gusts that act as on a plate through Sears's function.
fn export_gusts(folder: &Path, runtimes: &[Runtime]) {
    let text = fs::read_to_string(models::model_file("rational")).unwrap();
    let mut model = TrainedModel::from_json(&text).unwrap();
    model.section = SectionModel::iabse_1_1a();
    let tau = std::f64::consts::TAU;
    let gusts = GustForce {
        dofs: Dof::TWO.to_vec(),
        coefficients: vec![[0.0, tau], [0.0, 0.25 * tau]],
        admittance: RationalAdmittance::Sears,
        source: "thin plate".into(),
    };
    let forces = ForceOptions::single(model.section.width_m);
    for (name, force) in [("gusts_section", None), ("gusts_force", Some(forces))] {
        let export = Export {
            force,
            gusts: Some(gusts.clone()),
            ..Export::default()
        };
        let fmu = folder.join(format!("{name}.fmu"));
        write_fmu(&fmu, &model, runtimes, false, export).unwrap();
    }
}

/// Every kind in FMI 3.0, and the forces on three strips in both versions.
fn export_fmi3(folder: &Path, runtimes: &[Runtime]) {
    for kind in models::KINDS {
        let text = fs::read_to_string(models::model_file(kind)).unwrap();
        let model = TrainedModel::from_json(&text).unwrap();
        let single = ForceOptions::single(model.section.width_m);
        let strips = ForceOptions {
            strips: vec![single.strips[0].clone(); 3],
            named_strips: true,
            ..single
        };
        for (unit, force, version) in [
            ("fmi3_section", None, FmiVersion::Three),
            ("fmi3_force", Some(strips.clone()), FmiVersion::Three),
            ("fmi2_force", Some(strips), FmiVersion::Two),
        ] {
            let export = Export {
                force,
                version,
                allow_unstable: true,
                ..Export::default()
            };
            let fmu = folder.join(format!("{unit}_{kind}.fmu"));
            write_fmu(&fmu, &model, runtimes, false, export).unwrap();
        }
    }
}

/// Every kind once more, with its real variables alone.
fn export_reals(folder: &Path, runtimes: &[Runtime]) {
    for kind in models::KINDS {
        let text = fs::read_to_string(models::model_file(kind)).unwrap();
        let model = TrainedModel::from_json(&text).unwrap();
        let forces = ForceOptions::single(model.section.width_m);
        for (unit, force) in [("section", None), ("force", Some(forces))] {
            let export = Export {
                force,
                reals_only: true,
                allow_unstable: true,
                ..Export::default()
            };
            let fmu = folder.join(format!("reals_{unit}_{kind}.fmu"));
            write_fmu(&fmu, &model, runtimes, false, export).unwrap();
        }
    }
}

/// The number in front of `passed` in pytest's last lines.
fn passed(output: &str) -> usize {
    let words: Vec<_> = output.split_whitespace().collect();
    let before = |at: usize| words[at.checked_sub(1)?].parse().ok();
    (0..words.len())
        .rev()
        .filter(|&at| words[at].trim_end_matches(',') == "passed")
        .find_map(before)
        .unwrap_or(0)
}

#[test]
fn fmpy_validates_and_steps_the_exported_fmus() {
    let python = python::interpreter().unwrap_or_else(|message| panic!("{message}"));
    let suite = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fmpy");
    let output = Command::new(&python)
        .args(python::PYTEST)
        .arg("--color=no")
        .arg(&suite)
        .env("AERODECK_FMUS", export())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("PYTHONUTF8", "1")
        .output()
        .unwrap();
    let said = format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(output.status.success(), "{}:\n{said}", output.status);
    assert!(passed(&said) > 0, "nothing was tested:\n{said}");
    println!("{said}");
}
