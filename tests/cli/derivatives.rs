//! Tables of derivatives from the command line: shown, converted, stated in a study.

use crate::command::{flowing, onset_of, refused, succeeds};
use aerodeck::aerodynamics::derivatives::Derivative;
use aerodeck::files::derivatives::embedded;
use aerodeck::files::derivatives::named_table;
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

#[test]
fn tables_are_converted_there_and_back() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let deck = embedded::deck("LN21-5200").unwrap();
    for notation in ["classical", "simiu", "polimi", "starossek"] {
        let file = format!("{notation}.csv");
        let text = succeeds(
            at,
            &[
                "derivatives",
                "convert",
                "LN21-5200",
                &file,
                "--to",
                notation,
            ],
        );
        assert!(
            text.contains("wrote") && text.contains("18 derivatives"),
            "{text}"
        );
        let header = fs::read_to_string(at.join(&file)).unwrap();
        assert!(header.contains(&format!("# notation: {notation}\n")));
        let back = format!("{notation}-back.csv");
        succeeds(
            at,
            &["derivatives", "convert", &file, &back, "--from", notation],
        );
        let again = named_table(&back, at).unwrap();
        for d in Derivative::ALL {
            for (p, q) in deck.points(d).iter().zip(again.points(d)) {
                assert!((p.value - q.value).abs() <= 1e-12 * p.value.abs());
                assert!((p.v_hat / q.v_hat - 1.0).abs() < 1e-12);
            }
        }
    }
    refused(
        at,
        &[
            "derivatives",
            "convert",
            "polimi.csv",
            "x.csv",
            "--from",
            "scanlan",
        ],
        &[
            "polimi.csv",
            "expected `scanlan` as stated on import, found `polimi`",
        ],
    );
    refused(
        at,
        &["derivatives", "convert", "LN21-5200", "x.txt"],
        &["a file name that ends in .csv or .xlsx"],
    );
    refused(
        at,
        &["derivatives", "show", "LN21-5200", "--to", "milan"],
        &["scanlan, simiu, classical, polimi, starossek"],
    );
}

/// A workbook in another notation states it in its notes and comes back without being told.
#[test]
fn workbooks_are_written_in_any_notation() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let convert = |from: &str, to: &str, more: &[&str]| {
        succeeds(at, &[&["derivatives", "convert", from, to], more].concat())
    };
    convert("LN21-5200", "p.xlsx", &["--to", "polimi"]);
    assert!(convert("p.xlsx", "back.csv", &[]).contains("from PoliMi, over v_star"));
    let deck = embedded::deck("LN21-5200").unwrap();
    let again = named_table("back.csv", at).unwrap();
    for d in Derivative::ALL {
        for (p, q) in deck.points(d).iter().zip(again.points(d)) {
            assert!((p.value - q.value).abs() <= 1e-12 * p.value.abs());
        }
    }
    refused(
        at,
        &["derivatives", "show", "p.xlsx", "--from", "classical"],
        &[
            "p.xlsx",
            "expected `classical` as stated on import, found `polimi`",
        ],
    );
}

#[test]
fn tables_are_shown_in_any_notation() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let text = succeeds(at, &["derivatives", "show", "LN21-5200", "--to", "polimi"]);
    for words in [
        "PoliMi, over v_star = V/(f B)",
        "h1*",
        "16 points",
        "8.18, 10.94 m/s",
    ] {
        assert!(text.contains(words), "`{words}` is not in {text}");
    }
    let points = succeeds(at, &["derivatives", "show", "LN21-5200", "--points"]);
    assert!(points.lines().count() > 18 * 16);
    let json: Value = serde_json::from_str(&succeeds(
        at,
        &[
            "derivatives",
            "show",
            "LN21-5200",
            "--to",
            "starossek",
            "--json",
        ],
    ))
    .unwrap();
    assert_eq!(json["table"]["convention"]["axes"], "heave_down");
    let first = &json["table"]["derivatives"][0];
    assert_eq!(first["name"], "c_pp_im");
    // c″_pp = (2/π) P1*: sway and drag on the diagonal keep their sign
    let value = first["points"][0]["value"].as_f64().unwrap();
    let p1 = embedded::deck("LN21-5200").unwrap().points(Derivative::P1)[0].value;
    assert!((value / (p1 * std::f64::consts::FRAC_2_PI) - 1.0).abs() < 1e-15);
    let list = succeeds(at, &["derivatives", "notations", "--sketch", "drawn"]);
    assert!(list.contains("k_semi = omega b/V") && list.contains("heave_down"));
    assert!(at.join("drawn/axes.svg").is_file());
}

/// The onset of a study does not depend on the notation its table is kept in; a wrong statement is refused.
#[test]
fn a_study_states_the_notation_of_its_table() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(
        at,
        &[
            "derivatives",
            "convert",
            "LN21-5200",
            "deck.csv",
            "--to",
            "classical",
        ],
    );
    let demo = aerodeck::study::demo_study_text();
    let blocks: Vec<&str> = demo.split("[[model]]").collect();
    let rest = &blocks[3][blocks[3].find("[flutter]").unwrap()..];
    let study = format!("{}[[model]]{}{rest}", blocks[0], blocks[2]);
    let onset = |source: &str, name: &str| {
        let text = study.replace("source = \"LN21-5200\"", source);
        fs::write(at.join(name), text).unwrap();
        let out = name.trim_end_matches(".toml");
        succeeds(at, &["study", name, "--out", out]);
        let summary = fs::read_to_string(at.join(out).join("summary.json")).unwrap();
        let summary: Value = serde_json::from_str(&summary).unwrap();
        onset_of(&summary, "rational functions", "eigenvalues")["speed_m_s"]
            .as_f64()
            .unwrap()
    };
    let embedded = onset("source = \"LN21-5200\"", "a.toml");
    let stated = onset(
        "source = \"deck.csv\"\nconvention = { notation = \"classical\", axes = \"heave_down\" }",
        "b.toml",
    );
    // one rounding more in every number
    assert!(
        (embedded / stated - 1.0).abs() < 1e-9,
        "{embedded} {stated}"
    );
    let wrong = |convention: &str, source: &str| {
        let source = format!("source = \"{source}\"\nconvention = {convention}");
        let text = study.replace("source = \"LN21-5200\"", &source);
        fs::write(at.join("c.toml"), text).unwrap();
    };
    wrong("{ notation = \"scanlan\" }", "deck.csv");
    refused(
        at,
        &["study", "c.toml", "--out", "c"],
        &[
            "deck.csv",
            "expected `scanlan` as stated on import, found `classical`",
        ],
    );
    wrong("{ notation = \"scanlan\" }", "LN21-5200");
    refused(at, &["study", "c.toml", "--out", "c"], &["deck.convention"]);
    wrong("{ notation = \"milan\" }", "deck.csv");
    refused(at, &["study", "c.toml", "--out", "c"], &["c.toml", "milan"]);
}

/// A paper's table without the width of its model: the table says that 1 m is assumed, a study that states the deck's does not.
#[test]
fn a_stated_width_is_no_assumption() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let deck = embedded::deck("LN21-5200").unwrap();
    let columns = [
        Derivative::H1,
        Derivative::H2,
        Derivative::H3,
        Derivative::H4,
        Derivative::A1,
        Derivative::A2,
        Derivative::A3,
        Derivative::A4,
    ];
    let mut wide = "# notation: scanlan\n# argument: v_hat\n# axes: heave_up\nv_hat".to_owned();
    columns.iter().for_each(|d| wide += &format!(",{d}"));
    for d in columns {
        for point in &deck.points(d)[..8] {
            let cells = columns.map(|c| {
                if c == d {
                    point.value.to_string()
                } else {
                    String::new()
                }
            });
            wide += &format!("\n{},{}", point.v_hat, cells.join(","));
        }
    }
    fs::write(at.join("paper.csv"), wide + "\n").unwrap();
    let assumed = "1 m is assumed";
    let said = flowing(&succeeds(at, &["derivatives", "show", "paper.csv"]));
    assert!(said.contains(assumed), "{said}");
    succeeds(at, &["new", "--workbook", "paper.csv", "--out", "s.toml"]);
    let said = flowing(&succeeds(
        at,
        &["study", "s.toml", "--out", "r", "--no-figures"],
    ));
    assert!(
        said.contains("paper: flutter onset") || said.contains("paper.csv: flutter onset"),
        "{said}"
    );
    let summary = fs::read_to_string(at.join("r/summary.json")).unwrap();
    let page = fs::read_to_string(at.join("r/report.html")).unwrap();
    for text in [said, summary, page] {
        assert!(!text.contains(assumed), "{text}");
    }
}

/// A table of another program with its sheet and convention goes into a study, and the study runs it from a copy.
#[test]
fn a_sheet_of_a_workbook_goes_into_a_study() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let from = format!("{}/tests/data/wide_table.ods", env!("CARGO_MANIFEST_DIR"));
    std::fs::copy(from, at.join("table.ods")).unwrap();
    let new = [
        "new",
        "--workbook",
        "table.ods",
        "--sheet",
        "Derivatives",
        "--from",
        "scanlan",
    ];
    succeeds(at, &new);
    let study = std::fs::read_to_string(at.join("study.toml")).unwrap();
    let lines = "source = \"table.ods#Derivatives\"\nconvention = { notation = \"scanlan\" }\n";
    assert!(study.contains(lines), "{study}");
    let shown = [
        "derivatives",
        "show",
        "table.ods#Derivatives",
        "--from",
        "scanlan",
    ];
    assert!(succeeds(at, &shown).contains("H1*      4 points"));
    refused(
        at,
        &["derivatives", "show", "table.ods", "--sheet", "Angle"],
        &["expected a sheet `Angle`, found `Derivatives`"],
    );
    succeeds(at, &["derivatives", "template", "empty.xlsx"]);
    refused(
        at,
        &["derivatives", "template", "empty.xlsx"],
        &["expected no file there yet (or --force)"],
    );
}

/// What is taken for granted on the way is said, and the table that is read stays as it is.
#[test]
fn a_conversion_warns_as_show_does_and_keeps_its_input() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let table = "# notation: scanlan\nv_hat,H1,H2,H3,A1,A2,A3\n2,-9.1,0.8,13.6,-2.4,-0.6,3.5\n4,-20,1,60,-5,-1,15\n";
    fs::write(at.join("t.csv"), table).unwrap();
    let convert = ["derivatives", "convert", "t.csv", "out.csv"];
    let said = flowing(&succeeds(at, &convert));
    let shown = succeeds(at, &["derivatives", "show", "t.csv", "--json"]);
    let shown: Value = serde_json::from_str(&shown).unwrap();
    let json = succeeds(at, &[&convert[..], &["--json"]].concat());
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["warnings"], shown["warnings"]);
    for part in [
        "warning: the table does not hold H4*, A4*: taken as zero",
        "1 m is assumed",
    ] {
        assert!(said.contains(part), "{said}");
    }
    let kept = "t.csv: out: expected another file than the table that is read";
    refused(at, &["derivatives", "convert", "t.csv", "./t.csv"], &[kept]);
    assert_eq!(fs::read_to_string(at.join("t.csv")).unwrap(), table);
}
