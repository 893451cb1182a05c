//! Intervals: they hold known truths as often as they say, and every printed onset has one or a reason.

#[path = "common/command.rs"]
#[allow(dead_code)] // each test file needs a part of it
mod command;

use aerodeck::uncertainty::{CoveragePlan, CoverageReport, Truth, coverage};
use aerodeck::wind_tunnel::TunnelPlan;
use command::{onset_of, succeeds};
use serde_json::Value;
use tempfile::TempDir;

const REPETITIONS: usize = 100;

fn repeated(truth: Truth, noise_correlation_s: f64, poles: &[f64]) -> CoverageReport {
    let plan = CoveragePlan {
        truth,
        poles: poles.to_vec(),
        repetitions: REPETITIONS,
        tunnel: TunnelPlan {
            noise_fraction: 0.05,
            noise_correlation_s,
            seed: 77_000,
            ..TunnelPlan::default()
        },
        ..CoveragePlan::default()
    };
    coverage(&plan, &|_| ()).unwrap()
}

/// The short form of `aerodeck coverage --repetitions 500`. If 95 % of the intervals hold the truth, fewer than 88 of 100
/// do so once in 400 times; stated and observed scatter agree to `1/√(2·100)` = 7 %, three times that are allowed.
#[test]
fn intervals_hold_a_truth_within_the_class() {
    for correlation_s in [0.0, 0.1] {
        let report = repeated(Truth::Jones, correlation_s, &[0.091, 0.6]);
        assert!(
            report.holds_truth.inside >= 88,
            "{correlation_s}: {report:?}"
        );
        let ratio = report.stated_standard_error_m_s / report.scatter_m_s;
        assert!((ratio - 1.0).abs() < 0.21, "{correlation_s}: {ratio}");
        // no bias: the class holds the truth, and the fit without noise is exact up to the images above Nyquist
        assert!(report.bias_m_s.abs() < 1e-3, "{}", report.bias_m_s);
        assert!(report.mean_error_m_s.abs() < 4.0 * report.standard_error_of_mean_m_s);
        assert!(report.derivatives_hold_truth.percent > 92.0);
    }
}

/// One pole cannot follow Theodorsen's function: the bias is many times the scatter, and is told apart from it.
#[test]
fn bias_is_told_from_scatter_outside_the_class() {
    let report = repeated(Truth::Theodorsen, 0.0, &[0.091, 0.6]);
    assert!(report.bias_m_s.abs() > 10.0 * report.scatter_m_s);
    // noise moves the mean error from the bias by its own error, and by its square: a tenth of the scatter at most
    let difference = (report.mean_error_m_s - report.bias_m_s).abs();
    assert!(difference < 0.3 * report.scatter_m_s, "{report:?}");
}

/// Training, and flutter from the saved files alone, state the same intervals; the table has none, with the reason.
#[test]
fn every_onset_has_an_interval_or_a_reason() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    std::fs::write(at.join("study.toml"), aerodeck::study::demo_study_text()).unwrap();
    succeeds(at, &["tunnel", "study.toml"]);
    let trained = succeeds(at, &["train", "study.toml"]);
    assert!(trained.contains("95 % interval"), "{trained}");
    let text = succeeds(at, &["flutter", "study.toml"]);
    assert!(
        text.contains("no interval: interpolated table (determinant)"),
        "{text}"
    );
    let json: Value =
        serde_json::from_str(&succeeds(at, &["flutter", "study.toml", "--json"])).unwrap();
    let saved: Value = serde_json::from_str(
        &std::fs::read_to_string(at.join("fits/laguerre.uncertainty.json")).unwrap(),
    )
    .unwrap();
    for name in ["Laguerre", "rational functions", "thesis"] {
        let onset = onset_of(&json["flutter"], name, "eigenvalues");
        let interval = &onset["interval"];
        assert_eq!(interval["kind"], "known", "{name}");
        let number = |key: &str| interval[key].as_f64().unwrap();
        let speed = onset["speed_m_s"].as_f64().unwrap();
        assert!(number("low_m_s") < speed && speed < number("high_m_s"));
        if name == "Laguerre" {
            let error = saved["onset"]["standard_error_m_s"].as_f64().unwrap();
            // the same sensitivities of the same numbers, read back exactly
            assert!((number("standard_error_m_s") / error - 1.0).abs() < 1e-6);
        }
    }
    let own = onset_of(&json["flutter"], "interpolated table", "determinant");
    assert_eq!(own["interval"]["kind"], "none");
    // a covariance that belongs to other numbers is not used
    let file = at.join("models/laguerre.json");
    let model = std::fs::read_to_string(&file).unwrap();
    let mut value: Value = serde_json::from_str(&model).unwrap();
    let entry = &mut value["model"]["e0"][0][0];
    *entry = Value::from(entry.as_f64().unwrap() + 0.05);
    std::fs::write(&file, value.to_string()).unwrap();
    let text = succeeds(at, &["flutter", "study.toml"]);
    assert!(text.contains("belongs to another training"), "{text}");
}
