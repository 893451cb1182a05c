//! Files of results in JSON say what they are.

use crate::command::{refused, succeeds};
use std::fs;
use tempfile::TempDir;

/// Every file of results in JSON says what it is, and is taken for nothing else.
#[test]
fn files_say_what_they_are() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--deck", "flat plate"]);
    succeeds(at, &["study", "study.toml", "--out", "a"]);
    for (file, kind) in [
        ("model.json", "model"),
        ("models/laguerre.json", "model"),
        ("fits/laguerre.json", "fit"),
        ("fits/laguerre.uncertainty.json", "uncertainty"),
        ("summary.json", "summary"),
    ] {
        let text = fs::read_to_string(at.join("a").join(file)).unwrap();
        let start = format!("{{\n  \"format\": \"{}\",\n", aerodeck::json::format(kind));
        assert!(text.starts_with(&start), "{file}");
    }
    let line = ["simulate", "a/fits/laguerre.json", "--wind-speed", "9"];
    refused(at, &line, &["found JSON of the format `aerodeck/fit 1`"]);
    // a file of before is read as it is
    let model = fs::read_to_string(at.join("a/model.json")).unwrap();
    let before = model.replacen("  \"format\": \"aerodeck/model 1\",\n", "", 1);
    assert_ne!(before, model);
    fs::write(at.join("a/before.json"), before).unwrap();
    let simulated = ["a/model.json", "a/before.json"].map(|file| {
        let line = ["simulate", file, "--wind-speed", "9", "--stop-time", "1"];
        succeeds(at, &line);
        fs::read(at.join("a/simulation.csv")).unwrap()
    });
    assert_eq!(simulated[0], simulated[1]);
}
