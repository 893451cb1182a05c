//! The two routes to the error of an onset against each other and against re-solved onsets.

mod between_speeds;
mod growth_limit;
mod own_filters;

use super::onset::{onset_error, onset_gradient, resample_onset, speed_and_omega};
use super::*;
use crate::aerodynamics::derivatives::TransferSample;
use crate::aerodynamics::{FlatPlate, RationalModel};
use crate::aeroelastic::CoupledSection;
use crate::files::derivatives::embedded;
use crate::flutter::{Onset, OnsetSearch, find_onset};
use crate::identification::{
    Constraints, DiscreteFit, FeedThrough, Fitted, Form, FrequencyFit, FrequencyWeights,
    PoleSearch, fit_discrete, fit_table, sample_model,
};
use crate::section::{Dof, SectionModel, Structure};
use crate::trained_model::Model;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::wind_tunnel::{RecordSource, TunnelPlan};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

fn structure() -> Structure {
    SectionModel::table_4_1().structure().unwrap()
}

fn onset(model: &Model) -> Onset {
    onset_within(model, None)
}

fn onset_within(model: &Model, tested: Option<ReducedFrequencyRange>) -> Onset {
    let section = CoupledSection::with_model(&structure(), model).unwrap();
    let search = OnsetSearch::default();
    let found = find_onset("", &section, &search, tested).unwrap();
    found.onset().unwrap().clone()
}

fn two_poles(poles: PoleSearch) -> FrequencyFit {
    FrequencyFit {
        form: Form::takenaka_malmquist(2),
        poles,
        weights: FrequencyWeights::Relative,
        ..FrequencyFit::default()
    }
}

/// The covariance of the blocks alone, for truths that do not differ between speeds.
fn by_blocks(mut estimate: CoefficientUncertainty) -> CoefficientUncertainty {
    let data = estimate.data.as_mut().unwrap();
    let contributions = data.contributions();
    estimate.covariance = &contributions * contributions.transpose();
    data.effects.clear();
    estimate
}

fn fitted(samples: &[TransferSample], fit: &FrequencyFit) -> (Model, CoefficientUncertainty) {
    let Fitted { model, report } = fit_table(samples, &Dof::TWO, fit).unwrap();
    let estimate = table_uncertainty(samples, &Dof::TWO, fit, &report, None).unwrap();
    (model, estimate)
}

/// Samples of Jones's function at two speeds with relative errors of one per cent.
fn scattered(seed: u64) -> Vec<TransferSample> {
    let ks: Vec<_> = [8.17, 4.0]
        .iter()
        .flat_map(|v| {
            TunnelPlan::default()
                .frequencies_hz
                .into_iter()
                .map(move |f| ReducedFrequency::from_hertz(f, 0.5, *v))
        })
        .collect();
    let mut samples = sample_model(&RationalModel::jones_flat_plate(), &ks).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let sizes: Vec<f64> = samples
        .chunks(2)
        .flat_map(|pair| [pair[0].value.hypot(pair[1].value); 2])
        .collect();
    for (i, (sample, size)) in samples.iter_mut().zip(sizes).enumerate() {
        let normal: f64 = StandardNormal.sample(&mut random);
        sample.value += 0.01 * size * normal;
        // eight samples per test point, eight points per speed
        sample.mean_speed_m_s = Some(if i < 64 { 8.17 } else { 4.0 });
    }
    samples
}

/// Every entry of the gradient against the difference of onsets searched anew.
#[test]
fn gradients_are_differences_of_onsets() {
    let table = embedded::deck("LN21-5200").unwrap();
    let continuous = fitted(&table.samples(&Dof::TWO), &FrequencyFit::default());
    let plan = TunnelPlan {
        speeds_m_s: vec![8.17],
        noise_fraction: 0.02,
        ..TunnelPlan::default()
    };
    let records = plan
        .records_from_model(&FlatPlate::default(), "plate", 0.5)
        .unwrap();
    let sources: Vec<&dyn RecordSource> = records.iter().map(|r| r as _).collect();
    let fit = DiscreteFit::default();
    let model = fit_discrete(&sources, &fit, &|_, _| ()).unwrap().model;
    let discrete = discrete_uncertainty(&sources, &fit, &model, None, &|_, _| ()).unwrap();
    for (model, estimate) in [continuous, (model, discrete)] {
        let at = onset(&model);
        let gradient = onset_gradient(&estimate, &structure(), speed_and_omega(&at)).unwrap();
        let values = estimate.values();
        let largest = gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
        for (p, g) in gradient.iter().enumerate() {
            let h = 1e-4 * values[p].abs().max(0.01);
            let moved = |by: f64| {
                let mut moved = values.clone();
                moved[p] += by;
                onset(&estimate.model_at(&moved).unwrap()).at.speed_m_s
            };
            let difference = (moved(h) - moved(-h)) / (2.0 * h);
            // truncation: h² of the third derivative; onsets are exact to 1e-12 or so
            assert!(
                (g - difference).abs() < 1e-4 * largest + 1e-3 * difference.abs(),
                "{}: {g} {difference}",
                estimate.parameters[p].name
            );
        }
    }
}

/// Repeated scattered tables: stated standard errors of onset and poles are the scatter of the estimates, poles known, poles searched and a
/// transfer function that has its own. 120 repetitions tell a standard deviation to 6.5 %; three times that, and 5 % for the curvature of
/// the poles, are allowed.
#[test]
fn stated_errors_are_the_scatter_of_repeated_tables() {
    let searched = PoleSearch {
        start: Some(vec![0.091, 0.6]),
        ..PoleSearch::default()
    };
    for fit in [
        two_poles(PoleSearch::fixed(&[0.091, 0.6])),
        two_poles(searched.clone()),
        FrequencyFit {
            own: vec![own_filters::own(Dof::Torsion, Dof::Torsion, 2, None)],
            ..two_poles(searched)
        },
    ] {
        let (mut speeds, mut stated) = (Vec::new(), 0.0);
        let runs = 120;
        for seed in 0..runs {
            let (model, estimate) = fitted(&scattered(seed), &fit);
            let found = onset(&model);
            let estimate = by_blocks(estimate);
            let error =
                onset_error(&estimate, &structure(), speed_and_omega(&found), None).unwrap();
            speeds.push(found.at.speed_m_s);
            stated += error.standard_error_m_s.powi(2) / runs as f64;
        }
        let mean = speeds.iter().sum::<f64>() / runs as f64;
        let variance: f64 =
            speeds.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (runs as f64 - 1.0);
        let ratio = (stated / variance).sqrt();
        assert!((ratio - 1.0).abs() < 0.25, "{:?}: {ratio}", fit.poles.fixed);
    }
}

/// Sensitivities, drawn coefficients and the block bootstrap: three standard errors of one onset.
#[test]
fn three_routes_give_one_standard_error() {
    let (model, estimate) = fitted(&scattered(3), &two_poles(PoleSearch::fixed(&[0.091, 0.6])));
    let at = onset(&model);
    let error = onset_error(&estimate, &structure(), speed_and_omega(&at), None).unwrap();
    let draw = |resampling, replicates| {
        let search = OnsetSearch::default();
        let drawn = resample_onset(
            &estimate,
            &structure(),
            &at,
            resampling,
            replicates,
            &search,
            None,
        );
        drawn.unwrap()
    };
    let resampled = |resampling| {
        let once = draw(resampling, 600).unwrap();
        assert_eq!(once.without_onset, 0);
        assert_eq!(Some(once.clone()), draw(resampling, 600));
        once.standard_deviation_m_s / error.standard_error_m_s
    };
    // of no onset at all there are no numbers
    assert_eq!(draw(Resampling::Normal, 0), None);
    // 600 draws tell a standard deviation to 3 %
    let drawn = resampled(Resampling::Normal);
    assert!((drawn - 1.0).abs() < 0.12, "{drawn}");
    // the bootstrap has no correction for few blocks: residuals are smaller than errors by about √(1 − 5/16)
    let blocks = resampled(Resampling::Blocks);
    assert!((0.65..1.15).contains(&blocks), "{blocks}");
}

/// What is saved says the same as what was computed.
#[test]
fn saved_uncertainty_gives_the_same_interval() {
    let (model, estimate) = fitted(&scattered(3), &two_poles(PoleSearch::fixed(&[0.091, 0.6])));
    let at = onset(&model);
    let tested = ReducedFrequencyRange::between(
        ReducedFrequency::from_full_width(0.1),
        ReducedFrequency::from_full_width(1.9),
    );
    let all = ModelUncertainty::new(
        estimate,
        &structure(),
        Some(&at),
        OnsetSearch::default(),
        tested,
    )
    .unwrap();
    let again = ModelUncertainty::from_json(&all.to_json().unwrap()).unwrap();
    assert_eq!(again.derivatives, all.derivatives);
    assert_eq!(
        again.interval(&model, &structure(), &at).unwrap(),
        all.interval(&model, &structure(), &at).unwrap()
    );
    assert!(
        ModelUncertainty::from_json("{}")
            .unwrap_err()
            .to_string()
            .contains("line 1")
    );
}

/// What a file says of its parameters must make a model: else it is refused by name, whatever it says.
#[test]
fn uncertainties_that_make_no_model_are_refused() {
    let samples = scattered(3);
    let (_, estimate) = fitted(&samples, &two_poles(PoleSearch::default()));
    let tested = ReducedFrequencyRange::spanning(samples.iter().map(|s| s.k)).unwrap();
    let forms = FormEnsemble::new(&samples, &Dof::TWO, &|_| None).unwrap();
    let whole = ModelUncertainty::of_data(estimate, Some(forms), tested).unwrap();
    let whole = whole.to_json().unwrap();
    assert!(ModelUncertainty::from_json(&whole).is_ok());
    let refused = |place: &str, value: serde_json::Value| {
        let mut file: serde_json::Value = serde_json::from_str(&whole).unwrap();
        *file.pointer_mut(place).expect(place) = value;
        let read = ModelUncertainty::from_json(&file.to_string());
        read.expect_err(place).to_string()
    };
    let own = |key: &str| format!("/coefficients/{key}");
    for (place, value, expected) in [
        (own("dofs"), "[]", "dofs: expected at least one, found none"),
        (own("parameters"), "[]", "parameters: expected 22, found 0"),
        (
            own("covariance"),
            "[]",
            "covariance: expected 22×22 numbers, found 0×0",
        ),
        (
            own("coordinates/chains/1"),
            "[]",
            "coordinates.chains: expected poles of 2×2 transfer functions",
        ),
        (
            own("coordinates/searched/1/index"),
            "9",
            "coordinates.searched: expected the place of a pole",
        ),
        (
            own("coordinates/chains/0/1"),
            "[0.1, 0.2, 0.3]",
            "parameters: expected 23, found 22",
        ),
        (
            own("coordinates"),
            r#"{ "kind": "discrete", "alpha": 0.5, "delta_s": 0.1, "filters": 18446744073709551615 }"#,
            "coordinates.filters: expected at most 100",
        ),
        (
            "/forms/fits/0/model/e0".to_owned(),
            "[]",
            "finite 2x2 matrix",
        ),
        (
            "/forms/read/0/entries/0/0/y".to_owned(),
            "[]",
            "2×2 pairs of curves",
        ),
    ] {
        let message = refused(&place, serde_json::from_str(value).unwrap());
        assert!(message.contains(expected), "{message}");
    }
}
