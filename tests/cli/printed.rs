//! What a client gets: whose the report is, the page on paper, and the response to turbulence in it.

use crate::bridge::folder;
use crate::browser;
use crate::command::{aerodeck, flowing, listing, refused, succeeds};
use aerodeck::files::bridge::BridgeFile;
use aerodeck::study::bridge::BridgeStudy;
use assert_cmd::Command;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use tempfile::TempDir;

const BUFFETING: &str = r#"
[section.static]
drag = 0.08
lift = -0.15
moment = 0.03
drag_slope = 0.0
lift_slope = 4.5
moment_slope = 1.2

[buffeting]
along = { spectrum = { shape = { kind = "kaimal" }, length_m = 150.0, intensity = 0.12 } }
vertical = { spectrum = { shape = { kind = "kaimal" }, length_m = 15.0, intensity = 0.06 } }
time = { records = 2, duration_s = 60.0, step_s = 0.1, seed = 1 }
speeds_m_s = [20.0, 30.0]
section_forces = "forces.csv"
"#;

/// Project, author, revision and date stand at the edges of every printed page; without a date that of the run does.
#[test]
fn a_report_says_whose_it_is() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let block = "[report]\nproject = \"Strait \\\"crossing\\\"\"\nauthor = \"A. <Engineer>\"\nrevision = \"B\"\n";
    let study =
        aerodeck::study::demo_study_text().replacen("[section]", &format!("{block}\n[section]"), 1);
    fs::write(at.join("s.toml"), &study).unwrap();
    succeeds(at, &["study", "s.toml", "--out", "r", "--no-figures"]);
    let page = fs::read_to_string(at.join("r/report.html")).unwrap();
    for part in [
        r#"@top-left { content: "Strait \22 crossing\22  · Langenuen LN21-5200"; }"#,
        r#"@top-right { content: "revision B · 2023-11-14"; white-space: nowrap; }"#,
        r#"@bottom-left { content: "A. \3c Engineer\3e  · aerodeck "#,
        "counter(pages); white-space: nowrap;",
        "<strong>A. &#60;Engineer&#62;</strong>",
        "<nav>",
    ] {
        assert!(page.contains(part), "`{part}` is not in the page");
    }
    let dated = study.replace("revision = \"B\"", "date = \"1 May\"");
    fs::write(at.join("s.toml"), dated).unwrap();
    succeeds(at, &["study", "s.toml", "--out", "d", "--no-figures"]);
    let page = fs::read_to_string(at.join("d/report.html")).unwrap();
    assert!(page.contains(r#"@top-right { content: "1 May"; white-space: nowrap; }"#));
    // a page of its own is printed where a browser is, and said how else where none is
    if browser::document(&at.join("d/report.html"), "1280,1000").is_some() {
        succeeds(at, &["report", "d", "--pdf"]);
        let printed = fs::read(at.join("d/report.pdf")).unwrap();
        assert!(printed.starts_with(b"%PDF"));
    }
    let output = Command::new(env!("CARGO_BIN_EXE_aerodeck"))
        .current_dir(at)
        .args(["report", "d", "--pdf"])
        .env("PATH", "")
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("open report.html in any browser"), "{said}");
}

/// What a reader has to look at is short; all of it is said when asked for.
#[test]
fn an_account_is_short() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    for deck in ["LN21-5500", "flat plate"] {
        succeeds(
            at,
            &["new", "--deck", "LN21-5200", "--out", "s.toml", "--force"],
        );
        let set = format!("deck.source=\"{deck}\"");
        let run = [
            "study",
            "s.toml",
            "--out",
            "r",
            "--no-figures",
            "--force",
            "--set",
            &set,
        ];
        let (_, said, _) = aerodeck(at, &run);
        assert!(said.lines().count() <= 25, "{deck}\n{said}");
        assert!(
            !said.contains("condition") && !said.contains("branch"),
            "{said}"
        );
        let (_, all, _) = aerodeck(at, &[&run[..], &["--verbose"]].concat());
        assert!(
            all.lines().count() > 40 && all.contains("condition number"),
            "{all}"
        );
    }
}

/// More models than can be told apart are said in the figures of the first ones, whose bars of intervals lie apart.
#[test]
fn figures_of_many_models_have_the_first_ones() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--deck", "LN21-5200", "--out", "s.toml"]);
    let text = fs::read_to_string(at.join("s.toml")).unwrap();
    let first = text.find("[[model]]").unwrap();
    let (before, rest) = text.split_at(first);
    let after = &rest[rest.find("# Where to look").unwrap()..];
    let model = |i: usize| {
        format!(
            "[[model]]\nname = \"m{i}\"\ntable = {{ form = {{ kind = \"rational\", lags = 2 }} }}\n\n"
        )
    };
    let models: String = (1..=8).map(model).collect();
    fs::write(at.join("s.toml"), format!("{before}{models}{after}")).unwrap();
    succeeds(at, &["study", "s.toml", "--out", "r"]);
    let drawn = |stem: &str| fs::read_to_string(at.join(format!("r/{stem}.svg"))).unwrap();
    for stem in ["flutter", "roots", "derivatives"] {
        let svg = drawn(stem);
        assert!(svg.contains("(the first 7 of 8 models)"), "{stem}");
        assert!(svg.contains("m7") && !svg.contains("m8"), "{stem}");
    }
    let svg = drawn("flutter");
    let bars = svg.lines().filter(|l| l.contains("stroke-width=\"3.5\""));
    let height = |line: &'_ str| {
        let from = line.split(['M', 'L']).nth(1).unwrap();
        from.split(' ').nth(1).unwrap().to_owned()
    };
    // those of seven models and of the table, and that in the legend
    let heights: BTreeSet<String> = bars.map(height).collect();
    assert_eq!(heights.len(), 9, "{heights:?}");
}

/// Several winds in one call; the report of the same bridge takes them up; section forces and the envelope follow from the modes.
#[test]
fn the_report_of_a_bridge_has_its_response_to_turbulence() {
    let folder = folder();
    let at = folder.path();
    let path = at.join("bridge.toml");
    let text = fs::read_to_string(&path).unwrap() + BUFFETING;
    fs::write(&path, &text).unwrap();
    let study = BridgeStudy::new(BridgeFile::read(&path).unwrap()).unwrap();
    let bridge = &study.by_model;
    let middle = bridge.nodes.len() / 2;
    let mut forces = "mode,element,vertical_m,double_m\n".to_owned();
    for m in &bridge.modes {
        let shape = m.shape[middle][0];
        let _ = writeln!(forces, "{},middle,{shape},{}", m.number, 2.0 * shape);
    }
    refused(at, &["bridge", "buffeting", "bridge.toml"], &["forces.csv"]);
    fs::write(at.join("forces.csv"), forces).unwrap();
    succeeds(at, &["bridge", "flutter", "bridge.toml", "--out", "r"]);
    let said = succeeds(
        at,
        &["bridge", "buffeting", "bridge.toml", "--out", "r", "--json"],
    );
    let said: Value = serde_json::from_str(&said).unwrap();
    let all = said["buffeting"].as_array().unwrap();
    assert_eq!(all.len(), 2);
    for of in all {
        let envelope = &of["envelope"];
        let number = |v: &Value| v.as_f64().unwrap();
        for (n, node) in of["frequency"]["nodes"]
            .as_array()
            .unwrap()
            .iter()
            .enumerate()
        {
            let node = usize::try_from(node.as_u64().unwrap()).unwrap();
            for i in 0..3 {
                let (a, b) = (&envelope["rms"][node][i], &of["frequency"]["rms"][n][i]);
                assert!((number(a) / number(b) - 1.0).abs() < 1e-3, "{a} {b}");
            }
        }
        let rms = number(&envelope["rms"][middle][0]);
        let force = |i: usize| number(&envelope["section_forces"][i]["rms"]);
        assert!((force(0) / rms - 1.0).abs() < 1e-12 && (force(1) / rms - 2.0).abs() < 1e-12);
    }
    let report = fs::read_to_string(at.join("r/report.html")).unwrap();
    for part in [
        ">Buffeting at 20 m/s</h2>",
        ">Buffeting at 30 m/s</h2>",
        "mean ± expected peak",
        "double_m of middle",
    ] {
        assert!(report.contains(part), "`{part}` is not in the report");
    }
    assert!(report.contains("<code>inputs/bridge.toml</code>"));
    assert_eq!(
        fs::read_to_string(at.join("r/inputs/bridge.toml")).unwrap(),
        text
    );
    // what was computed for another bridge is not taken up
    fs::write(
        &path,
        text.replace("name = \"Langenuen", "name = \"Another"),
    )
    .unwrap();
    succeeds(at, &["bridge", "flutter", "bridge.toml", "--out", "r"]);
    let report = fs::read_to_string(at.join("r/report.html")).unwrap();
    assert!(!report.contains("Buffeting at"));
    // nor does a motion stand beside a search that found none, or a section that is no longer there
    for name in [
        "bridge_derivatives_1.svg",
        "bridge_derivatives_9.svg",
        "flutter_motion.csv",
    ] {
        fs::write(at.join("r").join(name), "old").unwrap();
    }
    fs::write(
        &path,
        text.replace("speed_max_m_s = 100", "speed_max_m_s = 20"),
    )
    .unwrap();
    let sampled = ["bridge", "flutter", "bridge.toml", "--samples", "8"];
    let wide = ["--scatter-derivatives", "2"];
    let said = succeeds(at, &[&sampled[..], &["--out", "r"]].concat());
    assert!(said.contains("Scatter: none"), "{said}");
    let left = listing(&at.join("r"));
    let old = |n: &&String| n.starts_with("flutter_") || *n == "bridge_derivatives_9.svg";
    assert_eq!(left.iter().find(old), None);
    assert!(
        left.contains(&"bridge_derivatives_1.svg".to_owned()),
        "{left:?}"
    );
    fs::write(&path, &text).unwrap();
    let text = flowing(&succeeds(at, &[&sampled[..], &wide].concat()));
    assert!(
        text.contains("Scatter of 8 samples, ") && !text.contains(", 8 of them"),
        "{text}"
    );
}

/// A wind in which the bridge is unstable has no response; the others do, and what does not move has no peaks.
#[test]
fn winds_without_a_response_are_named_beside_the_others() {
    let folder = folder();
    let at = folder.path();
    let block = BUFFETING.replace("section_forces = \"forces.csv\"\n", "");
    let text = fs::read_to_string(at.join("bridge.toml")).unwrap() + &block;
    let bending = text.replace("2, 3, 5, 12, 14, 16, 17, 23", "2, 3, 5");
    fs::write(at.join("bending.toml"), bending).unwrap();
    fs::write(at.join("bridge.toml"), text).unwrap();
    let run = ["bridge", "buffeting", "bridge.toml"];
    let both = [&run[..], &["--speed", "30,90", "--out", "r", "--json"]].concat();
    let (code, said, error) = aerodeck(at, &both);
    assert_eq!(code, 1, "{said}{error}");
    let why = "buffeting at 90 m/s: the bridge is unstable there";
    assert!(error.contains(why), "{error}");
    let said: Value = serde_json::from_str(&said).unwrap();
    assert!(said["unstable"][0].as_str().unwrap().starts_with(why));
    let answered = said["buffeting"].as_array().unwrap();
    assert_eq!(answered.len(), 1);
    assert_eq!(answered[0]["frequency"]["speed_m_s"], 30.0);
    assert!(at.join("r/bridge_spectra_30.csv").exists());
    let page = fs::read_to_string(at.join("r/buffeting.html")).unwrap();
    assert!(page.contains(why), "not on the page");
    succeeds(at, &[&run[..], &["--speed", "30", "--out", "r"]].concat());
    let spectra = listing(&at.join("r")).into_iter();
    let spectra = spectra.filter(|n| n.starts_with("bridge_spectra"));
    assert_eq!(spectra.collect::<Vec<_>>(), ["bridge_spectra.csv"]);
    let (code, _, error) = aerodeck(at, &[&run[..], &["--speed", "90"]].concat());
    assert!(code == 1 && error.contains(why), "{code} {error}");

    let file = ["--turbulence", "turbulence.csv"];
    let several = [&run[..], &file].concat();
    let expected = "--speed: expected one wind speed with --turbulence";
    refused(at, &several, &[expected]);
    let out = [&run[..], &file, &["--out", "t"]].concat();
    refused(at, &out, &["--turbulence", "--out"]);

    let still = ["bridge", "buffeting", "bending.toml", "--speed", "30"];
    let said = succeeds(at, &still);
    assert!(!said.contains("NaN") && !said.contains("inf"), "{said}");
    let file = fs::read_to_string(at.join("bridge_buffeting.json")).unwrap();
    let results: Value = serde_json::from_str(&file).unwrap();
    let peaks = results["expected_peak_factor"][0].as_array().unwrap();
    assert_eq!(
        (&peaks[1], &peaks[2]),
        (&Value::from(0.0), &Value::from(0.0))
    );
}
