//! The matrix as archives: every deck on every section, made bluff as well, in gusts, through both shells.

use crate::matrix::{NamedSection, decks, made_bluff, sections};
use aerodeck::aerodynamics::derivatives::DerivativeTable;
use aerodeck::aerodynamics::{GustForce, RationalAdmittance};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::flutter::{FlutterSearch, OnsetSearch, find_onset};
use aerodeck::fmu::force_options::ForceOptions;
use aerodeck::fmu::package::{Export, FmiVersion, Runtime, write_fmu};
use aerodeck::identification::{Fitted, Form, FrequencyFit, fit_table};
use aerodeck::trained_model::{Experiment, Provenance, SCHEMA_VERSION, TrainedModel};
use serde_json::{Value, json};
use std::path::Path;

/// Writes the archives of the cells (deck, section) that are wanted and returns what is expected of them, one object per cell.
pub fn export(folder: &Path, runtimes: &[Runtime], wanted: fn(usize, usize) -> bool) -> Value {
    let mut cells = Vec::new();
    for (i, deck) in decks().iter().enumerate() {
        for (j, section) in sections().iter().enumerate() {
            if !wanted(i, j) {
                continue;
            }
            let table = if i == j { &made_bluff(deck) } else { deck };
            // both forms on every deck and on every section
            let form = if (i + j) % 2 == 0 {
                Form::default()
            } else {
                Form::Rational {
                    lags: 2,
                    added_mass: true,
                }
            };
            let name = format!("matrix_{i}_{j}");
            cells.push(cell(&name, table, section, form, folder, runtimes));
        }
    }
    cells.into()
}

fn cell(
    name: &str,
    table: &DerivativeTable,
    section: &NamedSection,
    form: Form,
    folder: &Path,
    runtimes: &[Runtime],
) -> Value {
    let model = trained(table, section, form);
    let structure = model.section.structure().unwrap();
    let coupled = CoupledSection::with_model(&structure, &model.model).unwrap();
    let search = OnsetSearch {
        speed_max_m_s: model.experiment.onset_search_limit_m_s,
        ..OnsetSearch::default()
    };
    let within = |tested| find_onset(name, &coupled, &search, tested).unwrap();
    // a bluff deck grows at the lowest speed that was tested: its unit then states the onset of the model as it is
    let tested = within(Some(model.tested_range));
    let answered = tested.onset().is_some();
    let found = if answered { tested } else { within(None) };
    let at = match &found {
        FlutterSearch::Onset(onset) => &onset.at,
        FlutterSearch::UnstableAtOrBelow(start) => &start.at,
        other => panic!("{name}: {}", other.explain()),
    };
    for (shell, version) in [("fmi2", FmiVersion::Two), ("fmi3", FmiVersion::Three)] {
        let export = Export {
            gusts: Some(plate_gusts(&model)),
            version,
            allow_unstable: true,
            ..Export::default()
        };
        let fmu = folder.join(format!("{name}_{shell}.fmu"));
        write_fmu(&fmu, &model, runtimes, false, export).unwrap();
    }
    let forces = Export {
        gusts: Some(plate_gusts(&model)),
        force: Some(ForceOptions::single(model.section.width_m)),
        allow_unstable: true,
        ..Export::default()
    };
    let fmu = folder.join(format!("{name}_force.fmu"));
    write_fmu(&fmu, &model, runtimes, false, forces).unwrap();
    json!({
        "fmu": name, "what": format!("{}, {}", model.name, section.name), "answered": answered,
        "speed_m_s": at.speed_m_s, "frequency_hz": at.frequency_hz, "motions": model.section.dofs().len(),
    })
}

/// Lift and moment of a thin plate in gusts through Liepmann's function; drag of a coefficient of one.
pub fn plate_gusts(model: &TrainedModel) -> GustForce {
    let tau = std::f64::consts::TAU;
    let [lift, drag, moment] = [[0.0, tau], [2.0, 0.0], [0.0, 0.25 * tau]];
    let dofs = model.section.dofs();
    let coefficients = match dofs.len() {
        2 => vec![lift, moment],
        _ => vec![lift, drag, moment],
    };
    GustForce {
        dofs,
        coefficients,
        admittance: RationalAdmittance::Liepmann,
        source: "thin plate".into(),
    }
}

fn trained(table: &DerivativeTable, named: &NamedSection, form: Form) -> TrainedModel {
    let section = named.section.clone();
    let dofs = section.dofs();
    let fit = FrequencyFit {
        form,
        ..FrequencyFit::default()
    };
    let Fitted { model, report } = fit_table(&table.samples(&dofs), &dofs, &fit).unwrap();
    TrainedModel {
        schema_version: SCHEMA_VERSION,
        name: table.name.clone(),
        section,
        model,
        tested_range: report.tested_range,
        provenance: Provenance {
            source: "measured derivatives".into(),
            licence: "as of the data".into(),
            method: report.method,
            aerodeck_version: env!("CARGO_PKG_VERSION").into(),
            notes: report.notes,
        },
        experiment: Experiment {
            wind_speed_m_s: 10.0,
            initial_vertical_m: 0.01,
            initial_rotation_rad: 0.01,
            stop_time_s: 10.0,
            step_size_s: 0.01,
            onset_search_limit_m_s: 120.0,
        },
    }
}
