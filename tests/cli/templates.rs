//! Files to begin with.

use crate::command::{aerodeck, refused, succeeds};
use std::io::Write;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// Files of a bridge and of wind to begin with: they run as they are, and what is commented is understood when it is switched on.
#[test]
fn new_files_of_bridge_and_wind_run_as_they_are() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--bridge"]);
    let text = std::fs::read_to_string(at.join("bridge.toml")).unwrap();
    // eight modes are quicker than all
    let few = text.replace(
        "# select = [1, 2, 3, 23] ",
        "select = [2, 3, 5, 12, 14, 16, 17, 23] ",
    );
    let switched_on = |line: &str| {
        let keys = [
            "# static",
            "# [wind]",
            "# profile",
            "# required",
            "# [buff",
            "# nodes",
            "# along",
            "# vertical",
        ];
        match keys.iter().any(|key| line.starts_with(key)) {
            true => line.replacen("# ", "", 1),
            false => line.to_owned(),
        }
    };
    let all: Vec<String> = few.lines().map(switched_on).collect();
    std::fs::write(at.join("bridge.toml"), few).unwrap();
    std::fs::write(at.join("all.toml"), all.join("\n")).unwrap();
    succeeds(at, &["bridge", "flutter", "bridge.toml", "--no-figures"]);
    let buffeting = [
        "bridge",
        "buffeting",
        "all.toml",
        "--speed",
        "40",
        "--no-figures",
    ];
    let (code, _, said) = aerodeck(at, &buffeting);
    assert!(matches!(code, 0 | 3), "{said}");
    refused(at, &["new", "--bridge"], &["choose another --out"]);
    succeeds(at, &["new", "--wind", "--out", "gusts.toml"]);
    succeeds(
        at,
        &["buffeting", "gusts.toml", "--no-figures", "--out", "gusts"],
    );
}

/// A file of scatter runs beside a model; one of raw runs is understood and asks for the first file that it names.
#[test]
fn new_files_of_scatter_and_campaign_are_understood() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--monte-carlo"]);
    let absent = ["monte-carlo", "scatter.toml"];
    refused(at, &absent, &["model.json"]);
    succeeds(at, &["new", "--deck", "LN21-5800"]);
    succeeds(at, &["study", "study.toml", "--no-figures"]);
    std::fs::copy(at.join("models/laguerre.json"), at.join("model.json")).unwrap();
    let said = succeeds(
        at,
        &[
            "monte-carlo",
            "scatter.toml",
            "--samples",
            "500",
            "--no-figures",
        ],
    );
    assert!(said.contains("500 samples"), "{said}");
    succeeds(at, &["new", "--campaign"]);
    refused(
        at,
        &["campaign", "check", "campaign.toml"],
        &["heave_8.csv"],
    );
    refused(at, &["new", "--campaign", "--wind"], &["--campaign"]);
}

/// A file of one kind given to a command for another is named, with its own command.
#[test]
fn files_of_another_kind_are_named() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--monte-carlo"]);
    succeeds(at, &["new", "--wind"]);
    let scatter = "found a Monte Carlo file, which `aerodeck monte-carlo` takes";
    refused(at, &["study", "scatter.toml"], &[scatter]);
    refused(at, &["fmu", "export", "scatter.toml"], &[scatter]);
    let wind = "found a wind file, which `aerodeck buffeting` takes";
    refused(at, &["study", "wind.toml"], &[wind]);
    refused(at, &["simulate", "wind.toml"], &[wind]);
}

/// Five answers on standard input are a study that runs; fewer are refused and leave nothing.
#[test]
fn a_study_is_made_of_five_answers() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let answers = "LN21-5200\n31\n22740 2470000\n0.1 0.278\n0.3\n";
    let answered = |text: &str| {
        let mut child = Command::new(env!("CARGO_BIN_EXE_aerodeck"))
            .args(["new", "--interactive"])
            .current_dir(at)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        child
            .stdin
            .take()
            .unwrap()
            .write_all(text.as_bytes())
            .unwrap();
        let done = child.wait_with_output().unwrap();
        (done.status.code(), String::from_utf8(done.stderr).unwrap())
    };
    let (code, said) = answered("LN21-5200\n31\n");
    assert_eq!(code, Some(2));
    assert!(said.contains("an answer to: Mass"), "{said}");
    assert!(!at.join("study.toml").exists());
    let (code, said) = answered(answers);
    assert_eq!(code, Some(0), "{said}");
    let text = std::fs::read_to_string(at.join("study.toml")).unwrap();
    assert!(text.contains("width_m = 31.0") && text.contains("# Where the forces come from"));
    let said = succeeds(at, &["study", "study.toml", "--no-figures"]);
    assert!(said.contains("flutter"), "{said}");
}
