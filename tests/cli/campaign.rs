//! Raw campaigns on the command line: invented, checked, and wrong in many ways.

use crate::command::{listing, refused, succeeds};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Two short frequencies at one speed; nothing else is stated.
const PLAN: &str = "[tunnel]\nfrequencies_hz = [0.5, 2.0]\nspeeds_m_s = [8.0]\nstill_s = 2.0\nsegment_s = 6.0\nramp_s = 2.0\nnoise_fraction = 0.05\n";

fn virtual_campaign(folder: &Path, more: &[&str]) -> String {
    fs::write(folder.join("plan.toml"), PLAN).unwrap();
    let out = if more.contains(&"--out") {
        &[][..]
    } else {
        &["--out", "c"]
    };
    let arguments = ["campaign", "virtual", "jones", "--plan", "plan.toml"];
    succeeds(folder, &[&arguments[..], out, more].concat())
}

#[test]
fn a_virtual_campaign_is_sound() {
    let folder = TempDir::new().unwrap();
    let text = virtual_campaign(folder.path(), &[]);
    assert!(text.contains("Jones-torsion-8.00"), "{text}");
    for name in [
        "c/campaign.toml",
        "c/plan.toml",
        "c/truth.csv",
        "c/disturbances.json",
        "c/truth/Jones-vertical-8.00.csv",
        "c/runs/Jones-vertical-8.00-wind.csv",
        "c/runs/Jones-torsion-8.00-still.csv",
    ] {
        assert!(folder.path().join(name).is_file(), "{name}");
    }
    let text = succeeds(folder.path(), &["campaign", "check", "c/campaign.toml"]);
    for words in [
        "cells near, far",
        "vertical motion, 8.000 m/s, 1.1900 kg/m³",
        "2800 samples at 200 Hz (14.0 s)",
        "near.fx",
        // lift alone moves in heave: the cells' other axis shows the weight it carries, and no noise of its own
        "4 findings",
        "still air, `near.fy`: is 3 all the time",
    ] {
        assert!(text.contains(words), "`{words}` is not in:\n{text}");
    }
    // the same seed gives the same files, another one others
    let samples = |c: &Path| fs::read(c.join("c/runs/Jones-vertical-8.00-wind.csv")).unwrap();
    let before = samples(folder.path());
    virtual_campaign(folder.path(), &[]);
    assert!(before == samples(folder.path()));
    virtual_campaign(folder.path(), &["--seed", "9", "--force"]);
    assert!(before != samples(folder.path()));
}

#[test]
fn the_layout_of_ntnu_and_json() {
    let folder = TempDir::new().unwrap();
    let text = virtual_campaign(
        folder.path(),
        &["--format", "ntnu", "--noise", "0", "--json"],
    );
    let answer: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(answer["plan"]["tunnel"]["noise_fraction"], 0.0);
    assert_eq!(answer["runs"].as_array().unwrap().len(), 2);
    let text = succeeds(
        folder.path(),
        &["campaign", "check", "c/campaign.toml", "--json"],
    );
    let answer: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(answer["runs"][0]["in_wind"]["samples"], 2800);
    assert_eq!(answer["runs"][0]["air_density_kg_m3"], 1.19);
    // without noise, channels that carry no force of the motion stand still, and nothing else is odd
    let findings = answer["findings"].as_array().unwrap();
    assert!(!findings.is_empty());
    for finding in findings {
        let what = finding["what"].as_str().unwrap();
        assert!(what.ends_with("all the time"), "{what}");
    }
    assert!(listing(folder.path()).contains(&"c/runs.h5".to_owned()));
}

/// Where a Python with h5py is at hand, the file is opened as the laboratory's own package opens it.
#[test]
fn the_tools_of_ntnu_find_what_they_read() {
    let python = std::env::var("AERODECK_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has_h5py = std::process::Command::new(&python)
        .args(["-c", "import h5py, numpy"])
        .output();
    if !has_h5py.is_ok_and(|o| o.status.success()) {
        eprintln!("skipped: {python} has no h5py");
        return;
    }
    let folder = TempDir::new().unwrap();
    virtual_campaign(folder.path(), &["--format", "ntnu"]);
    virtual_campaign(folder.path(), &["--out", "csv"]);
    let output = std::process::Command::new(&python)
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/lab/read_as_w3t.py"))
        .args([folder.path().join("c/runs.h5"), folder.path().join("csv")])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success(),
        "{said}\n{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(said.contains("4 groups"), "{said}");
}

#[test]
fn wrong_campaigns_are_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    virtual_campaign(at, &[]);
    let file = at.join("c/campaign.toml");
    let text = fs::read_to_string(&file).unwrap();
    let with = |from: &str, to: &str, fragments: &[&str]| {
        assert!(text.contains(from), "{from}\n{text}");
        fs::write(&file, text.replacen(from, to, 1)).unwrap();
        refused(at, &["campaign", "check", "c/campaign.toml"], fragments);
    };
    with(
        "\"near.fx\"",
        "\"near.force\"",
        &[
            "Jones-vertical-8.00-wind.csv",
            "channels.cells.near.fx",
            "a channel `near.force`",
            "far.mz",
        ],
    );
    with(
        "name = \"near.fx\"",
        "name = \"near.fy\"",
        &[
            "campaign.toml: line ",
            "channels.cells.near.fy",
            "a channel of its own",
            "which is `channels.cells.near.fx` too",
        ],
    );
    with(
        "mean_speed_m_s = 8.0",
        "mean_speed_m_s = 0.0",
        &["campaign.toml: line ", "run[0].mean_speed_m_s", "found 0"],
    );
    with(
        "Jones-torsion-8.00-still",
        "gone",
        &[
            "gone.csv",
            "run `Jones-torsion-8.00`, still air",
            "a recording",
        ],
    );
    with(
        "density_kg_m3",
        "density",
        &["campaign.toml: line ", "density"],
    );
    refused(
        at,
        &["campaign", "virtual", "LN22", "--out", "d"],
        &["LN21-5200", "`LN22`"],
    );
    refused(
        at,
        &["campaign", "virtual", "jones", "--lateral", "--out", "d"],
        &["a table of derivatives"],
    );
    refused(
        at,
        &["campaign", "virtual", "jones", "--noise=-1", "--out", "d"],
        &["noise_fraction"],
    );
    fs::write(at.join("plan.toml"), "[tunnel]\nsampling_hz = 1e9\n").unwrap();
    refused(
        at,
        &[
            "campaign",
            "virtual",
            "jones",
            "--plan",
            "plan.toml",
            "--out",
            "d",
        ],
        &["sampling_hz", "at most 100000 Hz"],
    );
    fs::write(at.join("plan.toml"), "[disturbances]\nforce_lag_s = 9.0\n").unwrap();
    refused(
        at,
        &[
            "campaign",
            "virtual",
            "jones",
            "--plan",
            "plan.toml",
            "--out",
            "d",
        ],
        &["plan.toml: line 2, disturbances.force_lag_s", "found 9"],
    );
}
