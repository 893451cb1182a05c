//! From a raw campaign on disk to an onset, by the command line alone; what is wrong in it is said.

use crate::command::{self, flowing, refused, succeeds};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// Table 4.1 with the width of the deck that was tested.
const SECTION: &str = "[section]\nwidth_m = 0.5022857142857143\nair_density_kg_m3 = 1.19\n\
    vertical = { mass_kg_m = 15.0, frequency_hz = 2.0, damping_ratio = 0.003 }\n\
    torsion = { inertia_kg_m2_m = 0.6, frequency_hz = 5.0, damping_ratio = 0.003 }\n";

fn json(path: impl AsRef<std::path::Path>) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn a_campaign_becomes_records_derivatives_and_an_onset() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(
        at,
        &[
            "campaign",
            "virtual",
            "LN21-5200",
            "--seed",
            "4",
            "--out",
            "raw",
        ],
    );
    fs::write(at.join("section.toml"), SECTION).unwrap();
    let with_section = [
        "process",
        "raw/campaign.toml",
        "--out",
        "results",
        "--section",
        "section.toml",
    ];
    let text = flowing(&succeeds(at, &with_section));
    for word in [
        "lag of the force channels",
        "replaced: spike",
        "8 derivatives, 128 numbers in all",
    ] {
        assert!(text.contains(word), "`{word}` is not in:\n{text}");
    }
    let out = at.join("results");
    // `study results/study.toml` writes its page into the same folder
    assert!(out.join("processing.html").exists() && !out.join("report.html").exists());
    let report = json(out.join("processing.json"));
    // 1.7 ms is what the virtual campaign applies
    assert!((report["lag_s"].as_f64().unwrap() - 1.7e-3).abs() < 5e-5);
    let runs = report["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 4);
    for run in runs {
        let name = run["run"].as_str().unwrap();
        for file in [
            format!("records/{name}.csv"),
            format!("processing/{name}.svg"),
        ] {
            assert!(out.join(&file).is_file(), "{file}");
        }
        assert_eq!(run["segments"].as_array().unwrap().len(), 8);
    }
    let derivatives = json(out.join("derivatives.json"));
    let estimates = derivatives["estimates"].as_array().unwrap();
    assert_eq!(estimates.len(), 8 * 16);
    assert!(
        estimates
            .iter()
            .all(|e| e["standard_error"].as_f64().unwrap() > 0.0)
    );
    // the workbook is one that the program reads, and the study gives an onset
    let table = aerodeck::files::derivatives::named_table("derivatives.csv", &out).unwrap();
    let options = aerodeck::files::derivatives::ReadOptions {
        width_m: Some(table.width_m),
        ..Default::default()
    };
    let (book, _) = aerodeck::files::derivatives::read_table_with(
        out.join("AerodynamicDerivatives_LN21-5200.xlsx"),
        &options,
    )
    .unwrap();
    assert!(book.derivatives().eq(table.derivatives()));
    succeeds(at, &["study", "results/study.toml"]);
    let summary = json(out.join("summary.json"));
    let laguerre = command::onset_of(&summary, "Laguerre", "eigenvalues");
    // clean records give 37.01 m/s with the width of the model and the air of the runs
    let speed = laguerre["speed_m_s"].as_f64().unwrap();
    assert!((speed - 37.01).abs() < 0.6, "{speed}");
}

#[test]
fn wrong_options_and_campaigns_are_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(
        at,
        &[
            "campaign",
            "virtual",
            "LN21-5200",
            "--clean",
            "--out",
            "raw",
        ],
    );
    let process = |more: &[&str], fragments: &[&str]| {
        let mut args = vec!["process", "raw/campaign.toml", "--out", "results"];
        args.extend(more);
        refused(at, &args, fragments);
    };
    process(
        &["--cutoff-hz", "150"],
        &["run ", "below the Nyquist frequency, 100 Hz at 200 Hz"],
    );
    fs::write(at.join("options.toml"), "drift_degree = 99\n").unwrap();
    process(&["--options", "options.toml"], &["processing.drift_degree"]);
    fs::write(at.join("options.toml"), "[low_pas]\norder = 2\n").unwrap();
    process(&["--options", "options.toml"], &["options.toml", "low_pas"]);
}

/// The worked example of docs/campaigns.md, by its own commands: one motion, forces of a computation.
#[test]
fn one_motion_of_a_computation_gives_its_column() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let repository = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let docs = fs::read_to_string(repository.join("docs/campaigns.md")).unwrap();
    let example = "docs/examples/cfd_heave";
    fs::create_dir_all(at.join(example)).unwrap();
    for file in ["campaign.toml", "slow.csv", "fast.csv"] {
        fs::copy(
            repository.join(example).join(file),
            at.join(example).join(file),
        )
        .unwrap();
    }
    let file = fs::read_to_string(at.join(example).join("campaign.toml")).unwrap();
    assert!(docs.contains(&file), "the page shows another file");
    for command in [
        "campaign check docs/examples/cfd_heave/campaign.toml",
        "process docs/examples/cfd_heave/campaign.toml --out heave",
    ] {
        assert!(docs.contains(&format!("aerodeck {command}")), "{command}");
        succeeds(at, &command.split(' ').collect::<Vec<_>>());
    }
    let text = fs::read_to_string(at.join("heave/derivatives.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text
        .lines()
        .filter(|l| !l.starts_with('#'))
        .skip(1)
        .map(|l| l.split(',').collect())
        .collect();
    // Theodorsen's function at K = 0.48695 and 0.24347, by scipy
    let expected = [
        ("H1", [-8.989068008256838, -20.75440897672161]),
        ("H4", [-0.8276226410544263, -3.089705853545111]),
        ("A1", [-2.247267002064209, -5.188602244180402]),
        ("A4", [-0.5996047419623306, -1.1651255450850015]),
    ];
    assert_eq!(rows.len(), 8, "{text}");
    for (name, values) in expected {
        let number = |text: &str| text.parse::<f64>().unwrap();
        let mut found: Vec<(f64, f64)> = rows
            .iter()
            .filter(|r| r[0] == name)
            .map(|r| (number(r[3]), number(r[4])))
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        for ((_, found), expected) in found.iter().zip(values) {
            // the low-pass at both ends of a series that begins in full motion
            assert!(
                (found / expected - 1.0).abs() < 4e-3,
                "{name}: {found} {expected}"
            );
        }
    }
}

/// A record that ends before its first period: an error, not zero test points and exit code 0.
#[test]
fn a_record_shorter_than_a_period_is_an_error() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let example = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/examples/cfd_heave");
    fs::copy(example.join("campaign.toml"), at.join("campaign.toml")).unwrap();
    fs::copy(example.join("fast.csv"), at.join("fast.csv")).unwrap();
    let slow = fs::read_to_string(example.join("slow.csv")).unwrap();
    // 30 of 40 samples of a period
    let cut: Vec<&str> = slow.lines().take(31).collect();
    fs::write(at.join("slow.csv"), cut.join("\n")).unwrap();
    refused(
        at,
        &["process", "campaign.toml", "--out", "results"],
        &[
            "slow.csv: run `slow`, in wind",
            "at least 64 samples",
            "found 30",
        ],
    );
}

/// Noise has no test points: its records are all that is asked for.
#[test]
fn broadband_runs_become_records() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let plan =
        "[tunnel]\nspeeds_m_s = [8.0]\nmotion = { kind = \"white_noise\", duration_s = 30.0 }\n";
    fs::write(at.join("plan.toml"), plan).unwrap();
    let made = "campaign virtual jones --width 0.5 --plan plan.toml --out raw";
    succeeds(at, &made.split(' ').collect::<Vec<_>>());
    let said = succeeds(at, &["process", "raw/campaign.toml", "--out", "r"]);
    assert!(flowing(&said).contains("no derivatives: records"), "{said}");
    assert_eq!(at.join("r/records").read_dir().unwrap().count(), 2);
}

/// The second run of the command has one motion, the third no test point: what the first wrote beyond that is gone.
#[test]
fn results_of_an_earlier_run_go() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(
        at.join("plan.toml"),
        "[tunnel]\nfrequencies_hz = [0.5, 1.0]\nspeeds_m_s = [8.0]\nstill_s = 2.0\nsegment_s = 14.0\nramp_s = 2.0\n",
    )
    .unwrap();
    let made = [
        "campaign",
        "virtual",
        "LN21-5200",
        "--clean",
        "--plan",
        "plan.toml",
        "--out",
        "raw",
    ];
    succeeds(at, &made);
    let process = ["process", "raw/campaign.toml", "--out", "results"];
    succeeds(at, &process);
    let out = at.join("results");
    let old = out.join("records").read_dir().unwrap().count();
    let file = fs::read_to_string(at.join("raw/campaign.toml")).unwrap();
    let first = file.match_indices("[[run]]").nth(1).unwrap().0;
    fs::write(at.join("raw/campaign.toml"), &file[..first]).unwrap();
    let said = succeeds(at, &process);
    assert!(
        flowing(&said).contains("study.toml of an earlier run is left"),
        "{said}"
    );
    assert_eq!(
        (old, out.join("records").read_dir().unwrap().count()),
        (4, 1)
    );
    assert!(!out.join("AerodynamicDerivatives_LN21-5200.xlsx").exists());
    assert!(out.join("derivatives.csv").exists());
    fs::write(
        at.join("options.toml"),
        "[segments]\nfrequencies_hz = [3.0]\n",
    )
    .unwrap();
    let options = ["--options", "options.toml", "--force"];
    let (code, said, _) = command::aerodeck(at, &[&process[..], &options].concat());
    assert_eq!(code, 1, "{said}");
    assert!(
        flowing(&said).contains("no run moves at the stated 3 Hz"),
        "{said}"
    );
    for gone in ["derivatives.csv", "derivatives.json", "study.toml"] {
        assert!(!out.join(gone).exists(), "{gone}");
    }
}

/// Three speeds of which neighbours lie within 5 %: sorted, tabled, and no panic.
#[test]
fn three_speeds_close_together_are_processed() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(
        at.join("plan.toml"),
        "[tunnel]\nfrequencies_hz = [0.5, 1.0, 1.5, 2.0]\nspeeds_m_s = [8.0, 8.3, 8.62]\nstill_s = 2.0\nsegment_s = 14.0\nramp_s = 2.0\n",
    )
    .unwrap();
    succeeds(
        at,
        &[
            "campaign",
            "virtual",
            "jones",
            "--plan",
            "plan.toml",
            "--out",
            "raw",
        ],
    );
    succeeds(at, &["process", "raw/campaign.toml", "--out", "results"]);
    let estimates = json(at.join("results/derivatives.json"));
    assert_eq!(estimates["estimates"].as_array().unwrap().len(), 8 * 12);
    assert!(at.join("results/derivatives.csv").is_file());
}

/// The model of one speed is fitted at the first at which every motion was tested, and there is none where there is no such speed.
#[test]
fn a_speed_that_lacks_a_motion_is_not_that_of_a_model() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let plan = "[tunnel]\nfrequencies_hz = [0.5, 1.0]\nspeeds_m_s = [6.0, 8.0]\nstill_s = 2.0\nsegment_s = 14.0\nramp_s = 2.0\n";
    fs::write(at.join("plan.toml"), plan).unwrap();
    let made = "campaign virtual jones --plan plan.toml --out raw";
    succeeds(at, &made.split(' ').collect::<Vec<_>>());
    let file = at.join("raw/campaign.toml");
    for (lost, groups) in [
        ("Jones-torsion-6", Some("speed_groups = [2]")),
        ("Jones-vertical-8", None),
    ] {
        let text = fs::read_to_string(&file).unwrap();
        let runs: Vec<&str> = text.split("[[run]]").collect();
        let kept: Vec<&str> = runs
            .iter()
            .copied()
            .filter(|run| !run.contains(lost))
            .collect();
        assert_eq!(kept.len(), runs.len() - 1, "{text}");
        fs::write(&file, kept.join("[[run]]")).unwrap();
        succeeds(
            at,
            &[
                "process",
                "raw/campaign.toml",
                "--out",
                "r",
                "--no-figures",
                "--force",
            ],
        );
        let study = fs::read_to_string(at.join("r/study.toml")).unwrap();
        match groups {
            Some(groups) => assert!(study.contains(groups), "{study}"),
            None => assert!(
                !study.contains("speed_groups") && study.contains("Laguerre"),
                "{study}"
            ),
        }
    }
}

/// What recordings say against the campaign file leaves nothing to be judged, by the table and by the workbook.
#[test]
fn a_contradiction_of_the_measurements_reaches_the_verdict() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let campaign = ["campaign", "virtual", "LN21-5200", "--clean"];
    succeeds(at, &[&campaign[..], &["--out", "raw"]].concat());
    let file = at.join("raw/campaign.toml");
    let right = fs::read_to_string(&file).unwrap();
    let wrong = right.replace("mean_speed_m_s = 8.18", "mean_speed_m_s = 8.98");
    fs::write(&file, wrong).unwrap();
    fs::write(at.join("section.toml"), SECTION).unwrap();
    let process = ["process", "raw/campaign.toml", "--out", "results"];
    let section = ["--section", "section.toml", "--no-figures"];
    let text = flowing(&succeeds(at, &[&process[..], &section].concat()));
    let doubt =
        "run `LN21-5200-vertical-8.18`: the mean speed is 8.983 m/s, its channel says 8.183 m/s";
    assert!(text.contains(&format!("doubt: {doubt}")), "{text}");
    let out = at.join("results");
    let table = aerodeck::files::derivatives::named_table("derivatives.csv", &out).unwrap();
    let book = "AerodynamicDerivatives_LN21-5200.xlsx";
    let book = aerodeck::files::derivatives::named_table(book, &out).unwrap();
    assert_eq!(
        (table.header.doubts.len(), &table.header.doubts),
        (2, &book.header.doubts)
    );
    let set = ["--set", "flutter.required_speed_m_s=20.0"];
    let study = ["study", "results/study.toml", "--no-figures"];
    let (code, said, error) = command::aerodeck(at, &[&study[..], &set].concat());
    let said = flowing(&said);
    assert_eq!(code, 3, "{said}{error}");
    assert!(
        said.contains("? CANNOT BE JUDGED, required 20 m/s"),
        "{said}"
    );
    assert!(
        said.contains(&format!(
            "Cannot be judged: measurements of LN21-5200: {doubt}"
        )),
        "{said}"
    );
}
