//! From a raw campaign on disk to an onset, by the command line alone; what is wrong in it is said.

#[path = "common/command.rs"]
#[allow(dead_code)] // each test file needs a part of it
mod command;

use command::{refused, succeeds};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

fn json(path: impl AsRef<std::path::Path>) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn a_campaign_becomes_records_derivatives_and_an_onset() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(
        at,
        &[
            "campaign",
            "virtual",
            "LN21-5200",
            "--seed",
            "4",
            "--out",
            "raw",
        ],
    );
    let text = succeeds(at, &["process", "raw/campaign.toml", "--out", "results"]);
    for word in [
        "lag of the force channels",
        "test points",
        "replaced: spike",
        "8 derivatives",
    ] {
        assert!(text.contains(word), "`{word}` is not in:\n{text}");
    }
    let out = at.join("results");
    let report = json(out.join("processing.json"));
    // 1.7 ms is what the virtual campaign applies
    assert!((report["lag_s"].as_f64().unwrap() - 1.7e-3).abs() < 5e-5);
    let runs = report["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 4);
    for run in runs {
        let name = run["run"].as_str().unwrap();
        for file in [
            format!("records/{name}.csv"),
            format!("processing/{name}.svg"),
            format!("processing/{name}.png"),
        ] {
            assert!(out.join(&file).is_file(), "{file}");
        }
        assert_eq!(run["segments"].as_array().unwrap().len(), 8);
    }
    let derivatives = json(out.join("derivatives.json"));
    let estimates = derivatives["estimates"].as_array().unwrap();
    assert_eq!(estimates.len(), 8 * 16);
    assert!(
        estimates
            .iter()
            .all(|e| e["standard_error"].as_f64().unwrap() > 0.0)
    );
    // the workbook is one that the program reads, and the study gives an onset
    let table =
        aerodeck::aerodynamics::derivatives::read_table(out.join("derivatives.csv")).unwrap();
    let options = aerodeck::aerodynamics::derivatives::WorkbookOptions {
        width_m: Some(table.width_m),
        ..Default::default()
    };
    let book = aerodeck::aerodynamics::derivatives::read_workbook(
        out.join("AerodynamicDerivatives_LN21-5200.xlsx"),
        &options,
    )
    .unwrap();
    assert!(book.derivatives().eq(table.derivatives()));
    succeeds(at, &["study", "results/study.toml"]);
    let summary = json(out.join("summary.json"));
    let laguerre = command::onset_of(&summary, "Laguerre", "eigenvalues");
    // clean records give 37.01 m/s with the width of the model and the air of the runs
    let speed = laguerre["speed_m_s"].as_f64().unwrap();
    assert!((speed - 37.01).abs() < 0.6, "{speed}");
}

#[test]
fn wrong_options_and_campaigns_are_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(
        at,
        &[
            "campaign",
            "virtual",
            "LN21-5200",
            "--clean",
            "--out",
            "raw",
        ],
    );
    let process = |more: &[&str], fragments: &[&str]| {
        let mut args = vec!["process", "raw/campaign.toml", "--out", "results"];
        args.extend(more);
        refused(at, &args, fragments);
    };
    process(
        &["--cutoff-hz", "150"],
        &["run ", "below the Nyquist frequency, 100 Hz at 200 Hz"],
    );
    fs::write(at.join("options.toml"), "drift_degree = 99\n").unwrap();
    process(&["--options", "options.toml"], &["processing.drift_degree"]);
    fs::write(at.join("options.toml"), "[low_pas]\norder = 2\n").unwrap();
    process(&["--options", "options.toml"], &["options.toml", "low_pas"]);
}
