//! The released section of a model: what its motion comes to, and what is refused.

use crate::command::{aerodeck, flowing, succeeds};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// What grows is said to, also without oscillating; what no test looked at, and what looks odd in the section.
#[test]
fn a_simulation_says_whether_the_motion_grows() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["demo", "--out", "d", "--no-figures"]);
    let changed = |name: &str, key: &str, value: f64| {
        let text = fs::read_to_string(at.join("d/model.json")).unwrap();
        let mut model: Value = serde_json::from_str(&text).unwrap();
        *model.pointer_mut(key).unwrap() = value.into();
        fs::write(at.join(name), model.to_string()).unwrap();
    };
    changed("soft.json", "/section/torsion/frequency_hz", 2.0);
    changed("wide.json", "/section/width_m", 500.0);
    changed("coarse.json", "/experiment/step_size_s", 100.0);
    let run = |model: &str, more: &[&str]| {
        let line = ["simulate", model, "--no-figures", "--wind-speed"];
        aerodeck(at, &[&line[..], more].concat())
    };
    for (model, speed, says, tested) in [
        ("d/model.json", "30", "dies down: least damped mode", true),
        ("d/model.json", "42", "GROWS: least damped mode", true),
        ("d/model.json", "2", "dies down: least damped mode", false),
        (
            "soft.json",
            "30",
            "GROWS without oscillating (static divergence): growth +",
            false,
        ),
    ] {
        let (code, said, error) = run(model, &[speed]);
        let said = flowing(&said);
        assert!(code == 0 && said.contains(says), "{said}{error}");
        let outside = said.contains("OUTSIDE the tested range, K = ωB/V 0.");
        assert_eq!(outside, !tested, "{said}");
    }
    // without wind the structure moves by itself, whatever the model; less than none is refused
    let sampled = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/models/discrete_laguerre.json"
    );
    fs::copy(sampled, at.join("sampled.json")).unwrap();
    for speed in ["0", "1e-300", "1e-9"] {
        for model in ["d/model.json", "sampled.json"] {
            let (code, json, error) = run(model, &[speed, "--json"]);
            assert_eq!(code, 0, "{error}");
            let found: Value = serde_json::from_str(&json).unwrap();
            let damping = found["modes"][0]["damping_ratio"].as_f64().unwrap();
            assert!((damping - 0.003).abs() < 1e-4, "{model} {speed}: {json}");
        }
    }
    let (_, said, _) = run("d/model.json", &["0"]);
    assert!(said.contains("  no wind: the structure, "), "{said}");
    let (_, said, _) = run("sampled.json", &["0.2"]);
    assert!(
        said.contains("  a sample of the forces lasts half a period or more: "),
        "{said}"
    );
    let undamped = fs::read_to_string(at.join("d/model.json")).unwrap();
    let undamped = undamped.replace("\"damping_ratio\": 0.003", "\"damping_ratio\": 0");
    fs::write(at.join("undamped.json"), undamped).unwrap();
    let (_, said, _) = run("undamped.json", &["0"]);
    assert!(
        said.contains("  the motion neither grows nor dies down: "),
        "{said}"
    );
    assert!(!said.contains("OUTSIDE"), "{said}");
    let (code, _, error) = run("d/model.json", &["-1"]);
    assert!(code == 2 && error.contains("-1"), "{error}");
    let (_, said, error) = run("wide.json", &["30", "--json"]);
    assert!(error.contains("section.width_m = 500: "), "{error}");
    let said: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(said["findings"][0]["place"], "section.width_m");
    for (model, more, says) in [
        (
            "d/model.json",
            &["30", "--step", "20", "--stop-time", "10"][..],
            "--step: expected a step within the stop time of 10 s, found 20 s",
        ),
        (
            "coarse.json",
            &["30"],
            "coarse.json: experiment.step_size_s: ",
        ),
    ] {
        let (code, _, error) = run(model, more);
        assert!(code == 2 && flowing(&error).contains(says), "{error}");
    }
    // rows to the end of all numbers, drawn as well
    let overflows = [
        "simulate",
        "soft.json",
        "--wind-speed",
        "60",
        "--stop-time",
        "1000",
    ];
    let (code, said, error) = aerodeck(at, &overflows);
    assert_eq!(code, 1, "{said}{error}");
    let said = flowing(&said);
    let (_, end) = said
        .split_once("ENDS EARLY: the motion has overflowed at ")
        .expect(&said);
    let end: f64 = end.split(' ').next().unwrap().parse().unwrap();
    let rows = fs::read_to_string(at.join("simulation.csv")).unwrap();
    let last = rows
        .lines()
        .last()
        .unwrap()
        .split(',')
        .map(|x| x.parse::<f64>().unwrap());
    let last: Vec<f64> = last.collect();
    assert!(last[0] < end && end - last[0] < 0.1, "{end}: {last:?}");
    assert!(last.iter().all(|x| x.is_finite()), "{last:?}");
}
