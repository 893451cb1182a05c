//! The two routes to the error of an onset against each other and against re-solved onsets.

use super::onset::{ResamplingPlan, onset_error, onset_gradient, resample_onset};
use super::speed_onsets::speed_onsets;
use super::*;
use crate::aerodynamics::derivatives::TransferSample;
use crate::aerodynamics::{FlatPlate, RationalModel};
use crate::aeroelastic::CoupledSection;
use crate::files::derivatives::embedded;
use crate::flutter::{Onset, OnsetSearch, find_onset};
use crate::identification::{
    DiscreteFit, FeedThrough, Fitted, Form, FrequencyFit, FrequencyWeights, PoleSearch,
    fit_discrete, fit_table, sample_model,
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
        form: Form::TakenakaMalmquist {
            filters: 2,
            feed_through: FeedThrough::default(),
            pole_per_transfer_function: false,
        },
        poles,
        weights: FrequencyWeights::Relative,
        ..FrequencyFit::default()
    }
}

fn fitted(samples: &[TransferSample], fit: &FrequencyFit) -> (Model, CoefficientUncertainty) {
    let Fitted { model, report } = fit_table(samples, &Dof::TWO, fit).unwrap();
    let estimate = table_uncertainty(samples, &Dof::TWO, fit, &report).unwrap();
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

/// The same tables whose transfer functions differ between the two speeds by 3 % in size and in phase.
fn different(seed: u64) -> Vec<TransferSample> {
    let mut samples = scattered(seed);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(7);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    for speed in [8.17, 4.0] {
        let factors: Vec<(f64, f64)> = (0..4).map(|_| (0.03 * normal(), 0.03 * normal())).collect();
        let own = samples
            .iter_mut()
            .filter(|s| s.mean_speed_m_s == Some(speed));
        let mut own: Vec<&mut TransferSample> = own.collect();
        for point in own.chunks_mut(8) {
            for (pair, (size, phase)) in point.chunks_mut(2).zip(&factors) {
                let (re, im) = (pair[0].value, pair[1].value);
                pair[0].value += size * re - phase * im;
                pair[1].value += size * im + phase * re;
            }
        }
    }
    samples
}

/// Intervals hold the truth when speeds differ; those of the blocks alone do not. If 95 % of 200 hold it, fewer than 180 do so
/// once in 500 times, and all 200 once in 28 000.
#[test]
fn intervals_hold_a_truth_that_differs_between_speeds() {
    let fit = two_poles(PoleSearch::fixed(&[0.091, 0.6]));
    let jones = Model::Rational(RationalModel::jones_flat_plate());
    let truth = onset(&jones).at.speed_m_s;
    let (mut held, mut counted) = (0, 0);
    for seed in 0..200 {
        let (model, estimate) = fitted(&different(seed), &fit);
        let found = onset(&model);
        let error = onset_error(&estimate, &structure(), &found, None).unwrap();
        held += usize::from((found.at.speed_m_s - truth).abs() <= error.half_width_m_s());
        let speeds = estimate.speeds.clone().unwrap();
        counted += usize::from(speeds.counted);
        assert!(error.degrees_of_freedom < 12.0, "{error:?}");
    }
    assert!((180..200).contains(&held), "{held} of 200");
    assert!(counted >= 195, "{counted} of 200");
    // without scatter the ratio is near one and seldom counted
    let quiet = (0..60).filter(|seed| {
        let (_, estimate) = fitted(&scattered(*seed), &fit);
        estimate.speeds.unwrap().counted
    });
    let quiet = quiet.count();
    assert!(quiet <= 15, "{quiet} of 60");
}

/// On every measured deck the joint interval holds the onset of each mean speed alone, and speeds that contradict each other
/// are named with what to test again.
#[test]
fn joint_intervals_of_decks_hold_the_onset_of_each_speed() {
    let mut contradictions = 0;
    for name in embedded::names() {
        let table = embedded::deck(name).unwrap();
        let (model, estimate) = fitted(&table.samples(&Dof::TWO), &FrequencyFit::default());
        let tested = table.tested_range(&Dof::TWO);
        let at = onset_within(&model, Some(tested));
        let error = onset_error(&estimate, &structure(), &at, None).unwrap();
        let half = error.half_width_m_s();
        let search = OnsetSearch::default();
        let speeds = speed_onsets(&estimate, &structure(), &at, (&search, tested)).unwrap();
        assert_eq!(speeds.each.len(), 2, "{name}");
        for speed in &speeds.each {
            let own = speed.onset.as_ref().unwrap();
            assert!(
                (own.speed_m_s - at.at.speed_m_s).abs() <= half,
                "{name}: {own:?} outside {:.3} ± {half:.3}",
                at.at.speed_m_s
            );
        }
        if let Some(c) = &speeds.contradiction {
            contradictions += 1;
            assert!(
                tested.min.full_width() <= c.k_low && c.k_low < c.k_high,
                "{c:?}"
            );
            let text = c.explain();
            assert!(text.contains("test again between K"), "{text}");
        }
    }
    assert!(contradictions > 0);
}

/// A form whose bias is known shows no interval, but its reason and the scatter.
#[test]
fn a_known_bias_leaves_no_bare_interval() {
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
    let Fitted { model, report } = fit_discrete(&sources, &fit, &|_| ()).unwrap();
    let estimate = discrete_uncertainty(&sources, &fit, &model, &|_| ()).unwrap();
    let at = onset(&model);
    let search = OnsetSearch::default();
    let known = ModelUncertainty::new(
        estimate,
        &structure(),
        Some(&at),
        search,
        report.tested_range,
    )
    .unwrap();
    let interval = known.interval(&model, &structure(), &at).unwrap();
    let crate::flutter::OnsetInterval::None { reason } = interval else {
        panic!("{interval:?}");
    };
    assert!(
        reason.contains("no feed-through") && reason.contains("standard error"),
        "{reason}"
    );
    let text = known.explain().unwrap();
    assert!(text.contains("no 95 % interval"), "{text}");
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
    let model = fit_discrete(&sources, &fit, &|_| ()).unwrap().model;
    let discrete = discrete_uncertainty(&sources, &fit, &model, &|_| ()).unwrap();
    for (model, estimate) in [continuous, (model, discrete)] {
        let at = onset(&model);
        let omega = std::f64::consts::TAU * at.at.frequency_hz;
        let gradient = onset_gradient(&estimate, &structure(), (at.at.speed_m_s, omega)).unwrap();
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

/// Repeated scattered tables: stated standard errors of onset and poles are the scatter of the estimates, poles known and
/// poles searched. 120 repetitions tell a standard deviation to 6.5 %; three times that, and 5 % for the curvature of
/// the poles, are allowed.
#[test]
fn stated_errors_are_the_scatter_of_repeated_tables() {
    let searched = PoleSearch {
        start: Some(vec![0.091, 0.6]),
        ..PoleSearch::default()
    };
    for fit in [
        two_poles(PoleSearch::fixed(&[0.091, 0.6])),
        two_poles(searched),
    ] {
        let (mut speeds, mut stated) = (Vec::new(), 0.0);
        let runs = 120;
        for seed in 0..runs {
            let (model, estimate) = fitted(&scattered(seed), &fit);
            let found = onset(&model);
            let error = onset_error(&estimate, &structure(), &found, None).unwrap();
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
    let error = onset_error(&estimate, &structure(), &at, None).unwrap();
    let resampled = |resampling| {
        let plan = ResamplingPlan {
            resampling,
            replicates: 600,
            seed: 1,
            search: OnsetSearch::default(),
            tested: None,
        };
        let once = resample_onset(&estimate, &structure(), &at, &plan)
            .unwrap()
            .unwrap();
        assert_eq!(once.without_onset, 0);
        assert_eq!(
            Some(once.clone()),
            resample_onset(&estimate, &structure(), &at, &plan).unwrap()
        );
        once.standard_deviation_m_s / error.standard_error_m_s
    };
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
