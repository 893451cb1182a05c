mod constrained;
mod form;

use super::*;
use crate::aerodynamics::{FlatPlate, RationalModel, Realizable, Transfer};
use crate::aeroelastic::CoupledSection;
use crate::identification::form::FeedThrough;
use crate::identification::form::PoleSearch;
use crate::identification::sample_model;
use crate::identification::testing::{eight_k, onset_m_s, table_alone};
use crate::section::SectionModel;
use crate::trained_model::Model;
use crate::units::ReducedFrequency;

fn flat_plate() -> Vec<TransferSample> {
    sample_model(&FlatPlate::default(), &eight_k(8.17)).unwrap()
}

fn rational(lags: usize, added_mass: bool) -> FrequencyFit {
    FrequencyFit {
        form: Form::Rational { lags, added_mass },
        ..table_alone()
    }
}

fn lags(model: &Model) -> Vec<f64> {
    match model {
        Model::Rational(m) => m.lags.of_force(0).to_vec(),
        _ => panic!("not rational"),
    }
}

/// Reference figures of the flat plate at the eight K of 8.17 m/s, computed with SciPy: last printed digit.
#[test]
fn flat_plate_reference_onsets() {
    let samples = flat_plate();
    let Fitted { model, report } = fit_table(&samples, &Dof::TWO, &table_alone()).unwrap();
    // scipy.optimize.minimize_scalar on numpy.linalg.lstsq: 0.298892, weighted residual 0.00183478·√64
    assert!((report.search[0].chosen.poles[0] - 0.298_892).abs() < 1e-5);
    assert!((report.search[0].chosen.objective - 0.001_834_78 * 2f64.sqrt()).abs() < 1e-7);
    assert!((onset_m_s(&model) / 39.468 - 1.0).abs() < 1e-3);
    let given = FrequencyFit {
        poles: PoleSearch::fixed(&[0.305]),
        ..table_alone()
    };
    let model = fit_table(&samples, &Dof::TWO, &given).unwrap().model;
    assert!((onset_m_s(&model) - 39.473).abs() < 1e-3);
    let model = fit_table(&samples, &Dof::TWO, &rational(1, false))
        .unwrap()
        .model;
    assert!((lags(&model)[0] - 0.289).abs() < 1e-3);
    assert!((onset_m_s(&model) - 39.40).abs() < 0.01);
    let model = fit_table(&samples, &Dof::TWO, &rational(2, true))
        .unwrap()
        .model;
    assert!((lags(&model)[0] - 0.149).abs() < 1e-3 && (lags(&model)[1] - 0.538).abs() < 1e-3);
    assert!((onset_m_s(&model) - 39.456).abs() < 2e-3);
}

fn assert_same(a: &Model, b: &Model) {
    for k in [0.02, 0.1, 0.4, 1.0, 3.0] {
        let k = ReducedFrequency::from_full_width(k);
        let (x, y) = (a.transfer(k).unwrap(), b.transfer(k).unwrap());
        for (x, y) in x.iter().zip(&y) {
            assert!((x - y).norm() < 1e-9 * x.norm(), "{x} {y}");
        }
    }
    let structure = SectionModel::table_4_1().structure().unwrap();
    let values = |m: &Model| {
        let section = CoupledSection::new(structure.clone(), m.realize()).unwrap();
        section.at(35.0).unwrap().eigenvalues().unwrap()
    };
    let others = values(b);
    for z in values(a) {
        let nearest = others
            .iter()
            .map(|w| (w - z).norm())
            .fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-9 * z.norm(), "{z}: {nearest}");
    }
    assert!((onset_m_s(a) / onset_m_s(b) - 1.0).abs() < 1e-9);
}

/// One Laguerre filter with e₀, e₁, e₂ is the one-lag Roger form with added mass, the searched pole included.
#[test]
fn one_laguerre_filter_is_one_lag() {
    let fit = FrequencyFit {
        form: Form::laguerre(1),
        ..table_alone()
    };
    let a = fit_table(&flat_plate(), &Dof::TWO, &fit).unwrap().model;
    let b = fit_table(&flat_plate(), &Dof::TWO, &rational(1, true))
        .unwrap()
        .model;
    assert_same(&a, &b);
}

/// Takenaka–Malmquist filters with the poles d_l are the n-lag Roger form, given or searched.
#[test]
fn takenaka_malmquist_filters_are_lags() {
    for (n, poles) in [
        (2, PoleSearch::default()),
        (2, PoleSearch::fixed(&[0.149, 0.538])),
        (3, PoleSearch::fixed(&[0.1, 0.3, 0.9])),
    ] {
        let form = Form::takenaka_malmquist(n);
        let with = |form: Form| FrequencyFit {
            form,
            poles: poles.clone(),
            ..table_alone()
        };
        let a = fit_table(&flat_plate(), &Dof::TWO, &with(form))
            .unwrap()
            .model;
        let roger = Form::Rational {
            lags: n,
            added_mass: true,
        };
        let b = fit_table(&flat_plate(), &Dof::TWO, &with(roger))
            .unwrap()
            .model;
        assert_same(&a, &b);
    }
}

/// Samples of a rational function give it back: coefficients, lags, no residual.
#[test]
fn rational_function_is_recovered_from_its_samples() {
    let jones = RationalModel::jones_flat_plate();
    let ks: Vec<_> = (1..=16)
        .map(|i| ReducedFrequency::from_full_width(0.1 * f64::from(i)))
        .collect();
    let samples = sample_model(&jones, &ks).unwrap();
    let Fitted { model, report } = fit_table(&samples, &Dof::TWO, &rational(2, true)).unwrap();
    let Model::Rational(found) = &model else {
        panic!("not rational");
    };
    for (d, expected) in found.lags.of_force(0).iter().zip(jones.lags.of_force(0)) {
        assert!((d / expected - 1.0).abs() < 1e-5, "{d}");
    }
    assert!((&found.a2 - &jones.a2).amax() < 1e-4);
    assert!((&found.a3 - &jones.a3).amax() < 1e-5);
    assert!((&found.lag_terms[1] - &jones.lag_terms[1]).amax() < 1e-4);
    for entry in &report.entries {
        assert!(entry.relative_rms.unwrap() < 1e-6 && entry.worst_relative.unwrap() < 1e-6);
    }
    assert_eq!(report.tested_range.max.full_width(), 1.6);
    // what one number lacks was not tested, and numbers that have no K in common cannot be judged together
    let without = |lacking: &dyn Fn(f64) -> bool| {
        let kept = |s: &&TransferSample| s.motion != Dof::Torsion || !lacking(s.k.full_width());
        let kept: Vec<TransferSample> = samples.iter().filter(kept).copied().collect();
        fit_table(&kept, &Dof::TWO, &rational(2, true)).map(|fit| fit.report.tested_range)
    };
    let range = without(&|k| k < 0.55).unwrap();
    assert_eq!(range.min.full_width(), ks[5].full_width());
    let apart = samples.iter().filter(|s| {
        let low = s.k.full_width() < 0.75;
        low == (s.motion == Dof::Torsion)
    });
    let apart: Vec<TransferSample> = apart.copied().collect();
    let message = fit_table(&apart, &Dof::TWO, &rational(2, true)).unwrap_err();
    assert!(
        message.to_string().contains("all forces were tested"),
        "{message}"
    );
}

/// With a pole for each transfer function every entry is fitted at least as well as with a common one.
#[test]
fn own_poles_fit_at_least_as_well() {
    let own = FrequencyFit {
        form: Form::Laguerre {
            filters: Some(2),
            feed_through: FeedThrough::default(),
            pole_per_transfer_function: true,
        },
        ..table_alone()
    };
    let shared = FrequencyFit {
        form: Form::laguerre(2),
        ..table_alone()
    };
    let Fitted { model, report: a } = fit_table(&flat_plate(), &Dof::TWO, &own).unwrap();
    let b = fit_table(&flat_plate(), &Dof::TWO, &shared).unwrap().report;
    assert_eq!(a.search.len(), 4);
    let objective = |r: &FitReport| -> f64 { r.search.iter().map(|s| s.chosen.objective).sum() };
    assert!(objective(&a) / 4.0 <= objective(&b) * 1.000_001);
    let Model::Laguerre(model) = model else {
        panic!("not Laguerre");
    };
    assert_eq!(model.terms.len(), 4);
    assert!((onset_m_s(&model) - 39.468).abs() < 0.1);
}

/// Standard errors against the scatter of fits to noisy samples.
#[test]
fn standard_errors_are_the_scatter_of_repeated_fits() {
    let fit = FrequencyFit {
        form: Form::laguerre(1),
        poles: PoleSearch::fixed(&[0.3]),
        weights: FrequencyWeights::None,
        ..table_alone()
    };
    let clean = flat_plate();
    let mut state = 1u64;
    let mut gauss = || {
        // sum of twelve uniform numbers: variance one
        let mut sum = -6.0;
        for _ in 0..12 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            sum += (state >> 11) as f64 / (1u64 << 53) as f64;
        }
        sum
    };
    let mut values = Vec::new();
    let mut claimed = 0.0;
    for _ in 0..400 {
        let mut noisy = clean.clone();
        noisy.iter_mut().for_each(|s| s.value += 0.2 * gauss());
        let report = fit_table(&noisy, &Dof::TWO, &fit).unwrap().report;
        let c = &report.entries[1].coefficients[3];
        assert_eq!(c.name, "c0");
        values.push(c.value);
        claimed += c.standard_error.unwrap().powi(2) / 400.0;
    }
    let mean = values.iter().sum::<f64>() / 400.0;
    let scatter = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 399.0;
    // a variance of 400 draws is known within 7 %: three of those
    assert!(
        (scatter / claimed - 1.0).abs() < 0.21,
        "{scatter} {claimed}"
    );
}

#[test]
fn overfits_and_bounds_are_said() {
    let two = FrequencyFit {
        poles: PoleSearch::fixed(&[0.3, 0.3003]),
        ..rational(2, true)
    };
    let report = fit_table(&flat_plate(), &Dof::TWO, &two).unwrap().report;
    assert!(
        report
            .notes
            .iter()
            .any(|n| n.contains("coefficients cancel")),
        "{:?}",
        report.notes
    );
    let bounded = FrequencyFit {
        poles: PoleSearch {
            min: Some(0.5),
            max: Some(2.0),
            ..PoleSearch::default()
        },
        ..rational(1, true)
    };
    let report = fit_table(&flat_plate(), &Dof::TWO, &bounded)
        .unwrap()
        .report;
    assert!(
        report.notes.iter().any(|n| n.contains("lower bound")),
        "{:?}",
        report.notes
    );
}

#[test]
fn impossible_options_are_refused_by_key() {
    let message = |fit: FrequencyFit| {
        fit_table(&flat_plate(), &Dof::TWO, &fit)
            .unwrap_err()
            .to_string()
    };
    let none = FrequencyFit {
        form: Form::laguerre(0),
        ..table_alone()
    };
    assert_eq!(
        message(none),
        "form.filters (or form.lags): expected at least 1, found 0"
    );
    let wrong_count = FrequencyFit {
        poles: PoleSearch::fixed(&[0.1]),
        ..rational(2, true)
    };
    assert!(message(wrong_count).starts_with("poles.fixed: expected 2 numbers"));
    let many = FrequencyFit {
        form: Form::laguerre(14),
        ..table_alone()
    };
    assert!(message(many).contains("at least 17 numbers for 17 coefficients"));
    let unknown = r#"{"form": {"kind": "laguerre", "order": 3}}"#;
    assert!(serde_json::from_str::<FrequencyFit>(unknown).is_err());
    let text = r#"{"form": {"kind": "rational", "lags": 2}, "poles": {"min": 0.05}, "weights": "derivatives"}"#;
    let fit: FrequencyFit = serde_json::from_str(text).unwrap();
    assert_eq!(fit.weights, FrequencyWeights::Derivatives);
}
