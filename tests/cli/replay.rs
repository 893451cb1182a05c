//! `fmu replay`: an archive says whether it does what its exporter meant, and what was spoilt in it.

use crate::command::{self, flowing, refused, succeeds};
use serde_json::Value;
use std::fs;
use std::io::{Cursor, Read, Write};
use std::path::Path;
use tempfile::TempDir;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// The archive with one entry changed.
fn spoil(from: &Path, to: &Path, entry: &str, change: impl Fn(&str) -> String) {
    let mut old = ZipArchive::new(Cursor::new(fs::read(from).unwrap())).unwrap();
    let mut new = ZipWriter::new(fs::File::create(to).unwrap());
    for index in 0..old.len() {
        let mut file = old.by_index(index).unwrap();
        let name = file.name().unwrap().into_owned();
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).unwrap();
        if name == entry {
            let text = String::from_utf8(bytes).unwrap();
            let changed = change(&text);
            assert_ne!(changed, text, "{entry}");
            bytes = changed.into_bytes();
        }
        new.start_file(name, SimpleFileOptions::default()).unwrap();
        new.write_all(&bytes).unwrap();
    }
    new.finish().unwrap();
}

/// Exit code 1 and the sentence.
#[track_caller]
fn not_as_meant(folder: &Path, file: &str, fragments: &[&str]) {
    let (code, stdout, stderr) = command::aerodeck(folder, &["fmu", "replay", file]);
    assert_eq!(code, 1, "{stdout}\n{stderr}");
    let said = flowing(&stdout);
    for fragment in fragments {
        assert!(said.contains(fragment), "`{fragment}` is not in: {said}");
    }
}

/// Files beside a sound unit that say too little, or something else.
fn spoilt_references(at: &Path) {
    let [whole, spoilt] = ["unit.fmu", "spoilt.fmu"].map(|name| at.join(name));
    let of = |name: &str| format!("extra/org.fmi-standard.fmi-ls-ref/{name}");
    spoil(&whole, &spoilt, &of("smoke_test_out.csv"), |text| {
        let times = text.lines().map(|line| line.split(',').next().unwrap());
        times.collect::<Vec<_>>().join("\n")
    });
    not_as_meant(
        at,
        "spoilt.fmu",
        &["outputs beside the time", "found 0 outputs"],
    );
    spoil(&whole, &spoilt, &of("smoke_test_out.csv"), |text| {
        let later = text.lines().map(|line| match line.split_once(',') {
            Some((time, rest)) => match time.parse::<f64>() {
                Ok(time) => format!("{},{rest}", 3.0 * time + 1.0),
                Err(_) => line.to_owned(),
            },
            None => line.to_owned(),
        });
        later.collect::<Vec<_>>().join("\n")
    });
    not_as_meant(at, "spoilt.fmu", &["outputs at 0 s, found at 1 s"]);
    spoil(&whole, &spoilt, &of("as_exported.ssv"), |text| {
        text.replacen("value=\"", "value=\"x", 1)
    });
    not_as_meant(
        at,
        "spoilt.fmu",
        &["as_exported.ssv", "a name, and a `Real` with its `value`"],
    );
    spoil(&whole, &spoilt, &of("as_exported.ssv"), |text| {
        text.replacen("name=\"mass\"", "name=\"heave\"", 1)
    });
    not_as_meant(
        at,
        "spoilt.fmu",
        &["`heave`: expected one that can be set, found output"],
    );
    spoil(&whole, &spoilt, &of("smoke_test.exp"), |text| {
        text.replace("stepSize=\"0.1\"", "stepSize=\"1e-12\"")
    });
    not_as_meant(
        at,
        "spoilt.fmu",
        &["outputs beside the time, in 1000000000"],
    );
}

#[test]
fn an_archive_is_what_its_exporter_meant_until_it_is_spoilt() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/models");
    let model = models.join("rational.json");
    let model = model.to_str().unwrap();
    for (fmi, other) in [("2", "3"), ("3", "2")] {
        let export = [
            "fmu", "export", model, "--fmi", fmi, "--out", "unit.fmu", "--force",
        ];
        succeeds(at, &export);
        let bytes = fs::read(at.join("unit.fmu")).unwrap();
        succeeds(at, &export);
        assert!(
            bytes == fs::read(at.join("unit.fmu")).unwrap(),
            "FMI {fmi}, not {other}"
        );
        let said = flowing(&succeeds(at, &["fmu", "replay", "unit.fmu"]));
        let meant = ": as the exporter meant: 4 runs, ";
        assert!(
            said.contains(meant) && said.contains("largest difference 0"),
            "{said}"
        );
        let json = succeeds(at, &["fmu", "replay", "unit.fmu", "--json"]);
        let json: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(json["as_the_exporter_meant"], true);
        assert_eq!(json["platforms"][0]["runs"][0]["difference"], 0.0);

        let [whole, spoilt] = ["unit.fmu", "spoilt.fmu"].map(|name| at.join(name));
        spoil(&whole, &spoilt, "resources/model.json", |text| {
            text.replace("\"mass_kg_m\": 15.0", "\"mass_kg_m\": 15.5")
        });
        not_as_meant(
            at,
            "spoilt.fmu",
            &[
                "not as the exporter meant",
                "was not instantiated",
                "resources/model.json",
            ],
        );

        // an importer that sets nothing has the numbers of the model, whatever the description says
        for (input, wrong) in [("15.0", "16.0"), ("38.0", "39.0")] {
            spoil(&whole, &spoilt, "modelDescription.xml", |text| {
                text.replacen(
                    &format!("start=\"{input}\""),
                    &format!("start=\"{wrong}\""),
                    1,
                )
            });
            let said = format!("expected its start value {}", wrong.trim_end_matches(".0"));
            not_as_meant(at, "spoilt.fmu", &[&said]);
            let (code, text, _) = command::aerodeck(at, &["fmu", "check", "spoilt.fmu"]);
            assert!(code == 1 && flowing(&text).contains(&said), "{text}");
        }

        spoil(&whole, &spoilt, "modelDescription.xml", |text| {
            text.replacen("start=\"38.0\"", "start=\"NaN\"", 1)
        });
        not_as_meant(at, "spoilt.fmu", &["expected a start value, found none"]);

        let result = "extra/org.fmi-standard.fmi-ls-ref/above_out.csv";
        spoil(&whole, &spoilt, result, |text| {
            let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
            let mut cells: Vec<String> = lines[30].split(',').map(str::to_owned).collect();
            let lift: f64 = cells[4].parse().unwrap();
            cells[4] = (1.01 * lift + 1e-3).to_string();
            lines[30] = cells.join(",");
            lines.join("\n")
        });
        not_as_meant(
            at,
            "spoilt.fmu",
            &[
                "not as the exporter meant: in the run `above`",
                "they differ by",
            ],
        );

        let experiments = "extra/org.fmi-standard.fmi-ls-ref/validation.exp";
        spoil(&whole, &spoilt, experiments, |text| {
            text.replace("above_in.csv", "../../../above_in.csv")
        });
        not_as_meant(
            at,
            "spoilt.fmu",
            &["not as the exporter meant", "a file of the archive"],
        );
    }
    spoilt_references(at);
    // each strip has more inputs than half of those that move
    for fmi in ["2", "3"] {
        let export = ["fmu", "export", model, "--kind", "force", "--strips", "3"];
        let gusts = [
            "--gusts",
            "flat plate",
            "--fmi",
            fmi,
            "--out",
            "strips.fmu",
            "--force",
        ];
        succeeds(at, &[&export[..], &gusts].concat());
        let said = flowing(&succeeds(at, &["fmu", "replay", "strips.fmu"]));
        assert!(said.contains("largest difference 0"), "FMI {fmi}: {said}");
    }
    let without = [
        "fmu",
        "export",
        model,
        "--no-reference",
        "--out",
        "without.fmu",
    ];
    succeeds(at, &without);
    refused(
        at,
        &["fmu", "replay", "without.fmu"],
        &["expected reference runs", "found none"],
    );
}
