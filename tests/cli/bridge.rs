//! The commands on whole bridges: what they print and write, and what they refuse.

use crate::bridges::{TWO, langenuen_text};
use crate::browser;
use crate::command::{aerodeck, flowing, listing, refused, succeeds};
use crate::report::fmu_page;
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// The modes that carry the flutter of Langenuen, so that a run takes a second.
pub(crate) fn folder() -> TempDir {
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
    let impossible = ["bridge", "flutter", "bridge.toml", "--samples", "0"];
    refused(
        folder.path(),
        &impossible,
        &["error: --samples: expected 2"],
    );
    let text = succeeds(
        folder.path(),
        &[
            "bridge",
            "flutter",
            "bridge.toml",
            "--samples",
            "20",
            "--verbose",
        ],
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
        "flutter_motion.svg",
        "flutter_motion.csv",
        "flutter_animation.csv",
        "report.html",
        "summary.json",
    ] {
        assert!(written.iter().any(|w| w == name), "{name}");
    }
    let animation = fs::read_to_string(folder.path().join("flutter_animation.csv")).unwrap();
    // 24 phases of 63 nodes and the heading
    assert_eq!(animation.lines().count(), 24 * 63 + 1);
}

/// In winds so different that no reduced frequency was tested in all of them nothing is met, by tables or by a model.
#[test]
fn winds_without_a_common_tested_frequency_cannot_be_judged() {
    let folder = folder();
    let path = folder.path().join("bridge.toml");
    let text = fs::read_to_string(&path)
        .unwrap()
        .replace("[flutter]", "[flutter]\nrequired_speed_m_s = 20.0");
    for lowest in ["0.0", "0.05"] {
        let points = format!(
            "{{ along_m = -617.5, factor = {lowest} }}, {{ along_m = 617.5, factor = 1.0 }}"
        );
        let profile = format!("{text}\n[wind]\nprofile = [{points}]\n");
        fs::write(&path, profile).unwrap();
        let (code, text, _) = aerodeck(folder.path(), &["bridge", "flutter", "bridge.toml"]);
        let text = flowing(&text);
        assert_eq!(code, 3, "{text}");
        for part in [
            "CANNOT BE JUDGED",
            "expected a reduced frequency at which all forces were tested, found none",
        ] {
            assert!(text.contains(part), "{part} is not in {text}");
        }
    }
}

/// The page says the answer first and loads nothing; written again from the folder it is the same.
#[test]
fn the_report_of_a_bridge_stands_alone() {
    let folder = folder();
    let at = folder.path();
    let flutter = ["bridge", "flutter", "bridge.toml"];
    let run = [&flutter[..], &["--out", "r"]].concat();
    succeeds(at, &run);
    let page = fs::read_to_string(at.join("r/report.html")).unwrap();
    let said = succeeds(at, &[&flutter[..], &["--json", "--out", "r"]].concat());
    let value: Value = serde_json::from_str(&said).unwrap();
    let answers = value["flutter"]["answers"].as_array().unwrap();
    let own = answers.last().unwrap();
    let speed = own["search"]["onset"]["speed_m_s"].as_f64().unwrap();
    let table = answers[0]["search"]["onset"]["speed_m_s"].as_f64().unwrap();
    let largest = own["motion"]["modes"][0]["mode"].as_u64().unwrap();
    for word in [
        &format!("Flutter onset {table:.1} m/s by the tables"),
        &format!("the models: {speed:.1} m/s"),
        &format!("<td>{speed:.2} m/s</td>"),
        "95 % interval",
        "What limits trust",
        "Modes that take part in the flutter",
        &format!("\"label\":\"mode {largest}\""),
        "Onset with fewer modes",
        "Motion at flutter",
        "Modes in still air",
        "LN21-5200",
        "aerodeck bridge flutter bridge.toml --out results",
    ] {
        assert!(page.contains(word), "`{word}` is not in the report");
    }
    let answer = page.find("class=\"answer\"").unwrap();
    assert!(answer < page.find("What was asked</h2>").unwrap());
    fs::remove_file(at.join("r/report.html")).unwrap();
    // a unit of other results says nothing of these
    fs::write(at.join("r/bridge.fmu"), "another").unwrap();
    succeeds(at, &["report", "r"]);
    let again = fs::read_to_string(at.join("r/report.html")).unwrap();
    assert!(again == page, "another page");
    browser::stands_alone(&at.join("r/report.html"));

    // what a study left in the folder of the bridge file is not lost
    fs::write(at.join("summary.json"), "{\"study\": \"mine\"}").unwrap();
    let said = succeeds(at, &[&flutter[..], &["--no-figures"]].concat());
    assert!(said.contains("report of a study"), "{said}");
    let left = fs::read_to_string(at.join("summary.json")).unwrap();
    assert_eq!(left, "{\"study\": \"mine\"}");
    assert!(!at.join("report.html").exists());
    assert!(
        !at.join("bridge_flutter.svg").exists(),
        "figures in spite of --no-figures"
    );
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

/// From the records to the onset with its interval and the unit; the folder gives the same answer again, by the model and the
/// covariance that were saved.
#[test]
fn the_demo_says_how_far_its_records_leave_the_onset_open() {
    let folder = TempDir::new().unwrap();
    succeeds(
        folder.path(),
        &["demo", "--bridge", "--no-figures", "--out", "r"],
    );
    let at = folder.path().join("r");
    assert!(at.join("bridge.fmu").exists());
    let own = || {
        let text = fs::read_to_string(at.join("summary.json")).unwrap();
        let value: Value = serde_json::from_str(&text).unwrap();
        let onsets = value["onsets"].as_array().unwrap();
        let own = onsets.iter().find(|o| o["model"] == "model").unwrap();
        let number = |of: &Value, key: &str| of[key].as_f64().unwrap();
        let interval = &own["interval"];
        ["low_m_s", "high_m_s", "standard_error_m_s"]
            .map(|key| number(interval, key))
            .into_iter()
            .chain([number(own, "speed_m_s")])
            .collect::<Vec<_>>()
    };
    let first = own();
    let [low, high, _, speed] = first[..] else {
        panic!("{first:?}");
    };
    assert!(low < speed && speed < high, "{first:?}");
    succeeds(&at, &["bridge", "flutter", "bridge.toml", "--no-figures"]);
    let again = own();
    // the ends of the interval differ: the covariance on file no longer knows the degrees of freedom of its tests
    for (a, b) in first.iter().zip(&again).skip(2) {
        assert!((a - b).abs() < 1e-6 * a, "{first:?}, {again:?}");
    }
    assert!(again[0] < speed && speed < again[1], "{again:?}");
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
    // the page says what the command does
    let said = flowing(&text);
    assert!(said.contains(" wrote bridge.fmu"), "{said}");
    let (headline, _) = said.split_once(" Verdict ").unwrap();
    let verdict = headline.strip_prefix("Langenuen LN21-5200: ").unwrap();
    assert!(verdict.starts_with("flutter onset 7"), "{headline}");
    let page = fmu_page(&folder.path().join("bridge.fmu"));
    assert!(page.contains(&format!("<p>{verdict}.</p>")), "{page}");
    assert!(page.contains("Static divergence at"), "{page}");
    let text = succeeds(folder.path(), &["fmu", "check", "bridge.fmu"]);
    assert!(text.ends_with("passed\n"), "{text}");
    // real variables alone
    let reals = [&export[..], &["--reals-only", "--out", "reals.fmu"]].concat();
    succeeds(folder.path(), &reals);
    let text = succeeds(folder.path(), &["fmu", "check", "reals.fmu"]);
    assert!(text.ends_with("passed\n"), "{text}");
    let mut archive =
        zip::ZipArchive::new(fs::File::open(folder.path().join("reals.fmu")).unwrap()).unwrap();
    let mut description = String::new();
    let mut entry = archive.by_name("modelDescription.xml").unwrap();
    std::io::Read::read_to_string(&mut entry, &mut description).unwrap();
    for kind in ["<Boolean", "<Integer", "<String", "<Enumeration"] {
        assert!(!description.contains(kind), "{kind}");
    }
    refused(
        folder.path(),
        &export,
        &["expected no file there yet (or --force)"],
    );
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
        &["bridge.toml: nodes: expected nodes of the bridge, 1001 to 1311, found `7`"],
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

/// The forces on all sections are one unit, and those on one that is named another.
#[test]
fn the_forces_of_all_sections_are_one_archive() {
    let folder = folder();
    let at = folder.path();
    let one = fs::read_to_string(at.join("bridge.toml")).unwrap();
    let (before, after) = one.split_once("[[section]]").unwrap();
    let (section, rest) = after.split_once("\n[").unwrap();
    let west = section.replace("\"girder\"", "\"west\"\nto = \"1151\"");
    let east = section.replace("\"girder\"", "\"east\"\nfrom = \"1156\"\nfilters = 2");
    let two = format!("{before}[[section]]{west}\n[[section]]{east}\n[{rest}");
    fs::write(at.join("two.toml"), two).unwrap();
    let export = ["fmu", "export", "two.toml", "--bridge", "--kind", "force"];
    for (more, file, strips) in [
        (
            &[][..],
            "bridge_force.fmu",
            "63 strips of Langenuen LN21-5200, wind forces, at the nodes 1001 to 1311",
        ),
        (
            &["--section", "east", "--out", "east.fmu"],
            "east.fmu",
            "32 strips of Langenuen LN21-5200, east, at the nodes 1156 to 1311",
        ),
    ] {
        let text = flowing(&succeeds(at, &[&export[..], more].concat()));
        assert!(text.contains(strips), "{text}");
        for command in ["check", "replay"] {
            succeeds(at, &["fmu", command, file]);
        }
    }
}

/// The parts of a bridge, and what they do not have.
#[test]
fn a_bridge_is_exported_in_parts() {
    let folder = folder();
    let at = folder.path();
    let part =
        |more: &[&'static str]| [&["fmu", "export", "bridge.toml", "--bridge"][..], more].concat();
    for kind in ["structure", "force"] {
        let text = succeeds(at, &part(&["--kind", kind]));
        assert!(text.contains("flutter onset 7"), "{text}");
        let file = format!("bridge_{kind}.fmu");
        assert!(
            fmu_page(&at.join(&file)).contains("flutter onset 7"),
            "{kind}"
        );
        let text = succeeds(at, &["fmu", "check", &file]);
        assert!(text.ends_with("passed\n"), "{text}");
    }
    let text = flowing(&succeeds(at, &["ssp", "export", "bridge.toml"]));
    let wrote = "wrote bridge.ssp: 2 units (structure, force), 378 connections, 27 parameters";
    assert!(text.contains(wrote), "{text}");
    refused(
        at,
        &["ssp", "export", "bridge.toml"],
        &["expected no file there yet"],
    );
    for (out, found) in [
        (".", "expected a file, or none yet, found a folder"),
        (
            "nofolder/x/b.ssp",
            "nofolder/x: archive: expected a folder to write into, found none",
        ),
    ] {
        refused(
            at,
            &["ssp", "export", "bridge.toml", "--out", out],
            &[found],
        );
    }
    for (more, message) in [
        (
            &["--kind", "force", "--strips", "3"][..],
            "--strips: expected none: the strips of a bridge",
        ),
        (
            &["--kind", "force", "--nodes", "1156"],
            "--nodes: expected none: forces act on all nodes",
        ),
        (
            &["--kind", "structure", "--prediction", "1"],
            "--prediction: expected --kind force with it",
        ),
        (
            &["--kind", "structure", "--gust-strips", "3"],
            "--gust-strips: expected --kind section",
        ),
        (
            &["--kind", "force", "--gusts", "deck.csv"],
            "--gusts: expected `static`, the coefficients",
        ),
        (
            &["--kind", "force", "--section", "tower"],
            "--section: expected one of the sections girder, found `tower`",
        ),
    ] {
        refused(at, &part(more), &[message]);
    }
    refused(
        at,
        &["fmu", "export", "model.json", "--kind", "structure"],
        &["--kind structure: expected --bridge with it"],
    );
}
