//! The report of a study and what a newcomer does around it: a new study, other values, results that can be run again.

use crate::browser;
use crate::command::{aerodeck, flowing, listing, refused, succeeds};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

const COLUMNS: usize = 80;

fn summary(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("summary.json")).unwrap()).unwrap()
}

/// The page says the answer first and loads nothing; written again from the folder it is the same.
#[test]
fn the_report_of_the_demo_stands_alone() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let said = succeeds(at, &["demo", "--out", "d"]);
    let first = said.lines().next().unwrap();
    assert!(first.contains("flutter onset 36.9 m/s, 36."), "{first}");
    assert!(first.ends_with("inside the tested range"), "{first}");
    for line in said.lines() {
        assert!(line.chars().count() <= COLUMNS, "{line}");
    }
    // the header of every record names it
    let licence = fs::read_to_string(at.join("d/records/LICENSE")).unwrap();
    assert!(licence.contains("Permission is hereby granted"));
    let page = fs::read_to_string(at.join("d/report.html")).unwrap();
    for word in [
        "Flutter onset 36.9 m/s",
        "What limits trust",
        "Derivatives: measured and modelled",
        "Records: measured forces and the model",
        "Root locus",
        "Motion below, at and above the onset",
        "wind_speed",
        "aerodeck study study.toml",
    ] {
        assert!(page.contains(word), "`{word}` is not in the report");
    }
    let answer = page.find("class=\"answer\"").unwrap();
    assert!(answer < page.find("What was asked").unwrap());
    fs::remove_file(at.join("d/report.html")).unwrap();
    succeeds(at, &["report", "d"]);
    assert!(
        fs::read_to_string(at.join("d/report.html")).unwrap() == page,
        "another page"
    );
    refused(at, &["report", "d", "--nonsense"], &["--nonsense"]);
    let (code, _, said) = aerodeck(at, &["report", "."]);
    assert_eq!(code, 2, "{said}");
    browser::stands_alone(&at.join("d/report.html"));
    for figure in [
        "flutter.svg",
        "derivatives.svg",
        "roots.svg",
        "response.svg",
        "forces.svg",
    ] {
        let svg = fs::read_to_string(at.join("d").join(figure)).unwrap();
        // some renderers do not know it and hide the text under its halo
        assert!(!svg.contains("paint-order"), "{figure}");
    }
}

#[test]
fn a_required_speed_is_judged_by_the_lower_end_of_the_interval() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--out", "s.toml"]);
    for (required, met) in [(30.0, true), (36.7, false), (45.0, false)] {
        let set = format!("flutter.required_speed_m_s={required}");
        succeeds(
            at,
            &[
                "study",
                "s.toml",
                "--out",
                "r",
                "--set",
                &set,
                "--no-figures",
            ],
        );
        let answer = summary(&at.join("r"))["answer"].clone();
        assert_eq!(answer["required_speed_met"], met, "{answer}");
        let page = fs::read_to_string(at.join("r/report.html")).unwrap();
        assert_eq!(page.contains("NOT met"), !met);
        // the line in the charts
        assert!(page.contains(&format!("\"required\":{required:?}")));
    }
    assert!(
        listing(at)
            .iter()
            .all(|n| !n.ends_with(".svg") && !n.ends_with(".png")),
        "figures in spite of --no-figures"
    );
}

#[test]
fn a_new_study_runs_and_edited_ones_are_kept() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["derivatives", "convert", "LN21-5800", "mine.xlsx"]);
    succeeds(
        at,
        &["new", "--workbook", "mine.xlsx", "--out", "mine.toml"],
    );
    let text = fs::read_to_string(at.join("mine.toml")).unwrap();
    assert!(text.contains("source = \"mine.xlsx\""), "{text}");
    fs::write(at.join("mine.toml"), text.replace("15.0", "16.0")).unwrap();
    refused(
        at,
        &["new", "--deck", "LN21-5200", "--out", "mine.toml"],
        &["--force"],
    );
    refused(
        at,
        &["new", "--deck", "LN99", "--out", "x.toml"],
        &["LN99", "LN21-5200"],
    );
    refused(
        at,
        &["new", "--deck", "LN21-5200", "--workbook", "mine.xlsx"],
        &["--workbook"],
    );

    // results elsewhere hold the study and what it reads, and can be run again by themselves
    succeeds(
        at,
        &["study", "mine.toml", "--out", "first", "--no-figures"],
    );
    let elsewhere = TempDir::new().unwrap();
    fs::rename(at.join("first"), elsewhere.path().join("moved")).unwrap();
    let moved = elsewhere.path().join("moved");
    let before = summary(&moved);
    assert_eq!(before["study_file"], "study.toml");
    succeeds(
        &moved,
        &["study", "study.toml", "--out", "again", "--no-figures"],
    );
    assert_eq!(summary(&moved.join("again"))["onsets"], before["onsets"]);
    // a study that stands in the folder is left alone
    fs::create_dir(at.join("busy")).unwrap();
    fs::write(at.join("busy/study.toml"), "# mine\n").unwrap();
    succeeds(at, &["study", "mine.toml", "--out", "busy", "--no-figures"]);
    assert_eq!(
        fs::read_to_string(at.join("busy/study.toml")).unwrap(),
        "# mine\n"
    );
    assert_eq!(summary(&at.join("busy"))["study_file"], "study_as_run.toml");
    // unless it is to be replaced
    let again = [
        "study",
        "mine.toml",
        "--out",
        "busy",
        "--no-figures",
        "--force",
    ];
    succeeds(at, &again);
    assert_eq!(summary(&at.join("busy"))["study_file"], "study.toml");
}

#[test]
fn a_study_comes_from_standard_input() {
    let folder = TempDir::new().unwrap();
    let study = aerodeck::study::demo_study_text();
    let mut child = Command::new(env!("CARGO_BIN_EXE_aerodeck"))
        .current_dir(folder.path())
        .args(["study", "-", "--out", "r", "--no-figures"])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    std::io::Write::write_all(child.stdin.as_mut().unwrap(), study.as_bytes()).unwrap();
    assert!(child.wait().unwrap().success());
    let left = fs::read_to_string(folder.path().join("r/study.toml")).unwrap();
    assert_eq!(left, study);
}

#[test]
fn what_is_said_on_a_wrong_command_line_is_json_too() {
    let folder = TempDir::new().unwrap();
    let (code, out, err) = aerodeck(folder.path(), &["flutter", "--nonsense", "--json"]);
    assert_eq!(code, 2);
    let said: Value = serde_json::from_str(&out).unwrap();
    assert!(
        said["error"].as_str().unwrap().contains("--nonsense"),
        "{said}"
    );
    assert!(err.contains("--nonsense"));
    let (code, out, _) = aerodeck(folder.path(), &["--json", "flutter", "--help"]);
    assert!(code == 0 && out.contains("Example: aerodeck flutter"));
}

#[test]
fn shells_complete_commands() {
    let folder = TempDir::new().unwrap();
    for shell in ["bash", "zsh", "fish"] {
        let script = succeeds(folder.path(), &["completions", shell]);
        assert!(script.contains("monte-carlo"), "{shell}");
    }
}

#[test]
fn any_table_of_results_can_be_drawn() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(
        at.join("a.csv"),
        "# from a test\ntime_s,heave_m,of\n0,1,x\n1,2,x\n0,3,y\n1,4,y\n",
    )
    .unwrap();
    succeeds(at, &["plot", "a.csv"]);
    let svg = fs::read_to_string(at.join("a.svg")).unwrap();
    for word in ["heave (m)", "time (s)", ">x<", ">y<"] {
        assert!(svg.contains(word), "{word}");
    }
    assert!(at.join("a.png").is_file());
    refused(
        at,
        &["plot", "a.csv", "--y", "sway_m"],
        &["sway_m", "heave_m"],
    );
}

#[test]
fn a_simulation_says_whether_the_motion_grows() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["demo", "--out", "d", "--no-figures"]);
    for (speed, says) in [("30", "dies down"), ("42", "GROWS")] {
        let run = [
            "simulate",
            "d/model.json",
            "--wind-speed",
            speed,
            "--no-figures",
        ];
        let said = flowing(&succeeds(at, &run));
        assert!(said.contains(says) && said.contains("Hz, growth"), "{said}");
    }
}
