//! Names of users: refused where a terminal or a page would obey them, and never a formula of a spreadsheet.

use crate::command::{listing, refused, succeeds};
use crate::girders::{GirderShape, write_tables};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const REFUSED: &str = "expected a text without control characters, found one with them";

/// Plan of a short campaign.
const PLAN: &str = "[tunnel]\nfrequencies_hz = [0.5, 2.0]\nspeeds_m_s = [8.0]\nstill_s = 2.0\nsegment_s = 6.0\nramp_s = 2.0\n";

/// The table of a deck under another name.
fn table(folder: &Path, name: &str) {
    let deck = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/decks/LN21-5200.csv");
    let text = fs::read_to_string(deck).unwrap();
    let named = text.replacen("# name: LN21-5200", &format!("# name: {name}"), 1);
    assert!(named != text);
    fs::write(folder.join("table.csv"), named).unwrap();
    let study = aerodeck::study::demo_study_text().replace("\"LN21-5200\"", "\"table.csv\"");
    fs::write(folder.join("study.toml"), study).unwrap();
    fs::write(folder.join("plan.toml"), PLAN).unwrap();
}

/// A file of every kind that holds names, with an escape in one: refused with file and place, and nothing is written.
#[test]
fn names_that_a_terminal_obeys_are_refused_in_every_file() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    table(at, "a deck\u{1b}[31m");
    let line = fs::read_to_string(at.join("table.csv")).unwrap();
    let line = line.lines().position(|l| l.contains('\u{1b}')).unwrap() + 1;
    let said = format!("table.csv: line {line}: {REFUSED}");
    refused(at, &["study", "study.toml", "--out", "r"], &[&said]);
    let virtual_campaign = ["campaign", "virtual", "table.csv", "--plan", "plan.toml"];
    refused(at, &virtual_campaign, &[&said]);

    fs::write(at.join("study.toml"), aerodeck::study::demo_study_text()).unwrap();
    succeeds(at, &["tunnel", "study.toml"]);
    succeeds(at, &["train", "study.toml"]);
    let model = fs::read_to_string(at.join("model.json")).unwrap();
    let named = model.replacen("\"name\": \"", "\"name\": \"\\u001b[2J", 1);
    assert!(named != model);
    fs::write(at.join("named.json"), named).unwrap();
    for run in [
        &["simulate", "named.json"][..],
        &["fmu", "export", "named.json", "--out", "named.fmu"],
    ] {
        refused(at, run, &["named.json", &format!("name: {REFUSED}")]);
    }

    let record = listing(at)
        .into_iter()
        .find(|n| n.starts_with("records/") && n.ends_with(".csv"))
        .unwrap();
    let text = fs::read_to_string(at.join(&record)).unwrap();
    fs::write(
        at.join("r.csv"),
        text.replacen("# name: ", "# name: \u{7}", 1),
    )
    .unwrap();
    let study = aerodeck::study::demo_study_text().replace(
        "source = \"LN21-5200\"",
        "source = \"LN21-5200\"\nrecords = [\"r.csv\"]",
    );
    fs::write(at.join("study.toml"), study).unwrap();
    refused(
        at,
        &["study", "study.toml", "--out", "r"],
        &["r.csv: line ", REFUSED],
    );
}

#[test]
fn campaigns_and_bridges_with_such_names_are_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("plan.toml"), PLAN).unwrap();
    let made = [
        "campaign",
        "virtual",
        "jones",
        "--plan",
        "plan.toml",
        "--out",
        "c",
    ];
    succeeds(at, &made);
    let campaign = fs::read_to_string(at.join("c/campaign.toml")).unwrap();
    for key in ["[section]\nname = \"", "[[run]]\nname = \""] {
        assert!(campaign.contains(key), "{campaign}");
        let named = campaign.replacen(key, &format!("{key}\\u001b]0;"), 1);
        fs::write(at.join("c/campaign.toml"), named).unwrap();
        let check = ["campaign", "check", "c/campaign.toml"];
        refused(at, &check, &["campaign.toml: line ", "name: ", REFUSED]);
    }

    write_tables(at, &GirderShape::default());
    let nodes = fs::read_to_string(at.join("nodes.csv")).unwrap();
    let named = nodes.replacen("\n1001,", "\nA\u{1b}[1m,", 1);
    assert!(named != nodes);
    fs::write(at.join("nodes.csv"), named).unwrap();
    let flutter = ["bridge", "flutter", "bridge.toml", "--out", "r"];
    refused(at, &flutter, &["nodes.csv: line 2: ", REFUSED]);
}

/// Every cell of a file that a spreadsheet would compute.
fn formulas(text: &str) -> Vec<&str> {
    let rows = text.lines().filter(|l| !l.starts_with('#'));
    rows.flat_map(|l| l.split(','))
        .filter(|c| c.starts_with(['=', '+', '-', '@']) && c.parse::<f64>().is_err())
        .collect()
}

/// A campaign of a deck with the name of a formula: no cell and no name of a file begins with it, and it is read again.
#[test]
fn names_are_no_formulas_in_the_files_of_a_campaign() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    table(at, "=cmd|calc/..");
    let made = [
        "campaign",
        "virtual",
        "table.csv",
        "--plan",
        "plan.toml",
        "--out",
        "c",
    ];
    succeeds(at, &made);
    // a load cell is named by the user as well
    let plan = fs::read_to_string(at.join("c/plan.toml")).unwrap();
    let named = plan.replacen("name = \"near\"", "name = \"=near\"", 1);
    assert!(named != plan);
    fs::write(at.join("plan.toml"), named).unwrap();
    succeeds(at, &[&made[..], &["--force"]].concat());
    let truth = fs::read_to_string(at.join("c/truth.csv")).unwrap();
    assert!(truth.contains("\n'=cmd|calc/..-vertical-"), "{truth}");
    for name in listing(at).iter().filter(|n| n.starts_with("c/")) {
        assert!(
            !name.contains(['=', '|']) && !name.contains("calc/"),
            "{name}"
        );
        if name.ends_with(".csv") {
            let text = fs::read_to_string(at.join(name)).unwrap();
            assert_eq!(formulas(&text), Vec::<&str>::new(), "{name}");
        }
    }
    succeeds(at, &["campaign", "check", "c/campaign.toml"]);
    succeeds(at, &["tunnel", "study.toml", "--out", "t"]);
    let records = listing(&at.join("t"));
    assert!(
        records
            .iter()
            .any(|n| n.starts_with("records/_cmd_calc_..-vertical-")),
        "{records:?}"
    );
}

/// A node with the name of a formula: written as a text, and read again under its own name.
#[test]
fn names_of_nodes_are_no_formulas_in_the_compact_file() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    write_tables(at, &GirderShape::default());
    for name in ["nodes.csv", "shapes.csv"] {
        let text = fs::read_to_string(at.join(name)).unwrap();
        let named: String = text
            .lines()
            .map(|l| l.replace("1001,", "=1+2,") + "\n")
            .collect();
        fs::write(at.join(name), named).unwrap();
    }
    succeeds(at, &["bridge", "convert", "bridge.toml", "one.csv"]);
    let text = fs::read_to_string(at.join("one.csv")).unwrap();
    assert!(text.contains("\n'=1+2,"), "{text}");
    assert_eq!(formulas(&text), Vec::<&str>::new());
    let bridge = fs::read_to_string(at.join("bridge.toml")).unwrap();
    let again = bridge
        .replace("path = \".\"", "path = \"one.csv\"")
        .replace("motions =", "from = \"=1+2\"\nmotions =");
    assert!(again.contains("one.csv") && again.contains("from"));
    fs::write(at.join("again.toml"), again).unwrap();
    // which knows the node that its section begins with
    succeeds(at, &["bridge", "show", "again.toml", "--no-figures"]);
}
