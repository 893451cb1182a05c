//! Files of results in JSON say what they are.

use crate::command::{flowing, refused, succeeds};
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
    let said = "found JSON of the format `aerodeck/fit 1`, not `aerodeck/model 1`";
    refused(at, &line, &[said]);
    // a file of before is read as it is, also with the mark that editors leave
    let model = fs::read_to_string(at.join("a/model.json")).unwrap();
    let before = model.replacen("  \"format\": \"aerodeck/model 1\",\n", "", 1);
    assert_ne!(before, model);
    let later = model.replacen("aerodeck/model 1", "aerodeck/model 2", 1);
    fs::write(at.join("later.json"), later).unwrap();
    let line = ["simulate", "later.json", "--wind-speed", "9"];
    refused(at, &line, &["found JSON of the format `aerodeck/model 2`"]);
    fs::write(at.join("a/before.json"), format!("\u{feff}{before}")).unwrap();
    let simulated = ["a/model.json", "a/before.json"].map(|file| {
        let line = ["simulate", file, "--wind-speed", "9", "--stop-time", "1"];
        succeeds(at, &line);
        fs::read(at.join("a/simulation.csv")).unwrap()
    });
    assert_eq!(simulated[0], simulated[1]);
}

/// A record counts once, and is of the section of the others.
#[test]
fn records_that_stand_twice_or_are_of_another_width_are_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--deck", "flat plate"]);
    succeeds(at, &["tunnel", "study.toml", "--out", "r"]);
    let of_tunnel = fs::read_dir(at.join("r/records")).unwrap();
    let mut paths: Vec<_> = of_tunnel.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "csv"));
    paths.sort();
    fs::copy(&paths[0], at.join("copy.csv")).unwrap();
    let first = fs::read_to_string(&paths[0]).unwrap();
    let line = first.lines().find(|l| l.starts_with("# width_m:")).unwrap();
    fs::write(at.join("wide.csv"), first.replace(line, "# width_m: 0.7")).unwrap();
    // by another name, from another source and with other ends of lines it is the same
    let name = first.lines().find(|l| l.starts_with("# name:")).unwrap();
    let renamed = first.replacen(name, "# name: another", 1);
    fs::write(at.join("renamed.csv"), renamed.replace('\n', "\r\n")).unwrap();
    let study = fs::read_to_string(at.join("study.toml")).unwrap();
    for (other, fragments) in [
        (
            "copy.csv",
            ["copy.csv: expected each record once", "the same as in"],
        ),
        (
            "renamed.csv",
            ["renamed.csv: expected each record once", "the same as in"],
        ),
        ("wide.csv", ["wide.csv: width_m: expected", "found 0.7 m"]),
    ] {
        let files = [
            paths[0].to_str().unwrap(),
            paths[1].to_str().unwrap(),
            other,
        ];
        let key = format!("[deck]\nrecords = {files:?}\n");
        fs::write(at.join("own.toml"), study.replacen("[deck]\n", &key, 1)).unwrap();
        refused(at, &["study", "own.toml", "--out", "own"], &fragments);
    }
}

/// Records of a section with sway train one without: their channels of sway are left out, and the records in which it is driven.
#[test]
fn records_are_cut_to_the_motions_of_the_section() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new"]);
    let study = fs::read_to_string(at.join("study.toml")).unwrap();
    let sway =
        "[section]\nlateral = { mass_kg_m = 15.0, frequency_hz = 1.5, damping_ratio = 0.003 }\n";
    let with = study.replacen("[section]\n", sway, 1);
    fs::write(at.join("three.toml"), with).unwrap();
    succeeds(
        at,
        &["tunnel", "three.toml", "--set", "tunnel.speeds_m_s=[8.18]"],
    );
    let files =
        ["vertical", "lateral", "torsion"].map(|d| format!("records/LN21-5200-{d}-8.18.csv"));
    let of = |files: &[String]| {
        let key = format!("[deck]\nrecords = {files:?}\n");
        fs::write(at.join("two.toml"), study.replacen("[deck]\n", &key, 1)).unwrap();
    };
    of(&files);
    let note = "the section has no lateral motion; its channels are not used, and records in which it is driven: \
                LN21-5200-lateral-8.18";
    let said = flowing(&succeeds(at, &["train", "two.toml", "--out", "all"]));
    assert!(said.contains(note), "{said}");
    let few = ["select", "two.toml", "--filters", "1", "--values", "2"];
    let said = flowing(&succeeds(at, &few));
    assert!(said.contains(note), "{said}");
    let model = |folder: &str| {
        let text = fs::read_to_string(at.join(folder).join("models/laguerre.json")).unwrap();
        let model: serde_json::Value = serde_json::from_str(&text).unwrap();
        model["model"].clone()
    };
    of(&[files[0].clone(), files[2].clone()]);
    succeeds(at, &["train", "two.toml", "--out", "some"]);
    assert_eq!(model("all"), model("some"));
    of(&[files[1].clone()]);
    let line = ["train", "two.toml", "--out", "none"];
    refused(
        at,
        &line,
        &["deck.records: expected a record in which no lateral is driven"],
    );
}

/// Records that the virtual tunnel made of an earlier table are not those of the next; what a laboratory put there stays.
#[test]
fn records_of_an_earlier_table_go() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--deck", "LN21-5200"]);
    succeeds(at, &["tunnel", "study.toml"]);
    let names = || {
        let all = fs::read_dir(at.join("records")).unwrap();
        let mut names: Vec<_> = all.map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let before = names();
    let own = fs::read_to_string(at.join("records").join(&before[1])).unwrap();
    let own = own.replacen("# source: virtual tunnel", "# source: laboratory", 1);
    fs::write(at.join("records/own.csv"), own).unwrap();
    let other = ["tunnel", "study.toml", "--set", "deck.source=\"LN21-5500\""];
    succeeds(at, &other);
    let after = names();
    let of_deck = |name: &std::ffi::OsString| name.to_str().unwrap().starts_with("LN21-5200");
    assert!(after.contains(&"own.csv".into()), "{after:?}");
    assert!(!after.iter().any(of_deck) && after.len() > 4, "{after:?}");
}

/// Models of a table that was revised since are not those of the study.
#[test]
fn models_of_an_earlier_table_are_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["derivatives", "convert", "LN21-5200", "table.csv"]);
    succeeds(at, &["new", "--workbook", "table.csv"]);
    succeeds(at, &["tunnel", "study.toml"]);
    succeeds(at, &["train", "study.toml"]);
    succeeds(at, &["flutter", "study.toml"]);
    let table = fs::read_to_string(at.join("table.csv")).unwrap();
    let line = table.lines().find(|l| l.starts_with("A2,1,")).unwrap();
    let (rest, value) = line.rsplit_once(',').unwrap();
    let other = format!("{rest},{}", 1.1 * value.parse::<f64>().unwrap());
    fs::write(at.join("table.csv"), table.replace(line, &other)).unwrap();
    let expected =
        "table.sha1: expected models of the deck of the study (run `aerodeck train` again)";
    refused(
        at,
        &["flutter", "study.toml"],
        &[expected, "those of another table"],
    );
    succeeds(at, &["tunnel", "study.toml"]);
    succeeds(at, &["train", "study.toml"]);
    succeeds(at, &["flutter", "study.toml"]);
}

/// Models and fits that a study no longer has do not stand beside those of its next run; what a bridge or others put there stays.
#[test]
fn models_that_a_study_no_longer_has_go() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--deck", "LN21-5200"]);
    let out = at.join("out");
    fs::create_dir_all(out.join("models")).unwrap();
    let of_bridge = r#"{ "bridge": "girder", "files": ["out/models/own.json"] }"#;
    fs::write(out.join("summary.json"), of_bridge).unwrap();
    fs::write(out.join("models/own.json"), "{}").unwrap();
    let run = ["study", "study.toml", "--out", "out", "--no-figures"];
    succeeds(at, &run);
    let text = fs::read_to_string(at.join("study.toml")).unwrap();
    let renamed = text.replace("\"rational functions\"", "\"lags\"");
    fs::write(at.join("study.toml"), renamed).unwrap();
    succeeds(at, &[&run[..], &["--force"]].concat());
    let stands = |name: &str| out.join(name).exists();
    let own = [
        "models/laguerre.json",
        "models/own.json",
        "models/lags.json",
        "fits/lags.json",
    ];
    for name in own {
        assert!(stands(name), "{name}");
    }
    for folder in ["models", "fits"] {
        let earlier = format!("{folder}/rational_functions.json");
        assert!(!stands(&earlier), "{earlier}");
    }
}
