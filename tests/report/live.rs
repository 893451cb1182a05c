//! The sliders of a report: the module for WebAssembly in the page answers what the command line does.

use crate::browser;
use crate::command::succeeds;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// Of the onset and its frequency, relative; of damping ratios and frequencies of the curves, absolute.
const SAME: f64 = 1e-12;
/// Reads a page and asks its module, through the script of the page, for every section of a file.
const ASK: &str = r#"
const fs = require("fs");
const page = fs.readFileSync(process.argv[2], "utf8");
const script = id => page.match(new RegExp(`<script[^>]* id="${id}">([^]*?)</script>`))[1];
const { module: core, ...given } = JSON.parse(script("live-data"));
new Function(script("live-core") + "; return liveCore")()(core).then(ask => {
  const times = [];
  const answers = JSON.parse(fs.readFileSync(process.argv[3], "utf8")).map(changes => {
    const section = structuredClone(given.section);
    for (const [part, key, value] of changes) section[part][key] = value;
    const start = performance.now();
    const answer = ask({ ...given, section });
    times.push(performance.now() - start);
    return answer;
  });
  console.log(JSON.stringify({ answers, times }));
});
"#;

#[test]
fn the_sliders_of_a_report_answer_what_the_command_line_does() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["demo", "--out", "d"]);
    let page = at.join("d/report.html");
    let text = fs::read_to_string(&page).unwrap();
    if !text.contains("id=\"live-data\"") {
        eprintln!("the program has no module for the sliders of the report: they are not tested");
        return;
    }
    assert!(!browser::without_sliders(&text).contains("live-data"));
    compare(at, &page);
    in_a_browser(&page);
}

/// Section, mass, torsional frequency, damping.
fn compare(at: &Path, page: &Path) {
    let sections = [
        json!([]),
        json!([["vertical", "mass_kg_m", 21.5]]),
        json!([["torsion", "frequency_hz", 3.7]]),
        json!([
            ["vertical", "damping_ratio", 0.008],
            ["torsion", "damping_ratio", 0.012]
        ]),
    ];
    let (script, questions) = (at.join("ask.cjs"), at.join("questions.json"));
    fs::write(&script, ASK).unwrap();
    fs::write(&questions, json!(sections).to_string()).unwrap();
    let Ok(output) = Command::new("node")
        .args([&script, &page.to_path_buf(), &questions])
        .output()
    else {
        eprintln!("no node here: the module is not compared with the command line");
        return;
    };
    assert!(output.status.success(), "{output:?}");
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mut speeds = Vec::new();
    for (i, section) in sections.iter().enumerate() {
        let live = &said["answers"][i];
        let mut run = vec!["flutter".to_owned(), "d/study.toml".to_owned()];
        run.push("--json".into());
        for change in section.as_array().unwrap() {
            let (part, key) = (change[0].as_str().unwrap(), change[1].as_str().unwrap());
            run.extend([
                "--set".into(),
                format!("section.{part}.{key}={}", change[2]),
            ]);
        }
        let run: Vec<&str> = run.iter().map(String::as_str).collect();
        let told: Value = serde_json::from_str(&succeeds(at, &run)).unwrap();
        let (onset, curve) = differences(live, &told["flutter"]);
        eprintln!(
            "{section}: onset {} m/s, differs by {onset:.1e} relative, curves by {curve:.1e}, {:.1} ms",
            live["search"]["onset"]["speed_m_s"],
            said["times"][i].as_f64().unwrap()
        );
        assert!(onset < SAME && curve < SAME, "{section}: {onset} {curve}");
        speeds.push(live["search"]["onset"]["speed_m_s"].as_f64().unwrap());
    }
    // the sections are not one and the same
    speeds.sort_by(f64::total_cmp);
    assert!(speeds.windows(2).all(|v| v[1] - v[0] > 0.1), "{speeds:?}");
}

/// Largest difference of onset speed and frequency, relative, and of the curves.
fn differences(live: &Value, told: &Value) -> (f64, f64) {
    let number = |v: &Value| v.as_f64().unwrap_or_else(|| panic!("{v} is no number"));
    let list = |v: &Value| v.as_array().unwrap_or_else(|| panic!("{v}")).clone();
    let own = &live["search"]["onset"];
    let onset = list(&told["onsets"])
        .into_iter()
        .find(|o| o["model"] == own["model"] && o["method"] == "eigenvalues")
        .unwrap();
    assert_eq!(own["in_tested_range"], onset["in_tested_range"]);
    let relative = ["speed_m_s", "frequency_hz", "reduced_velocity"]
        .map(|key| (number(&own[key]) / number(&onset[key]) - 1.0).abs());
    let curves = list(&told["curves"]);
    let curves = curves.iter().find(|c| c["model"] == own["model"]).unwrap();
    let (modes, branches) = (list(&live["modes"]), list(&curves["branches"]));
    assert_eq!(modes.len(), branches.len());
    let mut largest = 0_f64;
    for (mode, branch) in modes.iter().zip(&branches) {
        assert_eq!(mode["name"], branch["name"]);
        let points = list(&branch["points"]);
        assert_eq!(list(&mode["damping_ratio"]).len(), points.len());
        for (i, point) in points.iter().enumerate() {
            for key in ["speed_m_s", "frequency_hz", "damping_ratio"] {
                largest = largest.max((number(&mode[key][i]) - number(&point[key])).abs());
            }
        }
    }
    (relative.into_iter().fold(0.0, f64::max), largest)
}

/// Times that a browser opens a page whose module it may not have compiled.
const ATTEMPTS: usize = 10;

/// Where there is a Chromium, the page shows its sliders and the onset that they start from.
fn in_a_browser(page: &Path) {
    // the time that the browser is given is a virtual one, in which the compilation of the module does not count: on a busy
    // machine it may not have ended
    let mut dom = String::new();
    for _ in 0..ATTEMPTS {
        let Some(found) = browser::document(page, "1280,1000") else {
            return;
        };
        dom = found;
        if dom.contains("against this report)") {
            break;
        }
    }
    assert_eq!(dom.matches("<canvas").count(), 4, "charts");
    assert_eq!(dom.matches("type=\"range\"").count(), 7, "sliders");
    // each is named for those who do not see it, and by its label
    for (id, name) in [
        ("vertical-mass_kg_m", "mass m"),
        ("wind-speed", "highest wind speed"),
    ] {
        assert!(dom.contains(&format!("for=\"live-{id}\"")), "{id}");
        assert!(dom.contains(&format!("aria-label=\"{name}\"")), "{name}");
    }
    assert!(dom.contains("Flutter onset 36.92 m/s (+0.0 % against this report)"));
}
