//! Implausible inputs from the file to what is shown: first line, page, machine-readable answer and exit code.

use crate::command::{aerodeck, flowing, refused, succeeds};
use crate::girders::{GirderShape, write_tables};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// What a run with figures says: first lines, page, verdict.
struct Shown {
    code: i32,
    said: String,
    page: String,
    verdict: Value,
}

fn shown(folder: &Path, run: &[&str]) -> Shown {
    let (code, said, error) = aerodeck(folder, &[run, &["--out", "r"]].concat());
    assert!([0, 3].contains(&code), "{said}\n{error}");
    let page = fs::read_to_string(folder.join("r/report.html")).unwrap();
    let summary = fs::read_to_string(folder.join("r/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    Shown {
        code,
        said: flowing(&said),
        page,
        verdict: summary["verdict"].clone(),
    }
}

/// The finding stands in the answer, on the page and in the file, and nothing is green.
#[track_caller]
fn cannot_be_judged(shown: &Shown, required: &str, finding: &str) {
    let Shown {
        said,
        page,
        verdict,
        ..
    } = shown;
    let outcome = format!("? CANNOT BE JUDGED, required {required} m/s");
    let first = said.find(&outcome).expect(said);
    assert!(first < 60, "{said}");
    assert_eq!(shown.code, 3, "{said}");
    assert!(said.contains(finding), "{said}");
    assert!(!said.contains("✓"), "{said}");
    assert!(page.contains(&outcome), "the outcome is not on the page");
    let escaped = finding.replace('\'', "&#39;");
    assert!(page.contains(&escaped), "the finding is not on the page");
    assert!(page.contains("card open") && !page.contains("card met"));
    let doubts = verdict["doubts"].as_array().unwrap();
    let doubt = doubts
        .iter()
        .find(|d| d["text"].as_str().unwrap().contains(finding))
        .unwrap_or_else(|| panic!("{verdict}"));
    assert_eq!(doubt["severity"], "severe");
    assert_eq!(verdict["outcome"]["state"], "cannot_be_judged");
}

#[test]
fn a_damping_in_per_cent_reaches_the_page_of_a_section() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--out", "s.toml"]);
    let set = ["--set", "flutter.required_speed_m_s=20.0"];
    let right = shown(at, &[&["study", "s.toml"][..], &set].concat());
    assert_eq!(right.code, 0, "{}", right.said);
    let wrong = ["--set", "section.vertical.damping_ratio=0.3"];
    let wrong = shown(at, &[&["study", "s.toml"][..], &set, &wrong].concat());
    cannot_be_judged(
        &wrong,
        "20",
        "section.vertical.damping_ratio = 0.3: a ratio to critical damping is usually 0.0005 to 0.02; in per cent it would be 0.003",
    );
}

/// Numbers of the tunnel and of the export in another unit are refused where they stand.
#[test]
fn tunnel_and_export_have_their_units() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--out", "s.toml"]);
    for (set, said) in [
        (
            "export.part_of_onset=98",
            "export.part_of_onset: expected at most",
        ),
        ("export.step_size_s=20", "at most stop_time_s (10 s)"),
        ("tunnel.segment_s=-1", "tunnel.segment_s: expected"),
        ("name=''", "name: expected a name"),
    ] {
        refused(at, &["study", "s.toml", "--set", set], &[said]);
    }
}

/// Wind that does not blow square to the nodes: 91.7 m/s instead of 77, as the file that was converted from it says as well.
#[test]
fn axes_that_are_turned_reach_the_page_of_a_bridge_and_of_what_is_converted() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let run = ["bridge", "flutter", "bridge.toml"];
    write_tables(at, &GirderShape::default());
    let right = shown(at, &run);
    assert_eq!(right.code, 0, "{}", right.said);
    write_tables(
        at,
        &GirderShape {
            downwind: [0.5, -0.75f64.sqrt(), 0.0],
            ..GirderShape::default()
        },
    );
    let finding = "modes.axes.downwind: the line of the nodes is turned by 30.0° from the girder axis up × downwind";
    let turned = shown(at, &run);
    cannot_be_judged(&turned, "60", finding);

    succeeds(at, &["bridge", "convert", "bridge.toml", "one.csv"]);
    let bridge = fs::read_to_string(at.join("bridge.toml")).unwrap();
    let converted = bridge.replace("path = \".\"", "path = \"one.csv\"");
    assert!(converted != bridge);
    fs::write(at.join("converted.toml"), converted).unwrap();
    let converted = shown(at, &["bridge", "flutter", "converted.toml"]);
    cannot_be_judged(&converted, "60", finding);
    for key in ["headline", "outcome"] {
        assert_eq!(converted.verdict[key], turned.verdict[key]);
    }
}

/// Nodes may be left out, but not those that show what is odd.
#[test]
fn what_is_left_out_of_a_compact_file_hides_no_curve() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    write_tables(
        at,
        &GirderShape {
            bow: 0.2,
            ..GirderShape::default()
        },
    );
    let convert = ["bridge", "convert", "bridge.toml", "one.csv", "--every"];
    succeeds(at, &[&convert[..], &["4"]].concat());
    fs::remove_file(at.join("one.csv")).unwrap();
    refused(
        at,
        &[&convert[..], &["1000"]].concat(),
        &[
            "--every: expected as many nodes as show what is odd about all of them, found nodes: the nodes leave a straight line in plan",
        ],
    );
}

/// A model that was exported without rotations does not flutter, and that is no answer.
#[test]
fn a_bridge_without_rotations_cannot_be_judged() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    write_tables(at, &GirderShape::default());
    let shapes = fs::read_to_string(at.join("shapes.csv")).unwrap();
    let (heading, rows) = shapes.split_once('\n').unwrap();
    let still = |row: &str| {
        let cells: Vec<&str> = row.split(',').collect();
        format!("{},0,0,0\n", cells[..5].join(","))
    };
    let still: String = rows.lines().map(still).collect();
    fs::write(at.join("shapes.csv"), format!("{heading}\n{still}")).unwrap();
    let shown = shown(at, &["bridge", "flutter", "bridge.toml"]);
    let finding = "modes: none of the modes is mainly torsional; more of them may";
    cannot_be_judged(&shown, "60", finding);
}

/// What is there stays, the files of the bridge with `--force` too; and every mode keeps what the wind acts on.
#[test]
fn a_compact_file_replaces_nothing_unasked() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    write_tables(at, &GirderShape::default());
    let convert = |more: &[&'static str]| [&["bridge", "convert", "bridge.toml"], more].concat();
    succeeds(at, &convert(&["one.csv"]));
    let kept = "one.csv: expected no file there yet (or --force)";
    refused(at, &convert(&["one.csv"]), &[kept]);
    succeeds(at, &convert(&["one.csv", "--force"]));
    for input in ["shapes.csv", "bridge.toml"] {
        let before = fs::read(at.join(input)).unwrap();
        let kept = "expected another file than those the bridge is read from";
        refused(at, &convert(&[input, "--force"]), &[input, kept]);
        assert_eq!(fs::read(at.join(input)).unwrap(), before);
    }
    refused(
        at,
        &convert(&["two.csv", "--every", "16"]),
        &["--every: expected as many nodes as carry the shapes of all modes, found mode "],
    );
}
