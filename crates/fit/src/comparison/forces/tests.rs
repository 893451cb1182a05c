//! The comparisons against closed forms and against each other.

use super::*;
use crate::section::Dof;
use std::f64::consts::TAU;

fn quick() -> CompareOptions {
    CompareOptions {
        decks: vec!["LN21-5200".into(), "LN21-6100".into()],
        scoring: Scoring {
            // two periods of the lowest frequency keep the warping short
            window_s: 8.0,
            ..Scoring::default()
        },
        ..CompareOptions::default()
    }
}

/// A force that is late by 3° and 10 % too large: closed forms of the metrics.
#[test]
fn metrics_of_a_harmonic_follow_the_closed_forms() {
    let (f, lag, gain) = (1.1, 3.0_f64, 1.1);
    let at = |k: usize, late: f64| (TAU * f * k as f64 / 200.0 - late.to_radians()).sin();
    let count = (200.0 * 8.0 / f) as usize;
    let measured: Vec<f64> = (0..count).map(|k| at(k, 0.0)).collect();
    let predicted: Vec<f64> = (0..count).map(|k| gain * at(k, lag)).collect();
    let m = Scoring::default()
        .metrics(&measured, &predicted, 200.0, f)
        .unwrap();
    // ends of the window that are not whole samples: a part in a thousand
    assert!((m.lag_deg - lag).abs() < 0.02, "{m:?}");
    assert!((m.phase - (-lag / 5.0).exp()).abs() < 5e-3);
    assert!((m.peak - (-0.1_f64).exp()).abs() < 1e-3 && (m.rms - m.peak).abs() < 1e-3);
    let distance = (1.0 + gain * gain - 2.0 * gain * lag.to_radians().cos()).sqrt();
    assert!((m.magnitude - (-distance).exp()).abs() < 2e-3);
    assert!((m.wavelet - (-0.1_f64).exp()).abs() < 2e-3, "{m:?}");
    assert!(m.magnitude_warped > m.magnitude && m.probability_density > 0.99);
    let same = Scoring::default()
        .metrics(&measured, &measured, 200.0, f)
        .unwrap();
    // the search of the lag ends within a millionth of a degree, 2e-7 of the metric
    assert!(
        same.values().iter().all(|v| (v - 1.0).abs() < 1e-6),
        "{same:?}"
    );
    assert!(!crate::comparison::PhaseParameters::default().whole_samples);
}

/// A score of forces that have no lag would mean nothing: they are refused in the words of the metric.
#[test]
fn forces_without_a_lag_have_no_score() {
    let at = |k: i32, late: f64| (0.5 + 0.004 * (f64::from(k) - late)).sin();
    let [measured, predicted] =
        [0.0, 40.0].map(|late| (0..200).map(|k| at(k, late)).collect::<Vec<_>>());
    let refused = Scoring::default()
        .metrics(&measured, &predicted, 200.0, 1.0)
        .unwrap_err();
    assert!(
        refused
            .to_string()
            .ends_with("still grows a sixteenth of the record away"),
        "{refused}"
    );
}

/// The lag and the amplitude in time are the phase and the magnitude in frequency: two paths to the same number.
#[test]
fn time_and_frequency_domain_agree() {
    let options = CompareOptions {
        decks: vec!["LN21-5200".into()],
        ..quick()
    };
    let results = compare_models(&options, &|_, _| ()).unwrap();
    assert_eq!(results.models.len(), 3);
    assert_eq!(results.entries.len(), 4);
    assert_eq!(results.scores.len(), 3 * 2 * 2 * 8);
    let coefficients: Vec<usize> = results.models.iter().map(|m| m.coefficients).collect();
    assert_eq!(coefficients, [3, 3, 6]);
    let mut checked = 0;
    for entry in &results.entries {
        for (model, points) in results.models.iter().zip(&entry.models) {
            let scores: Vec<_> = results
                .scores
                .iter()
                .filter(|s| (s.case.force, s.case.motion) == (entry.force, entry.motion))
                .filter(|s| s.case.model == model.name)
                .collect();
            for (point, (percent, degrees)) in entry.points.iter().zip(&points.points) {
                let near = |a: &&&Score, b: &&&Score| {
                    let d = |s: &Score| (s.frequency_hz - point.frequency_hz).abs();
                    d(a).total_cmp(&d(b))
                };
                let score = scores.iter().min_by(near).unwrap();
                if degrees.abs() < 30.0 {
                    // derivatives of one entry have each their own K, a per cent apart
                    assert!(
                        (score.metrics.lag_deg + degrees).abs() < 1.0,
                        "{entry:?} {score:?}"
                    );
                    let rms = (-(percent / 100.0).abs()).exp();
                    assert!(
                        (score.metrics.rms - rms).abs() < 0.03,
                        "{percent} {score:?}"
                    );
                    checked += 1;
                }
            }
        }
    }
    assert!(checked > 60, "{checked}");
    assert!(results.histories.len() == 8 && results.histories[0].predicted.len() == 3);
    // the feed-through model fits best: the thesis's future work
    let worst = |m: usize| {
        let all = results.entries.iter().flat_map(|e| &e.models[m].points);
        all.map(|p| p.1.abs()).fold(0.0, f64::max)
    };
    assert!(worst(2) < worst(0));
    assert_eq!(results.derivatives.len(), 8);
    assert!(results.statements.iter().all(|s| !s.here.is_empty()));
}

#[test]
fn decks_are_compared_at_both_speeds() {
    let results = compare_decks(&quick(), &|_, _| ()).unwrap();
    assert_eq!(results.scores.len(), 2 * 2 * 2 * 2 * 8);
    let held_out = results.scores.iter().filter(|s| s.case.held_out).count();
    assert_eq!(2 * held_out, results.scores.len());
    assert_eq!(results.summaries.len(), 16);
    for s in &results.scores {
        assert!(
            s.metrics.values().iter().all(|v| (0.0..=1.0).contains(v)),
            "{s:?}"
        );
    }
    let trained: Vec<f64> = results.decks.iter().map(|d| d.trained_on.1).collect();
    assert!((trained[0] - 8.18).abs() < 0.01 && (trained[1] - 8.39).abs() < 0.01);
    // under rotation, trained and asked at the same speed, the warped magnitude is good on every girder
    for s in &results.summaries {
        if s.case.motion == Dof::Torsion && !s.case.held_out {
            assert!(s.mean[4] > 0.9, "{s:?}");
        }
    }
    let table = score_table(&results.scores);
    assert_eq!(table.lines().count(), 1 + results.scores.len());
    assert!(table.starts_with("deck,model,speed_m_s,held_out,motion,force,frequency_hz,M_phi"));
    // the model of another deck is worse than a deck's own
    let borrowed = CompareOptions {
        trained_on: Some("LN21-5200".into()),
        ..quick()
    };
    let other = compare_decks(&borrowed, &|_, _| ()).unwrap();
    let mean = |r: &DecksComparison| {
        let own = r.summaries.iter().filter(|s| s.case.deck == "LN21-6100");
        own.map(|s| s.mean[3]).sum::<f64>()
    };
    assert!(mean(&other) < mean(&results));
    // a spread takes two decks: of the teacher alone the forces of the others are predicted
    let said = |r: &DecksComparison| {
        r.statements
            .iter()
            .map(|s| s.here.clone())
            .collect::<String>()
    };
    assert!(!said(&results).contains("not trained on"));
    assert!(said(&other).contains("not trained on") && !said(&other).contains("0.00 in lift"));
    let one = CompareOptions {
        decks: vec!["LN21-6100".into()],
        ..quick()
    };
    assert!(
        compare_decks(&one, &|_, _| ())
            .unwrap()
            .statements
            .is_empty()
    );
    let last = other
        .summaries
        .iter()
        .filter(|s| s.case.deck == "LN21-6100");
    assert!(last.clone().count() > 0 && last.into_iter().all(|s| s.case.held_out));
}

#[test]
fn impossible_comparisons_are_refused() {
    let message =
        |options: &CompareOptions| compare_decks(options, &|_, _| ()).unwrap_err().to_string();
    let mut options = quick();
    options.decks[1] = "LN99".into();
    assert!(message(&options).contains("LN20-5500"));
    options.decks.clear();
    assert!(message(&options).contains("at least one"));
    let short = CompareOptions {
        scoring: Scoring {
            window_s: 0.1,
            ..Scoring::default()
        },
        ..quick()
    };
    assert!(message(&short).contains("at least one period"));
    assert!(
        compare_models(&quick(), &|_, _| ())
            .unwrap_err()
            .to_string()
            .contains("one deck")
    );
}
