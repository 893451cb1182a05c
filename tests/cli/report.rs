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
        "Records: forces and the model",
        "Root locus",
        "Motion below, at and above the onset",
        "wind_speed",
        "aerodeck study study.toml",
    ] {
        assert!(page.contains(word), "`{word}` is not in the report");
    }
    // as many degrees of freedom as the width of the interval stands for
    let freedom = page.split_once(" degrees of freedom)").unwrap().0;
    let said: f64 = freedom.rsplit("; ").next().unwrap().parse().unwrap();
    let interval = summary(&at.join("d"))["onsets"][0]["interval"].clone();
    let known = interval["degrees_of_freedom"].as_f64().unwrap();
    assert!((said - known).abs() <= 0.05, "{said} {known}");
    let answer = page.find("class=\"answer\"").unwrap();
    assert!(answer < page.find("What was asked</h2>").unwrap());
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
        // forces that were made from a table are not said to be measured
        if figure == "forces.svg" {
            assert!(
                svg.contains("made from the deck") && !svg.contains("measured"),
                "{svg}"
            );
            assert!(svg.contains("Forces by motion: vertical "), "{svg}");
        }
        // some renderers do not know it and hide the text under its halo
        assert!(!svg.contains("paint-order"), "{figure}");
    }
}

/// Words, exit code, page and line in the charts follow one outcome.
#[test]
fn a_required_speed_is_judged_by_the_lower_end_of_the_interval() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--out", "s.toml"]);
    let cases = [
        (30.0, "met", Value::Null, "✓ MET", "card met"),
        (
            36.7,
            "not_met",
            "lower_end".into(),
            "✗ NOT MET",
            "card not-met",
        ),
        (
            45.0,
            "not_met",
            "best_estimate".into(),
            "✗ NOT MET",
            "card not-met",
        ),
    ];
    for (required, state, below, words, class) in cases {
        let set = format!("flutter.required_speed_m_s={required}");
        let run = [
            "study",
            "s.toml",
            "--out",
            "r",
            "--set",
            &set,
            "--no-figures",
        ];
        let (code, said, error) = aerodeck(at, &run);
        assert_eq!(code, if state == "met" { 0 } else { 3 }, "{error}");
        let first = format!("LN21-5200: {words}, required {required} m/s: flutter onset 36.9");
        assert!(said.starts_with(&first), "{said}");
        let verdict = summary(&at.join("r"))["verdict"].clone();
        assert_eq!(verdict["outcome"]["state"], state, "{verdict}");
        assert_eq!(verdict["outcome"]["below"], below, "{verdict}");
        assert_eq!(verdict["critical"]["governs"]["phenomenon"], "flutter");
        let page = fs::read_to_string(at.join("r/report.html")).unwrap();
        assert!(page.contains(&format!("{words}, required {required} m/s")));
        assert!(page.contains(class), "{class}");
        // the line in the charts
        assert!(page.contains(&format!("\"required\":{required:?}")));
    }
    // the unit says the same
    let page = fmu_page(&at.join("r/deck_section.fmu"));
    assert!(page.contains("NOT MET, required 45 m/s"), "{page}");
    assert!(
        listing(at)
            .iter()
            .all(|n| !n.ends_with(".svg") && !n.ends_with(".png")),
        "figures in spite of --no-figures"
    );
}

/// The page that documents an FMU.
pub fn fmu_page(path: &Path) -> String {
    let mut archive = zip::ZipArchive::new(fs::File::open(path).unwrap()).unwrap();
    let mut page = archive.by_name("documentation/index.html").unwrap();
    let mut text = String::new();
    std::io::Read::read_to_string(&mut page, &mut text).unwrap();
    text
}

/// Tests that end at K 0.5 say nothing of wind in which motions are slower: what is missing is said, and nothing is green.
#[test]
fn tests_that_end_before_the_required_speed_cannot_judge_it() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--out", "s.toml"]);
    succeeds(at, &["derivatives", "convert", "LN21-5200", "whole.csv"]);
    let whole = fs::read_to_string(at.join("whole.csv")).unwrap();
    let mut points = std::collections::HashMap::new();
    let mut cut = String::new();
    for line in whole.lines() {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if let Some(Ok(v_hat)) = cells.get(3).map(|c| c.parse::<f64>()) {
            if v_hat > 2.2 {
                continue;
            }
            let point = points.entry(cells[0].clone()).or_insert(0);
            *point += 1;
            cells[1] = point.to_string();
        }
        cut.push_str(&(cells.join(",") + "\n"));
    }
    fs::write(at.join("cut.csv"), cut).unwrap();
    let run = [
        "study",
        "s.toml",
        "--out",
        "r",
        "--no-figures",
        "--set",
        "deck.source=\"cut.csv\"",
        "--set",
        "flutter.required_speed_m_s=25.0",
    ];
    let (code, said, error) = aerodeck(at, &run);
    assert_eq!(code, 3, "{error}");
    assert!(
        said.contains("? CANNOT BE JUDGED, required 25 m/s"),
        "{said}"
    );
    let verdict = summary(&at.join("r"))["verdict"].clone();
    let settled = verdict["outcome"]["settled_by"].to_string();
    assert!(settled.contains("tests at K 0.26–0.49"), "{settled}");
    let kinds: Vec<&str> = verdict["doubts"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|d| d["severity"] == "severe")
        .map(|d| d["kind"].as_str().unwrap())
        .collect();
    let expected = [
        "outside_tested_range",
        "not_judged_above",
        "not_judged_below",
        "interval_undetermined",
    ];
    assert_eq!(kinds, expected);
    let page = fs::read_to_string(at.join("r/report.html")).unwrap();
    assert!(page.contains("card open") && page.contains("Severe doubt."));
    // a distribution about that model says so
    let plan = "schema = 1\nmodel = \"r/model.json\"\nsamples = 50\ndesign_speed_m_s = 25.0\n[[parameter]]\nname = \"air_density_kg_m3\"\n\
                distribution = { kind = \"normal\", coefficient_of_variation = 0.01 }\n";
    fs::write(at.join("scatter.toml"), plan).unwrap();
    let said = flowing(&succeeds(at, &["monte-carlo", "scatter.toml"]));
    let words =
        "warning: of the model itself: Cannot be judged: The onset lies outside the tested range";
    assert!(said.contains(words), "{said}");
    // judged as the study judges: to the last digit by the same search
    let text = fs::read_to_string(at.join("monte_carlo.json")).unwrap();
    let beside: Value = serde_json::from_str(&text).unwrap();
    let from = |verdict: &Value| verdict["critical"]["judged_from_m_s"].as_f64().unwrap();
    assert_eq!(from(&beside["verdict"]), from(&verdict));
    // as it does where a mean is in another unit
    let mass = "[[parameter]]\nname = \"vertical.mass_kg_m\"\ndistribution = { kind = \"normal\", mean = 15000.0, coefficient_of_variation = 0.03 }\n";
    fs::write(at.join("scatter.toml"), format!("{plan}{mass}")).unwrap();
    let said = flowing(&succeeds(at, &["monte-carlo", "scatter.toml"]));
    let words =
        "warning: vertical.mass_kg_m = 15000: the mean of its distribution, where the model has ";
    assert!(said.contains(words), "{said}");
    let text = fs::read_to_string(at.join("monte_carlo.json")).unwrap();
    let written: Value = serde_json::from_str(&text).unwrap();
    let doubts = written["verdict"]["doubts"].as_array().unwrap();
    assert!(
        doubts.iter().any(|d| d.to_string().contains("15000")),
        "{doubts:?}"
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
    let said = succeeds(at, &["study", "mine.toml", "--out", "busy", "--no-figures"]);
    let named = "study_as_run.toml beside the page is the one that ran";
    assert!(flowing(&said).contains(named), "{said}");
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
    refused(
        at,
        &["plot", "a.csv", "--y", "sway_m"],
        &["sway_m", "heave_m"],
    );
}

/// Numbers of one study stand beside no other: what was computed from is that of the run, but its edges may be stated later.
#[test]
fn a_study_that_was_changed_since_the_run_has_no_report() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["demo", "--out", "d", "--no-figures"]);
    let study = fs::read_to_string(at.join("d/study.toml")).unwrap();
    let edges = "\n[report]\nproject = \"Strait crossing\"\n";
    fs::write(at.join("d/study.toml"), study.clone() + edges).unwrap();
    succeeds(at, &["report", "d"]);
    let page = fs::read_to_string(at.join("d/report.html")).unwrap();
    assert!(page.contains("Strait crossing"));
    let softer = "section.torsion.frequency_hz=4.4";
    let run = |line: &str| succeeds(at, &line.split(' ').collect::<Vec<_>>());
    run(&format!(
        "study d/study.toml --no-figures --out o --set {softer}"
    ));
    let wider = study.replace("width_m = 0.5", "width_m = 5.0");
    assert_ne!(wider, study);
    fs::write(at.join("d/study.toml"), wider).unwrap();
    let says = [
        "study.toml",
        "`study` again",
        "changed since the run (SHA-1",
    ];
    refused(at, &["report", "d"], &says);
    fs::remove_file(at.join("d/study.toml")).unwrap();
    succeeds(at, &["report", "d"]);
    // the FMU of another study in the place of its own
    let [own, other] = ["d", "o"].map(|folder| at.join(folder).join("deck_section.fmu"));
    let kept = fs::read(&own).unwrap();
    fs::copy(other, &own).unwrap();
    succeeds(at, &["report", "d"]);
    let page = || fs::read_to_string(at.join("d/report.html")).unwrap();
    let said = "The FMU beside this page is another one";
    assert!(page().contains(said) && !page().contains("<td>deck_section.fmu"));
    // and of its own model, but forces alone
    run("fmu export d/model.json --kind force --force --out d/deck_section.fmu");
    run("report d");
    assert!(page().contains(said) && !page().contains("<td>deck_section.fmu"));
    fs::write(own, kept).unwrap();
    succeeds(at, &["report", "d"]);
    assert!(!page().contains(said));
    let model = fs::read_to_string(at.join("d/model.json")).unwrap();
    fs::write(at.join("d/model.json"), model + " ").unwrap();
    refused(at, &["report", "d"], &["model.json", says[2]]);
    // the curves of another section beside the answer
    run("demo --out e --no-figures");
    let softer = "section.torsion.frequency_hz=4.5";
    run(&format!("flutter e/study.toml --no-figures --set {softer}"));
    refused(at, &["report", "e"], &["curves.csv", says[2]]);
}
