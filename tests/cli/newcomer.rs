//! The command line as a new user meets it: an empty folder, the demo, the single stages, and wrong input.

use crate::command::{listing, onset_of, refused, succeeds};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

#[test]
fn the_demo_does_the_whole_chain() {
    let folder = TempDir::new().unwrap();
    let text = succeeds(folder.path(), &["demo", "--verbose"]);
    for word in [
        "LN21-5200",
        "residual",
        "tested K",
        "eigenvalues",
        "determinant",
        "FMU stepped",
        "deck_section.fmu",
    ] {
        assert!(text.contains(word), "`{word}` is not in:\n{text}");
    }
    let out = folder.path().join("aerodeck-out");
    for name in [
        "study.toml",
        "model.json",
        "deck_section.fmu",
        "summary.json",
        "flutter.svg",
    ] {
        assert!(out.join(name).is_file(), "{name}");
    }
    assert!(
        listing(folder.path())
            .iter()
            .all(|n| !n.contains(".aerodeck-")),
        "staging left behind"
    );
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    for onset in summary["onsets"].as_array().unwrap() {
        for key in [
            "model",
            "method",
            "speed_m_s",
            "frequency_hz",
            "reduced_velocity",
            "in_tested_range",
        ] {
            assert!(!onset[key].is_null(), "{key} in {onset}");
        }
    }
    // the three default routes agree within 1.5 %, and the stepped FMU with its own eigenvalues within 0.1 %
    let speed = |model: &str, method: &str| {
        onset_of(&summary, model, method)["speed_m_s"]
            .as_f64()
            .unwrap()
    };
    let laguerre = speed("Laguerre", "eigenvalues");
    let rational = speed("rational functions", "eigenvalues");
    let table = speed("interpolated table", "determinant");
    for (a, b) in [(laguerre, rational), (laguerre, table), (rational, table)] {
        assert!((a / b - 1.0).abs() < 0.015, "{a} against {b}");
    }
    assert!((speed("Laguerre", "fmu_stepping") / laguerre - 1.0).abs() < 0.001);

    // the archive carries the interval of its onset, as does one made from the model where it lies; a model that went
    // elsewhere has left its covariance behind
    let interval = &onset_of(&summary, "Laguerre", "eigenvalues")["interval"];
    fs::copy(out.join("model.json"), folder.path().join("alone.json")).unwrap();
    for (model, known) in [
        ("aerodeck-out/model.json", true),
        ("aerodeck-out/models/laguerre.json", true),
        ("alone.json", false),
    ] {
        let export = ["fmu", "export", model, "--out", "again.fmu", "--force"];
        succeeds(folder.path(), &export);
        let xml = entry(&folder.path().join("again.fmu"), "modelDescription.xml");
        let demo = entry(&out.join("deck_section.fmu"), "modelDescription.xml");
        for (name, end) in [
            ("onset_speed_low", "low_m_s"),
            ("onset_speed_high", "high_m_s"),
        ] {
            let expected = interval[end].as_f64().unwrap();
            for (xml, known) in [(&demo, true), (&xml, known)] {
                let found = start_of(xml, name);
                // the same root, searched up to another speed
                let same = found.map(|found| (found / expected - 1.0).abs() < 1e-8);
                let wanted = known.then_some(true);
                assert_eq!(same, wanted, "{model}: {found:?} of {expected}");
            }
        }
    }
    let fmu = out.join("deck_section.fmu");
    let of_runs = |name: &str| entry(&fmu, &format!("extra/org.fmi-standard.fmi-ls-ref/{name}"));
    assert!(of_runs("report.html").contains("Laguerre"));
    assert!(of_runs("fmi-ls-manifest.xml").contains("role=\"report\""));
    assert!(of_runs("uncertainty.exp").contains("onset_high"));
    let said = succeeds(
        folder.path(),
        &["fmu", "replay", "aerodeck-out/deck_section.fmu"],
    );
    assert!(said.contains("as the exporter meant: 6 runs"));
    let archive = fs::read(&fmu).unwrap();
    // a second run says what it replaces, with the same archive; an edited study is left alone
    assert!(succeeds(folder.path(), &["demo", "--verbose"]).contains("replaced"));
    assert!(archive == fs::read(fmu).unwrap());
    let study = out.join("study.toml");
    let edited = fs::read_to_string(&study).unwrap() + "\n# mine\n";
    fs::write(&study, &edited).unwrap();
    refused(folder.path(), &["demo"], &["study.toml", "left as it is"]);
    assert_eq!(fs::read_to_string(&study).unwrap(), edited);
    // and can be run as it stands
    assert!(succeeds(folder.path(), &["study", "aerodeck-out/study.toml"]).contains("FMU stepped"));
}

/// Start value of a variable in a description.
fn start_of(xml: &str, name: &str) -> Option<f64> {
    let (_, rest) = xml.split_once(&format!("name=\"{name}\""))?;
    let (_, rest) = rest.split_once("start=\"")?;
    rest.split('"').next()?.parse().ok()
}

/// A text in an archive.
fn entry(archive: &Path, name: &str) -> String {
    let mut archive = zip::ZipArchive::new(fs::File::open(archive).unwrap()).unwrap();
    std::io::read_to_string(archive.by_name(name).unwrap()).unwrap()
}

#[test]
fn every_stage_is_a_command() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("study.toml"), aerodeck::study::demo_study_text()).unwrap();
    refused(
        at,
        &["train", "study.toml"],
        &["records", "aerodeck tunnel"],
    );
    refused(
        at,
        &["flutter", "study.toml"],
        &["models", "aerodeck train"],
    );
    let tunnel = succeeds(at, &["tunnel", "study.toml"]);
    assert!(tunnel.contains("43200 samples at 200 Hz"), "{tunnel}");
    assert!(succeeds(at, &["train", "study.toml"]).contains("model.json"));
    let flutter: Value =
        serde_json::from_str(&succeeds(at, &["flutter", "study.toml", "--json"])).unwrap();
    assert_eq!(flutter["flutter"]["onsets"].as_array().unwrap().len(), 4);
    succeeds(at, &["simulate", "model.json", "--wind-speed", "30"]);
    assert!(
        fs::read_to_string(at.join("simulation.csv"))
            .unwrap()
            .lines()
            .count()
            > 1000
    );
    for kind in ["laguerre", "rational_functions", "thesis"] {
        let (model, fmu) = (format!("models/{kind}.json"), format!("{kind}.fmu"));
        succeeds(at, &["fmu", "export", &model, "--out", &fmu]);
        let check: Value =
            serde_json::from_str(&succeeds(at, &["fmu", "check", &fmu, "--json"])).unwrap();
        assert_eq!(check["findings"], Value::Array(vec![]), "{kind}");
        assert!(check["trials"].as_array().unwrap().len() > 5);
        // real variables alone
        let reals = format!("{kind}_reals.fmu");
        succeeds(
            at,
            &["fmu", "export", &model, "--reals-only", "--out", &reals],
        );
        let reals: Value =
            serde_json::from_str(&succeeds(at, &["fmu", "check", &reals, "--json"])).unwrap();
        assert_eq!(reals["findings"], Value::Array(vec![]), "{kind}");
        assert!(reals["variables"].as_u64() < check["variables"].as_u64());
        // the forces alone, on strips
        let fmu = format!("{kind}_force.fmu");
        let force = ["--kind", "force", "--strips", "3", "--strip-length", "2.5"];
        let export = ["fmu", "export", &model, "--out", &fmu, "--json"];
        let said = succeeds(at, &[&export[..], &force].concat());
        let export: Value = serde_json::from_str(&said).unwrap();
        assert_eq!(export["strips"], 3);
        let check: Value =
            serde_json::from_str(&succeeds(at, &["fmu", "check", &fmu, "--json"])).unwrap();
        assert_eq!(check["findings"], Value::Array(vec![]), "{kind}");
    }
    for (wrong, words) in [
        (&["--strips", "3"][..], &["--strips", "--kind force"][..]),
        (
            &["--kind", "force", "--strips", "0"],
            &["strips", "1 to 10000"],
        ),
        (
            &["--kind", "force", "--prediction", "3.5"],
            &["prediction", "0 to 3"],
        ),
        (
            &["--kind", "force", "--strip-length", "0"],
            &["length", "positive"],
        ),
    ] {
        let export = ["fmu", "export", "model.json", "--out", "none.fmu"];
        refused(at, &[&export[..], wrong].concat(), words);
        assert!(!at.join("none.fmu").exists());
    }
    let first = fs::read(at.join("laguerre.fmu")).unwrap();
    refused(
        at,
        &["fmu", "export", "model.json", "--out", "laguerre.fmu"],
        &["laguerre.fmu", "--force"],
    );
    succeeds(
        at,
        &[
            "fmu",
            "export",
            "model.json",
            "--out",
            "laguerre.fmu",
            "--force",
        ],
    );
    assert_eq!(
        fs::read(at.join("laguerre.fmu")).unwrap(),
        first,
        "exports are reproducible"
    );
}

#[test]
fn wrong_studies_are_refused_with_line_and_key() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let good = aerodeck::study::demo_study_text();
    let cases: [(&str, &str, &[&str]); 14] = [
        ("width_m = 0.5", "widht_m = 0.5", &["line 9", "widht_m"]),
        (
            "width_m = 0.5",
            "width_m = 0.0",
            &["line 9", "section.width_m", "positive", "found 0"],
        ),
        ("width_m = 0.5", "width_m = \"half\"", &["line 9", "half"]),
        (
            "mass_kg_m = 15.0",
            "mass_kg_m = -15.0",
            &["section.vertical.mass_kg_m", "found -15"],
        ),
        (
            "mass_kg_m = 15.0",
            "mass_kg_m = nan",
            &["section.vertical.mass_kg_m", "found NaN"],
        ),
        (
            "frequency_hz = 2.0",
            "frequency_hz = 2.0, stiffness_n_m2 = 3.0",
            &["section.vertical", "both"],
        ),
        (
            "alpha = 0.6",
            "alpha = 1.5",
            &["line 3", "alpha", "found 1.5"],
        ),
        (
            "filters = 3, alpha",
            "filters = 0, alpha",
            &["filters", "at least 1", "found 0"],
        ),
        (
            "source = \"LN21-5200\"",
            "source = \"LN99\"",
            &["deck.source", "LN99", "LN21-5200"],
        ),
        (
            "source = \"LN21-5200\"",
            "source = \"missing.csv\"",
            &["missing.csv"],
        ),
        ("speed_groups = [1]", "speed_groups = [7]", &["groups", "7"]),
        (
            "schema = 1",
            "schema = 9",
            &["schema", "expected 1", "found 9"],
        ),
        ("speeds = 120", "speeds = 1", &["flutter"]),
        (
            "[export]",
            "[export]\nmodel = \"none\"",
            &["export.model", "Laguerre", "none"],
        ),
    ];
    for (from, to, fragments) in cases {
        assert!(good.contains(from), "{from}");
        fs::write(at.join("study.toml"), good.replacen(from, to, 1)).unwrap();
        let mut all = vec!["study.toml"];
        all.extend_from_slice(fragments);
        // a file that is named in the study stands in the message instead of the study
        if to.contains("missing.csv") {
            all.remove(0);
        }
        refused(at, &["study", "study.toml", "--out", "results"], &all);
    }
    refused(at, &["study", "nowhere.toml"], &["nowhere.toml"]);
    fs::write(at.join("study.toml"), "schema = [").unwrap();
    refused(at, &["study", "study.toml"], &["study.toml", "line 1"]);
}

#[test]
fn wrong_tables_and_records_are_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let good = aerodeck::study::demo_study_text();
    fs::write(at.join("table.csv"), "a,b\n1,2\n").unwrap();
    fs::write(
        at.join("study.toml"),
        good.replace("\"LN21-5200\"", "\"table.csv\""),
    )
    .unwrap();
    refused(at, &["study", "study.toml", "--out", "r"], &["table.csv"]);

    fs::write(at.join("study.toml"), good).unwrap();
    succeeds(at, &["tunnel", "study.toml", "--out", "t"]);
    let record = fs::read_dir(at.join("t/records"))
        .unwrap()
        .next()
        .unwrap()
        .unwrap()
        .path();
    let text = fs::read_to_string(&record).unwrap();
    let data = text.lines().position(|l| l.starts_with("time_s")).unwrap() + 1;
    let lines: Vec<&str> = text.lines().collect();
    let with = |name: &str, lines: Vec<String>| {
        fs::write(at.join(name), lines.join("\n") + "\n").unwrap();
        let source = "source = \"LN21-5200\"";
        let study = good.replace(source, &format!("{source}\nrecords = [\"{name}\"]"));
        fs::write(at.join("study.toml"), study).unwrap();
    };
    let owned = |range: std::ops::Range<usize>| {
        lines[range]
            .iter()
            .map(|l| (*l).to_owned())
            .collect::<Vec<_>>()
    };

    let mut nan = owned(0..lines.len());
    let columns: Vec<&str> = lines[data + 500].split(',').collect();
    nan[data + 500] = [&columns[..1], &["NaN"], &columns[2..]].concat().join(",");
    with("nan.csv", nan);
    refused(
        at,
        &["study", "study.toml", "--out", "r"],
        &["nan.csv", &format!("line {}", data + 501), "NaN"],
    );

    let mut gap = owned(0..lines.len());
    gap.drain(data + 500..data + 510);
    with("gap.csv", gap);
    refused(
        at,
        &["study", "study.toml", "--out", "r"],
        &["gap.csv", &format!("line {}", data + 501)],
    );

    with("short.csv", owned(0..data + 20));
    refused(at, &["study", "study.toml", "--out", "r"], &["short.csv"]);
}

#[test]
fn files_that_are_no_fmus_or_models_are_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("text.fmu"), "not an archive").unwrap();
    refused(at, &["fmu", "check", "text.fmu"], &["text.fmu"]);
    refused(at, &["fmu", "check", "absent.fmu"], &["absent.fmu"]);
    fs::write(at.join("model.json"), "{\"schema_version\": 1}").unwrap();
    refused(
        at,
        &["fmu", "export", "model.json"],
        &["model.json", "line"],
    );
    refused(at, &["simulate", "model.json"], &["model.json"]);
    refused(
        at,
        &["fmu", "export", "model.json", "--unknown"],
        &["--unknown"],
    );
}

#[test]
fn every_command_explains_itself_with_an_example() {
    let folder = TempDir::new().unwrap();
    for command in [
        "demo",
        "study",
        "tunnel",
        "train",
        "flutter",
        "simulate",
        "fmu export",
        "fmu check",
        "fmu replay",
        "validate",
        "thesis",
        "compare decks",
        "compare models",
        "new",
        "report",
        "plot",
        "completions",
    ] {
        let mut arguments: Vec<&str> = command.split(' ').collect();
        arguments.push("--help");
        let help = succeeds(folder.path(), &arguments);
        assert!(
            help.contains(&format!("Example: aerodeck {command}")),
            "{command}:\n{help}"
        );
        assert!(help.contains("--json"), "{command}:\n{help}");
    }
}
