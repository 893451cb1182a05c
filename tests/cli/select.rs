//! The model that `select` recommends goes into a study, written by the command or chosen by `study` itself.

use crate::command::{aerodeck, flowing, onset_of, succeeds};
use aerodeck::study::{Study, demo_study_text};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const SELECT: [&str; 7] = [
    "select",
    "study.toml",
    "--filters",
    "2",
    "--values",
    "4",
    "--write",
];

fn onset(folder: &Path, arguments: &[&str]) -> f64 {
    let answer: Value = serde_json::from_str(&succeeds(folder, arguments)).unwrap();
    let onset = onset_of(&answer["flutter"], "selected", "eigenvalues");
    onset["speed_m_s"].as_f64().unwrap()
}

#[test]
fn a_written_study_trains_the_recommended_model_first() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("study.toml"), demo_study_text()).unwrap();
    succeeds(at, &["tunnel", "study.toml"]);
    let said = succeeds(at, &SELECT);
    assert!(said.contains("wrote ./selected.toml"), "{said}");
    assert!(said.lines().all(|l| l.chars().count() <= 80), "{said}");
    let study = Study::read(&at.join("selected.toml")).unwrap();
    assert_eq!(study.models[0].name, "selected");
    let before = Study::read(&at.join("study.toml")).unwrap();
    assert_eq!(study.models[1..], before.models[..]);
    succeeds(at, &["train", "selected.toml"]);
    let speed = onset(at, &["flutter", "selected.toml", "--json"]);
    // all recommended models of this deck lie within its interval, 36.0 to 37.7 m/s
    assert!((36.0..37.7).contains(&speed), "{speed}");

    // a study that its owner has edited is left alone
    let edited = fs::read_to_string(at.join("selected.toml")).unwrap() + "# mine\n";
    fs::write(at.join("selected.toml"), &edited).unwrap();
    let said = succeeds(at, &SELECT);
    assert!(said.contains("kept ./selected.toml"), "{said}");
    assert_eq!(
        fs::read_to_string(at.join("selected.toml")).unwrap(),
        edited
    );
    succeeds(at, &[&SELECT[..], &["--force"]].concat());
    assert_ne!(
        fs::read_to_string(at.join("selected.toml")).unwrap(),
        edited
    );
}

/// One filter has its onset on LN21-5800 a tenth above that of the table.
#[test]
fn the_onset_of_the_table_is_beside_that_of_the_model() {
    let folder = TempDir::new().unwrap();
    let own = demo_study_text();
    let other = own.replace("source = \"LN21-5200\"", "source = \"LN21-5800\"");
    for (text, doubtful) in [(own, false), (&other, true)] {
        fs::write(folder.path().join("study.toml"), text).unwrap();
        let one = ["select", "study.toml", "--filters", "1", "--no-figures"];
        let said = flowing(&succeeds(folder.path(), &one));
        let json = succeeds(folder.path(), &[&one[..], &["--json"]].concat());
        let found: Value = serde_json::from_str(&json).unwrap();
        assert!(
            said.contains(&beside(&found["selection"]["recommended"])),
            "{said}"
        );
        assert_eq!(
            said.contains("the recommendation is doubtful"),
            doubtful,
            "{said}"
        );
    }
}

/// The sentence on the onset of the table, made of the numbers beside it.
fn beside(recommended: &Value) -> String {
    let number = |name: &str| recommended[name].as_f64().unwrap();
    let (own, table) = (number("onset_m_s"), number("table_onset_m_s"));
    let percent = number("above_table_percent");
    assert!((percent - 100.0 * (own / table - 1.0)).abs() < 1e-9);
    let side = if percent < 0.0 { "below" } else { "above" };
    let percent = percent.abs();
    format!(
        "The table by itself has its onset at {table:.2} m/s, the recommended model {percent:.1} % {side} it, at {own:.2} m/s"
    )
}

#[test]
fn a_study_chooses_its_own_model() {
    let folder = TempDir::new().unwrap();
    let text = format!("select = true\n{}", demo_study_text());
    fs::write(folder.path().join("study.toml"), text).unwrap();
    let (code, text, said) = aerodeck(folder.path(), &["study", "study.toml"]);
    assert_eq!(code, 0, "{said}\n{text}");
    let summary = fs::read_to_string(folder.path().join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let onset = onset_of(&summary, "selected", "eigenvalues");
    let speed = onset["speed_m_s"].as_f64().unwrap();
    assert!((36.0..37.7).contains(&speed), "{speed}");
    let said = beside(&summary["selection"]);
    assert!(flowing(&text).contains(&said), "{said}\n{text}");
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains(&said), "{said}");
    // the stages one by one give the same
    let at = folder.path();
    let stage = |name| {
        [
            name,
            "study.toml",
            "--no-figures",
            "--out",
            "stages",
            "--json",
        ]
    };
    succeeds(at, &stage("tunnel"));
    let missing = aerodeck(at, &stage("flutter")).2;
    assert!(
        missing.contains("models/selected.json: expected a trained model"),
        "{missing}"
    );
    let trained: Value = serde_json::from_str(&succeeds(at, &stage("train"))).unwrap();
    assert_eq!(beside(&trained["selection"]), said);
    let staged = self::onset(at, &stage("flutter"));
    // numbers of a file are read to the last digit or one beside it
    assert!((staged / speed - 1.0).abs() < 1e-9, "{staged} {speed}");
    // what is packed is the model that was chosen
    let model = fs::read_to_string(folder.path().join("model.json")).unwrap();
    assert!(model.contains("\"selected\""));
}
