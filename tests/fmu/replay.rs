//! Reference runs in the archives: every kind of unit of both versions repeats them, is found without fault, and tells what was spoilt.

use crate::bridges::{TWO, langenuen_text, read};
use crate::matrix_fmus;
use aerodeck::fmu::importer::{Fmu, ReplayedRun, replay};
use aerodeck::fmu::package::{Export, FmiVersion, Runtime, package};
use aerodeck::study::bridge::BridgeExportOptions;
use std::path::Path;

/// What the runs of an archive differ by; every finding and every trial is asked for as well.
fn judged(file: &Path) -> Vec<ReplayedRun> {
    let fmu = Fmu::open(file).unwrap();
    let report = fmu.check();
    assert!(report.passed(), "{}: {report:#?}", file.display());
    assert_eq!(report.findings, [], "{}", file.display());
    let state = report.trials.iter().find(|t| t.name.contains("restored"));
    let state = state.unwrap();
    assert!(
        state.detail.contains("identical"),
        "{}: {state:?}",
        file.display()
    );
    let runs = replay(&fmu).unwrap();
    assert!(runs.len() >= 4, "{}: {runs:#?}", file.display());
    runs
}

/// All decks and all sections, one made bluff, and forces alone; this machine computes what it computed at the export.
#[test]
fn units_of_every_deck_repeat_their_runs() {
    let folder = tempfile::tempdir().unwrap();
    let runtimes = [Runtime::embedded().unwrap()];
    matrix_fmus::export(folder.path(), &runtimes, |deck, section| {
        section == (deck + 1) % 5 || deck + section == 0
    });
    let files = std::fs::read_dir(folder.path()).unwrap();
    let mut count = 0;
    for file in files.map(|entry| entry.unwrap().path()) {
        for run in judged(&file) {
            assert_eq!(run.difference, 0.0, "{}: {run:#?}", file.display());
            assert!(run.values > 100);
        }
        count += 1;
    }
    assert_eq!(count, 18);
}

#[test]
fn a_bridge_repeats_its_runs() {
    let study = read(&langenuen_text("LN21-5200", TWO, "linear_v_hat"));
    let (model, export) = study
        .export(&BridgeExportOptions {
            allow_unstable: true,
            ..BridgeExportOptions::default()
        })
        .unwrap();
    let folder = tempfile::tempdir().unwrap();
    for version in [FmiVersion::Two, FmiVersion::Three] {
        let runtimes = [Runtime::embedded().unwrap()];
        let [bytes, again] = [(); 2].map(|()| {
            let export = Export {
                version,
                ..export.clone()
            };
            package(&model, &runtimes, export).unwrap()
        });
        assert!(bytes == again);
        let file = folder.path().join(format!("{version:?}.fmu"));
        std::fs::write(&file, bytes).unwrap();
        for run in judged(&file) {
            // the onset is followed from the last search
            assert!(run.difference < 1e-9, "{run:#?}");
        }
    }
}
