//! The commands on whole bridges: what they print and write, and what they refuse.

#[allow(dead_code)]
#[path = "common/bridges.rs"]
mod bridges;
#[path = "common/command.rs"]
#[allow(dead_code)] // each test file needs a part of it
mod command;

use bridges::{TWO, langenuen_text};
use command::{listing, refused, succeeds};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// The modes that carry the flutter of Langenuen, so that a run takes a second.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let text = langenuen_text("LN21-5200", TWO, "modified_akima").replace(
        "damping_ratio",
        "select = [2, 3, 5, 12, 14, 16, 17, 23]\ndamping_ratio",
    );
    fs::write(folder.path().join("bridge.toml"), text).unwrap();
    folder
}

#[test]
fn flutter_prints_its_card_and_writes_its_figures() {
    let folder = folder();
    let text = succeeds(
        folder.path(),
        &["bridge", "flutter", "bridge.toml", "--samples", "20"],
    );
    for part in [
        "Onset card: tables between their points",
        "Onset card: model",
        "inside the tested range",
        "of the kinetic energy",
        "Onset with fewer modes",
        "Divergence of the model",
        "Scatter of 20 samples",
    ] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
    let written = listing(folder.path());
    for name in [
        "bridge_flutter.svg",
        "bridge_curves.csv",
        "flutter_motion.png",
        "flutter_motion.csv",
        "flutter_animation.csv",
    ] {
        assert!(written.iter().any(|w| w == name), "{name}");
    }
    let animation = fs::read_to_string(folder.path().join("flutter_animation.csv")).unwrap();
    // 24 phases of 63 nodes and the heading
    assert_eq!(animation.lines().count(), 24 * 63 + 1);
}

#[test]
fn results_are_json_for_machines() {
    let folder = folder();
    let text = succeeds(
        folder.path(),
        &["bridge", "flutter", "bridge.toml", "--json"],
    );
    let value: Value = serde_json::from_str(&text).unwrap();
    let answers = value["flutter"]["answers"].as_array().unwrap();
    assert_eq!(answers.len(), 2);
    for answer in answers {
        let speed = answer["search"]["onset"]["speed_m_s"].as_f64().unwrap();
        // eight modes of 39 stand 1 % above all of them
        assert!((75.0..80.0).contains(&speed), "{speed}");
        let shares = answer["motion"]["modes"].as_array().unwrap();
        assert_eq!(shares.len(), 8);
    }
    let text = succeeds(folder.path(), &["bridge", "show", "bridge.toml", "--json"]);
    let value: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["modes"].as_array().unwrap().len(), 8);
    let similarity = &value["similarities"][0]["similarity"];
    assert!((0.0..=1.0).contains(&similarity.as_f64().unwrap()));
}

#[test]
fn converted_modes_give_the_same_bridge() {
    let folder = folder();
    succeeds(
        folder.path(),
        &["bridge", "convert", "bridge.toml", "modes.csv"],
    );
    let text = fs::read_to_string(folder.path().join("bridge.toml")).unwrap();
    let text = text
        .replace("\"embedded\"", "\"csv\"")
        .replace("\"langenuen\"", "\"modes.csv\"");
    fs::write(folder.path().join("again.toml"), text).unwrap();
    let show = |file: &str| {
        let text = succeeds(folder.path(), &["bridge", "show", file, "--json"]);
        let value: Value = serde_json::from_str(&text).unwrap();
        (value["modes"].clone(), value["similarities"].clone())
    };
    assert_eq!(show("bridge.toml"), show("again.toml"));
}

#[test]
fn an_exported_bridge_passes_the_check() {
    let folder = folder();
    let export = [
        "fmu",
        "export",
        "bridge.toml",
        "--bridge",
        "--nodes",
        "1156",
    ];
    let text = succeeds(folder.path(), &export);
    assert!(text.contains("8 modes") && text.contains("1156"), "{text}");
    let text = succeeds(folder.path(), &["fmu", "check", "bridge.fmu"]);
    assert!(text.ends_with("passed\n"), "{text}");
    refused(folder.path(), &export, &["expected no file there yet"]);
    refused(
        folder.path(),
        &[
            "fmu",
            "export",
            "bridge.toml",
            "--bridge",
            "--nodes",
            "7",
            "--force",
        ],
        &["nodes: expected nodes of the bridge, 1001 to 1311, found `7`"],
    );
}

#[test]
fn what_is_missing_is_named() {
    let folder = folder();
    refused(
        folder.path(),
        &["bridge", "buffeting", "bridge.toml", "--speed", "30"],
        &["bridge.toml", "expected a block [buffeting]"],
    );
    refused(
        folder.path(),
        &["bridge", "flutter", "nothing.toml"],
        &["nothing.toml"],
    );
}
