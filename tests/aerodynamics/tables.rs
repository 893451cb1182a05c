//! Tables as laboratories and papers keep them go through the whole chain; no route answers beyond a table.

use crate::command::{flowing, onset_of, refused, succeeds};
use aerodeck::aerodynamics::derivatives::{
    Derivative, DerivativeTable, Extrapolation, InterpolatedTable, Interpolation,
};
use aerodeck::aerodynamics::{FlatPlate, Transfer};
use aerodeck::flutter::{FlutterSearch, OnsetSearch, determinant_onset, pk_onset};
use aerodeck::section::{Dof, SectionModel};
use serde_json::Value;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// The flat plate at these reduced velocities, tested at 8 m/s on a model of 0.5 m.
fn plate(v_hats: &[f64]) -> DerivativeTable {
    let frequencies: Vec<f64> = v_hats.iter().map(|v| 8.0 / (TAU * 0.5 * v)).collect();
    DerivativeTable::sampled("plate", &FlatPlate::default(), 0.5, &[8.0], &frequencies).unwrap()
}

/// A table that ends at V* = 8 knows nothing of a section that flutters at 77.2 m/s, V* = 12.9: with held values p-k said
/// "no flutter below 140 m/s".
#[test]
fn no_route_answers_beyond_the_table() {
    let table = plate(&[0.3, 0.5, 0.7, 0.9, 1.1, 8.0 / TAU]);
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    let model = InterpolatedTable::new(&table, &Dof::TWO, Extrapolation::Hold).unwrap();
    let range = model.tested_range();
    assert_eq!(model.known_range(), Some(range));
    let search = OnsetSearch {
        speed_max_m_s: 140.0,
        speeds: 140,
    };
    for found in [
        determinant_onset("", &structure, &model, range, 140.0).unwrap(),
        pk_onset("", &structure, &model, &search, Some(range)).unwrap(),
    ] {
        let FlutterSearch::StableUpTo(judged) = found else {
            panic!("{found:?}")
        };
        assert!(judged.to_m_s < 77.0, "{judged:?}");
        assert!(judged.not_judged.is_some(), "{judged:?}");
    }
}

/// One row a reduced velocity: six derivatives, semicolons and decimal commas, neither speeds nor width.
fn wide(table: &DerivativeTable) -> String {
    use Derivative::{A1, A2, A3, H1, H2, H3};
    let held = [H1, H2, H3, A1, A2, A3];
    let names: Vec<String> = held.iter().map(|d| format!("{d}*")).collect();
    let mut text = format!("v_hat;{}\n", names.join(";"));
    for i in 0..table.points(H1).len() {
        let of = |d: &Derivative| table.points(*d)[i].value.to_string();
        let values: Vec<String> = held.iter().map(of).collect();
        let row = format!("{};{}\n", table.points(H1)[i].v_hat, values.join(";"));
        text.push_str(&row.replace('.', ","));
    }
    text
}

fn study(folder: &Path, deck: &str) {
    let text = aerodeck::study::demo_study_text();
    let start = text.find("[deck]").unwrap();
    let end = start + text[start..].find("\n\n").unwrap();
    let text = format!("{}[deck]\n{deck}\n{}", &text[..start], &text[end..]);
    fs::write(folder.join("study.toml"), text).unwrap();
}

/// Such a table goes through `study`, `train` and `flutter`, which say what they took for granted.
#[test]
fn a_wide_table_without_speeds_goes_through_the_chain() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let v_hats = [14.0, 11.0, 8.5, 6.5, 5.0, 3.8, 2.8, 2.0, 1.4, 1.0];
    fs::write(at.join("paper.csv"), wide(&plate(&v_hats))).unwrap();
    study(
        at,
        "source = \"paper.csv\"\nconvention = { notation = \"scanlan\" }\nmissing = \"quasi_steady\"",
    );
    let (line, more) = (["study", "study.toml", "--out", "."], ["--verbose"]);
    let said = flowing(&succeeds(at, &line));
    let all = flowing(&succeeds(at, &[&line[..], &more].concat()));
    for part in [
        "H4* = K H2*, A4* = K A2* taken, quasi-steady, as stated",
        "the width 1 m",
        "the table states no mean wind speeds: records of the virtual tunnel take 8.17 m/s",
    ] {
        assert!(said.contains(part), "`{part}` is not in\n{said}");
    }
    for part in [
        "spread between interpolations: modified Akima over ln K",
        "K → 0 was not tested: H3*, A3* at the lowest tested K, 0.071",
    ] {
        assert!(all.contains(part), "`{part}` is not in\n{all}");
    }
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(at.join("summary.json")).unwrap()).unwrap();
    let own = onset_of(&summary, "interpolated table", "determinant");
    let speed = own["speed_m_s"].as_f64().unwrap();
    // the plate's 39.468; quasi-steady H4*, A4* lack the added mass and a term of order K²
    assert!((speed / 39.468 - 1.0).abs() < 0.02, "{speed}");
    assert_eq!(own["interval"]["kind"], "spread");
    assert!(own["interval"]["low_m_s"].as_f64().unwrap() <= speed);
    assert!(own["interval"]["high_m_s"].as_f64().unwrap() >= speed);
    for command in [
        &["train", "study.toml"][..],
        &["flutter", "study.toml", "--all"],
    ] {
        let said = succeeds(at, command);
        assert!(
            said.contains("warning: deck: the table does not hold H4*, A4*"),
            "{said}"
        );
    }
    let said = succeeds(at, &["flutter", "study.toml", "--all"]);
    assert!(
        said.contains("no 95 % interval: spread between interpolations"),
        "{said}"
    );
}

/// The study says how a table is read between its points; five points of the plate and a polygon over V̂ are far off.
#[test]
fn the_study_chooses_the_interpolation() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let mut text = Vec::new();
    let table = plate(&[0.6, 1.2, 2.2, 4.5, 8.0]);
    aerodeck::files::derivatives::write_csv(&table, &mut text).unwrap();
    fs::write(at.join("plate.csv"), text).unwrap();
    let mut speeds = Vec::new();
    for by in [Interpolation::ModifiedAkima, Interpolation::LinearVHat] {
        study(
            at,
            &format!("source = \"plate.csv\"\ninterpolation = \"{by}\""),
        );
        for command in ["tunnel", "train"] {
            succeeds(at, &[command, "study.toml"]);
        }
        let said = succeeds(at, &["flutter", "study.toml", "--json"]);
        let json: Value = serde_json::from_str(&said).unwrap();
        let own = onset_of(&json["flutter"], "interpolated table", "determinant");
        speeds.push(own["speed_m_s"].as_f64().unwrap());
    }
    assert!((speeds[0] / 39.468 - 1.0).abs() < 0.004, "{speeds:?}");
    assert!((speeds[1] / 39.468 - 1.0).abs() > 0.02, "{speeds:?}");
}

/// Keys that only a file can need are refused for an embedded deck; a way that there is not is named with its line.
#[test]
fn keys_that_do_not_fit_are_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    for (deck, fragments) in [
        (
            "source = \"LN21-5200\"\nwidth_m = 0.5",
            ["deck", "in a file"],
        ),
        (
            "source = \"LN21-5200\"\ninterpolation = \"akima\"",
            ["line ", "modified_akima"],
        ),
    ] {
        study(at, deck);
        refused(at, &["tunnel", "study.toml"], &fragments);
    }
}

/// PoliMi's numbers under Scanlan's names are pointed out, and nothing is changed.
#[test]
fn a_mislabelled_table_is_pointed_out() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(
        at,
        &[
            "derivatives",
            "convert",
            "LN21-5200",
            "polimi.csv",
            "--to",
            "polimi",
        ],
    );
    let text = fs::read_to_string(at.join("polimi.csv")).unwrap();
    let definition = text
        .lines()
        .find(|l| l.starts_with("# definition"))
        .unwrap();
    let mut text = text
        .replace(definition, "#")
        .replace("notation: polimi", "notation: scanlan");
    for (polimi, scanlan) in [("h", "H"), ("a", "A"), ("p", "P")] {
        for i in 1..=6 {
            text = text.replace(&format!("\n{polimi}{i},"), &format!("\n{scanlan}{i},"));
        }
    }
    fs::write(at.join("wrong.csv"), text).unwrap();
    // lines are cut for a terminal
    let said = succeeds(at, &["derivatives", "show", "wrong.csv"]);
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("H1* and A2* both positive"), "{said}");
    assert!(said.contains("read as PoliMi, over v_star"), "{said}");
    let said = succeeds(at, &["derivatives", "show", "polimi.csv"]);
    assert!(!said.contains("warning"), "{said}");
}

/// Heave and lift turned over in all derivatives is a similarity, `G -> S G S`: the onset stays. Turned over in some it moves.
#[test]
fn a_consistent_flip_of_heave_leaves_the_onset() {
    use Derivative::{A1, A4, H2, H3};
    let deck = aerodeck::files::derivatives::embedded::deck("LN21-5200").unwrap();
    let structure = SectionModel::table_4_1().structure().unwrap();
    let onset = |flipped: &[Derivative]| {
        let points = deck.derivatives().map(|d| {
            let sign = if flipped.contains(&d) { -1.0 } else { 1.0 };
            let mut points = deck.points(d).to_vec();
            points.iter_mut().for_each(|p| p.value *= sign);
            (d, points)
        });
        let table = DerivativeTable::new(
            "flipped",
            deck.width_m,
            deck.header.clone(),
            points.collect(),
        );
        let forces =
            InterpolatedTable::new(&table.unwrap(), &Dof::TWO, Extrapolation::Refuse).unwrap();
        let range = forces.tested_range();
        let found = determinant_onset("flipped", &structure, &forces, range, 80.0).unwrap();
        found.onset().map(|o| o.at.speed_m_s)
    };
    let right = onset(&[]).unwrap();
    assert!((onset(&[H2, H3, A1, A4]).unwrap() / right - 1.0).abs() < 1e-9);
    // what the tutorial says of it
    let partial = onset(&[A1, A4]).unwrap() / right;
    assert!((partial - 1.08).abs() < 0.005, "{partial}");
}
