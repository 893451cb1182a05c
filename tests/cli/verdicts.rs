//! Verdicts from the file to the first line, where other tests look at the machine-readable answer or at the library alone.

use crate::bridges::{THREE, TWO, langenuen_text};
use crate::command::{aerodeck, flowing, succeeds};
use aerodeck::files::derivatives::{embedded, write_csv};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// The modes that carry the flutter of Langenuen.
const EIGHT: &str = "select = [2, 3, 5, 12, 14, 16, 17, 23]\ndamping_ratio";

/// A bridge of eight modes with a required speed.
fn bridge(deck: &str, motions: &str, required: f64) -> String {
    langenuen_text(deck, motions, "modified_akima")
        .replace("damping_ratio", EIGHT)
        .replace(
            "[flutter]",
            &format!("[flutter]\nrequired_speed_m_s = {required:?}"),
        )
}

/// Exit code and verdict of the bridge of a file.
fn verdict_of(folder: &Path, text: &str) -> (i32, Value) {
    fs::write(folder.join("bridge.toml"), text).unwrap();
    let run = ["bridge", "flutter", "bridge.toml", "--no-figures", "--json"];
    let (code, said, error) = aerodeck(folder, &run);
    let value: Value = serde_json::from_str(&said).expect(&error);
    (code, value["verdict"].clone())
}

/// A verdict without doubts has no list of them.
fn doubt<'a>(verdict: &'a Value, kind: &str) -> Option<&'a Value> {
    let doubts = verdict["doubts"].as_array()?;
    doubts.iter().find(|d| d["kind"] == kind)
}

/// People and scripts read the first line.
#[test]
fn the_first_line_of_a_bridge_is_its_verdict() {
    let folder = TempDir::new().unwrap();
    for (required, code, words) in [
        (60.0, 0, "✓ MET, required 60 m/s: flutter onset 7"),
        (95.0, 3, "✗ NOT MET, required 95 m/s: flutter onset 7"),
    ] {
        fs::write(
            folder.path().join("bridge.toml"),
            bridge("LN21-5200", TWO, required),
        )
        .unwrap();
        let run = ["bridge", "flutter", "bridge.toml", "--no-figures"];
        let (found, said, error) = aerodeck(folder.path(), &run);
        assert_eq!(found, code, "{error}");
        let first = flowing(&said);
        assert!(
            first.starts_with(&format!("Langenuen LN21-5200: {words}")),
            "{said}"
        );
    }
}

/// A deck that pumps at 0° beside derivatives that are harmless: quasi-steady galloping is the critical speed.
#[test]
fn galloping_of_a_section_is_not_met() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let deck =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("data/coefficients/synthetic_box_girder.csv");
    let text = fs::read_to_string(deck).unwrap();
    let (head, rows) = text.split_once("angle_deg,c_d,c_l,c_m\n").unwrap();
    // dC_L/dα = −6 per rad, against which no drag helps
    let row = |row: &str| {
        let angle: f64 = row.split(',').next().unwrap().parse().unwrap();
        format!("{angle},0.1,{:.4},0.0\n", -6.0 * angle.to_radians())
    };
    let rows: String = rows.lines().map(row).collect();
    fs::write(
        at.join("pumps.csv"),
        format!("{head}angle_deg,c_d,c_l,c_m\n{rows}"),
    )
    .unwrap();
    succeeds(at, &["new", "--out", "s.toml"]);
    let study = fs::read_to_string(at.join("s.toml")).unwrap();
    let run = [
        "study",
        "s.toml",
        "--no-figures",
        "--out",
        "r",
        "--set",
        "flutter.required_speed_m_s=30.0",
    ];
    let (code, said, error) = aerodeck(at, &run);
    assert_eq!(code, 0, "{error}");
    assert!(
        flowing(&said).starts_with("LN21-5200: ✓ MET, required 30 m/s"),
        "{said}"
    );
    fs::write(
        at.join("s.toml"),
        format!("{study}\n[coefficients]\nsource = \"pumps.csv\"\n"),
    )
    .unwrap();
    let (code, said, error) = aerodeck(at, &run);
    assert_eq!(code, 3, "{error}");
    let first = flowing(&said);
    assert!(
        first.starts_with("LN21-5200: ✗ NOT MET, required 30 m/s: galloping"),
        "{said}"
    );
    let summary = fs::read_to_string(at.join("r/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(
        summary["verdict"]["critical"]["governs"]["phenomenon"],
        "galloping"
    );
}

/// A table of one mean wind speed says as much of a bridge as of a section.
#[test]
fn one_test_speed_of_a_bridge_is_said() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let deck = embedded::deck("LN21-5200").unwrap();
    let mut bytes = Vec::new();
    write_csv(&deck.at_speed_group(0).unwrap(), &mut bytes).unwrap();
    fs::write(at.join("one.csv"), bytes).unwrap();
    let (_, both) = verdict_of(at, &bridge("LN21-5200", TWO, 60.0));
    assert!(doubt(&both, "one_test_speed").is_none(), "{both:#}");
    let text = bridge("LN21-5200", TWO, 60.0)
        .replace("derivatives = \"LN21-5200\"", "derivatives = \"one.csv\"");
    let (_, one) = verdict_of(at, &text);
    let said = doubt(&one, "one_test_speed").unwrap_or_else(|| panic!("{one:#}"));
    let text = said["text"].as_str().unwrap();
    assert!(
        text.starts_with("Tests at one mean wind speed: how results scatter between speeds"),
        "{text}"
    );
}

/// One frequency determines no model: an interval of no width about an onset was taken for a known one.
#[test]
fn tests_of_one_frequency_have_no_interval() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--out", "s.toml"]);
    succeeds(at, &["derivatives", "convert", "LN21-5200", "whole.csv"]);
    let whole = fs::read_to_string(at.join("whole.csv")).unwrap();
    let kept =
        |line: &&str| line.starts_with('#') || line.contains("point") || line.contains(",5,");
    let one: Vec<&str> = whole.lines().filter(kept).collect();
    fs::write(at.join("one.csv"), one.join("\n").replace(",5,", ",1,")).unwrap();
    let run = [
        "study",
        "s.toml",
        "--no-figures",
        "--set",
        "deck.source=\"one.csv\"",
        "--set",
        "flutter.required_speed_m_s=20.0",
    ];
    let (code, said, _) = aerodeck(at, &run);
    let said = flowing(&said);
    assert!(
        code == 3 && said.contains("? CANNOT BE JUDGED, required 20 m/s"),
        "{said}"
    );
    assert!(
        said.contains("No interval of the onset: no form can be fitted"),
        "{said}"
    );
}

/// The model of one deck beside the table of another: two answers, and neither is relied on.
#[test]
fn a_model_and_a_table_that_contradict_each_other_cannot_be_judged() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--out", "s.toml"]);
    succeeds(at, &["tunnel", "s.toml"]);
    succeeds(at, &["train", "s.toml"]);
    let with_model = |deck: &str| {
        let model = "model = \"model.json\"\nmotions =";
        verdict_of(at, &bridge(deck, TWO, 60.0).replace("motions =", model))
    };
    let (code, own) = with_model("LN21-5200");
    assert_eq!(code, 0, "{own:#}");
    assert!(doubt(&own, "contradiction").is_none(), "{own:#}");
    let (code, other) = with_model("LN21-6100");
    let said = doubt(&other, "contradiction").unwrap_or_else(|| panic!("{other:#}"));
    let text = said["text"].as_str().unwrap();
    assert!(
        text.starts_with("Contradiction: ")
            && text.contains("by the tables")
            && text.contains("by the models"),
        "{text}"
    );
    assert_eq!((code, &said["severity"]), (3, &"severe".into()));
    assert_eq!(other["outcome"]["state"], "cannot_be_judged");
    a_model_alone_is_doubted(at, &bridge("LN21-5200", TWO, 60.0));
    // a study whose deck was changed takes neither the models nor the records of the deck before
    let study = fs::read_to_string(at.join("s.toml")).unwrap();
    let other = study.replace("source = \"LN21-5200\"", "source = \"LN21-6100\"");
    fs::write(at.join("s.toml"), other).unwrap();
    let (code, _, error) = aerodeck(at, &["flutter", "s.toml"]);
    assert!(
        code == 2 && error.contains("the deck of the study (run `aerodeck train` again)"),
        "{error}"
    );
    let (code, _, error) = aerodeck(at, &["train", "s.toml"]);
    assert!(
        code == 2 && error.contains("expected a record of LN21-6100"),
        "{error}"
    );
    succeeds(at, &["tunnel", "s.toml"]);
    succeeds(at, &["train", "s.toml"]);
}

/// Without a table beside it a model answers for itself: one whose onset lies above its tests is not packed, one of forces in kN is not
/// relied on.
fn a_model_alone_is_doubted(at: &Path, text: &str) {
    let text = text.replace("derivatives = \"LN21-5200\"", "model = \"changed.json\"");
    let model = fs::read_to_string(at.join("model.json")).unwrap();
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut model: Value = serde_json::from_str(&model).unwrap();
        change(&mut model);
        fs::write(at.join("changed.json"), model.to_string()).unwrap();
        verdict_of(at, &text)
    };
    let (code, right) = changed(&|_| ());
    assert_eq!(code, 0, "{right:#}");
    assert!(doubt(&right, "implausible_input").is_none(), "{right:#}");
    changed(&|model| model["tested_range"]["max"] = 0.3.into());
    let export = ["fmu", "export", "--bridge", "bridge.toml", "--out", "b.fmu"];
    let (code, _, error) = aerodeck(at, &export);
    assert_eq!(code, 1, "{error}");
    let error = flowing(&error);
    assert!(
        error.contains("the bridge is not exported: it grows"),
        "{error}"
    );
    assert!(!at.join("b.fmu").exists());
    let (code, odd) = changed(&|model| model["model"] = in_kn(&model["model"]));
    let said = doubt(&odd, "implausible_input").unwrap_or_else(|| panic!("{odd:#}"));
    assert!(
        said["text"].as_str().unwrap().contains("section "),
        "{said}"
    );
    assert_eq!((code, &said["severity"]), (3, &"severe".into()));
    // forces that go out alone have the verdict of their section
    let export = ["fmu", "export", "changed.json", "--kind", "force"];
    let (code, said, error) = aerodeck(at, &export);
    let said = flowing(&said);
    let doubted = said.contains("H1* is 0.00 times a flat plate's");
    assert!(code == 0 && doubted, "{said}{error}");
    assert!(said.contains("not on a structure that takes its forces"));
}

/// Forces a thousandth as large; poles and numbers of rows are as they were.
fn in_kn(model: &Value) -> Value {
    match model {
        Value::Object(all) => {
            let scaled = |(key, value): (&String, &Value)| {
                let kept = key.contains("pole");
                (key.clone(), if kept { value.clone() } else { in_kn(value) })
            };
            Value::Object(all.iter().map(scaled).collect())
        }
        Value::Array(all) => all.iter().map(in_kn).collect(),
        Value::Number(x) if x.is_f64() => x.as_f64().map(|x| 1e-3 * x).into(),
        other => other.clone(),
    }
}

/// Constraints on the fits of sections move the onset of a bridge as that of a section.
#[test]
fn constraints_that_move_the_onset_of_a_bridge_are_said() {
    let folder = TempDir::new().unwrap();
    let text = bridge("LN20-5500", THREE, 60.0);
    let (_, held) = verdict_of(folder.path(), &text);
    let said = doubt(&held, "constraints_moved_onset").unwrap_or_else(|| panic!("{held:#}"));
    let words = said["text"].as_str().unwrap();
    assert!(
        words.starts_with("Constraints moved the onset: by the data alone 76."),
        "{words}"
    );
    let [without, with] = ["without_m_s", "with_m_s"].map(|key| said[key].as_f64().unwrap());
    assert!(without < 0.97 * with, "{words}");
    // the data alone are what a fit without constraints gives
    let form = "form = { kind = \"laguerre\", filters = 3 }";
    let free = text.replace(
        "motions =",
        &format!("fit = {{ constraints = \"none\", {form} }}\nmotions ="),
    );
    let (_, free) = verdict_of(folder.path(), &free);
    assert!(
        doubt(&free, "constraints_moved_onset").is_none(),
        "{free:#}"
    );
    let headline = free["headline"].as_str().unwrap();
    let models = format!("the models: {without:.1} m/s");
    assert!(headline.contains(&models), "{models}: {headline}");
}

/// The code of an archive has the rights of who checks it: the command says whether it ran.
#[test]
fn a_check_says_whether_code_was_run() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/models/rational.json");
    fs::copy(model, at.join("model.json")).unwrap();
    succeeds(at, &["fmu", "export", "model.json", "--out", "a.fmu"]);
    let ran = succeeds(at, &["fmu", "check", "a.fmu"]);
    assert!(
        ran.contains("its code was run in this process: binaries/"),
        "{ran}"
    );
    let looked = succeeds(at, &["fmu", "check", "a.fmu", "--no-run"]);
    assert!(looked.contains("none of its code was run"), "{looked}");
    assert!(!looked.contains("in this process"), "{looked}");
}
