//! The two routes to the error of an onset against each other and against re-solved onsets.

use super::onset::{ResamplingPlan, onset_error, onset_gradient, resample_onset};
use super::speed_onsets::speed_onsets;
use super::*;
use crate::aerodynamics::derivatives::TransferSample;
use crate::aerodynamics::{FlatPlate, RationalModel};
use crate::aeroelastic::CoupledSection;
use crate::files::derivatives::embedded;
use crate::flutter::{BetweenSpeeds, Onset, OnsetSearch, find_onset};
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

/// The covariance of the blocks alone, for truths that do not differ between speeds.
fn by_blocks(mut estimate: CoefficientUncertainty) -> CoefficientUncertainty {
    let contributions = estimate.design.as_ref().unwrap().contributions();
    estimate.covariance = &contributions * contributions.transpose();
    estimate.effects.clear();
    estimate
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

/// The same tables whose transfer functions differ between the two speeds, as those of measured decks: both motions of a force
/// by the same absolute amount, 1.5 % of the force's transfer functions in size and in phase.
fn different(seed: u64) -> Vec<TransferSample> {
    let mut samples = scattered(seed);
    // eight samples per test point: real and imaginary part of four transfer functions
    // seen over the reduced frequencies that both speeds have, as they are judged
    let ends = |speed: f64| {
        let own = samples
            .iter()
            .filter(move |s| s.mean_speed_m_s == Some(speed));
        own.map(|s| s.k.full_width())
            .fold((f64::INFINITY, 0.0_f64), |(low, high), k| {
                (low.min(k), high.max(k))
            })
    };
    let common = ends(4.0).0..=ends(8.17).1;
    let size = |entry: usize| -> f64 {
        let own = samples
            .chunks(8)
            .filter(|p| common.contains(&p[0].k.full_width()))
            .map(|p| p[2 * entry].value.hypot(p[2 * entry + 1].value));
        own.map(|x| x * x).sum::<f64>().sqrt()
    };
    let sizes = [0, 1, 2, 3].map(size);
    let of_force = |entry: usize| {
        let first = 2 * (entry / 2);
        (0.5 * (sizes[first].powi(2) + sizes[first + 1].powi(2))).sqrt()
    };
    let relative = [0, 1, 2, 3].map(|entry| 0.015 * of_force(entry) / sizes[entry]);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(7);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    for speed in [8.17, 4.0] {
        let factors = relative.map(|part| (part * normal(), part * normal()));
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

/// Intervals hold the truth when speeds differ, and, wider than they need be, when speeds agree. If 95 % of 200 hold it, fewer
/// than 180 do so once in 500 times.
#[test]
fn intervals_hold_a_truth_that_differs_between_speeds() {
    // −(e₁ + e₁ᵀ) of a flat plate is singular: the truth lies on a constraint, which would bind now and then
    let fit = FrequencyFit {
        constraints: Constraints::None,
        ..two_poles(PoleSearch::fixed(&[0.091, 0.6]))
    };
    let jones = Model::Rational(RationalModel::jones_flat_plate());
    let truth = onset(&jones).at.speed_m_s;
    let judged = |samples: fn(u64) -> Vec<TransferSample>, count: u64| {
        let (mut held, mut ratio) = (0, 0.0);
        for seed in 0..count {
            let (model, estimate) = fitted(&samples(seed), &fit);
            let found = onset(&model);
            let error = onset_error(&estimate, &structure(), &found, None).unwrap();
            held += usize::from((found.at.speed_m_s - truth).abs() <= error.half_width_m_s());
            ratio += estimate.speeds.unwrap().ratio.unwrap() / count as f64;
        }
        (held, ratio)
    };
    let (held, ratio) = judged(different, 200);
    println!("{held} {ratio}");
    assert!((180..200).contains(&held), "{held} of 200");
    let (held, ratio) = judged(scattered, 60);
    println!("{held} {ratio}");
    assert!(held >= 54, "{held} of 60");
    // the mean of a ratio that is one without scatter, over 60 times 4 ratios of two degrees of freedom
    assert!((ratio - 1.0).abs() < 0.3, "{ratio}");
}

/// The stored ratios of the prior are what the embedded decks give; where they are not, the message is what to store.
#[test]
fn ratios_are_those_of_the_embedded_decks() {
    let fit = FrequencyFit {
        form: Form::default().with_filters(3).unwrap(),
        constraints: Constraints::Dissipative,
        ..FrequencyFit::default()
    };
    let found = speed_prior::MEASURED.map(|(name, _)| {
        let table = embedded::deck(name).unwrap();
        let (_, estimate) = fitted(&table.samples(&Dof::TWO), &fit);
        let forces = estimate.speeds.unwrap().forces;
        let of_force = |i: usize| {
            [
                forces[i].size_ratio.unwrap(),
                forces[i].phase_ratio.unwrap(),
            ]
        };
        let ([a, b], [c, d]) = (of_force(0), of_force(1));
        [a, b, c, d]
    });
    let stored = speed_prior::MEASURED.map(|(_, ratios)| ratios);
    let mut pairs = found.iter().flatten().zip(stored.iter().flatten());
    // two decimals are stored
    assert!(pairs.all(|(a, b)| (a - b).abs() < 0.006), "{found:.2?}");
}

/// What the prior is worth on decks that it was not made of: every deck is judged by the other four. The joint interval holds
/// the onset of each mean speed alone, half of them are narrower than 5 % of the onset, and two models of one speed each, which know
/// the scatter between speeds from the prior alone, differ by about what they say: 1.2 standard errors, root mean square (over five decks it is
/// known to 0.3).
#[test]
fn the_prior_of_four_decks_serves_the_fifth() {
    let structure = structure();
    let judge = |name: &str, samples: &[TransferSample], fit: &FrequencyFit| {
        let (model, estimate) = fitted(samples, fit);
        let tested = estimate.tested_range().unwrap();
        let estimate = estimate.leaving_out(name).unwrap();
        let at = onset_within(&model, Some(tested));
        onset_error(&estimate, &structure, &at, None).unwrap()
    };
    let (mut halves, mut squares, mut held, mut all) = (Vec::new(), 0.0, 0, 0);
    for constraints in [Constraints::None, Constraints::Dissipative] {
        for name in embedded::names() {
            let fit = FrequencyFit {
                constraints,
                ..FrequencyFit::default()
            };
            let table = embedded::deck(name).unwrap();
            let joint = judge(name, &table.samples(&Dof::TWO), &fit);
            assert_eq!(joint.between_speeds, Some(BetweenSpeeds::Tests));
            halves.push(joint.half_width_m_s() / joint.speed_m_s);
            let alone = [0, 1].map(|group| {
                let own = table.at_speed_group(group).unwrap();
                judge(name, &own.samples(&Dof::TWO), &fit)
            });
            for own in &alone {
                assert_eq!(own.between_speeds, Some(BetweenSpeeds::Prior));
                let off = (own.speed_m_s - joint.speed_m_s).abs();
                held += usize::from(off <= joint.half_width_m_s());
                all += 1;
            }
            let [a, b] = alone;
            let error = a.standard_error_m_s.hypot(b.standard_error_m_s);
            squares += ((a.speed_m_s - b.speed_m_s) / error).powi(2);
        }
    }
    halves.sort_by(f64::total_cmp);
    let rms = (squares / halves.len() as f64).sqrt();
    let median = 0.5 * (halves[4] + halves[5]);
    println!("{held} of {all}, half widths {halves:?}, median {median}, rms {rms}");
    assert_eq!((held, all), (20, 20));
    assert!(median < 0.05, "{median}");
    assert!(rms < 1.3, "{rms}");
}

/// Mean speeds that contradict each other are named with what to test again.
#[test]
fn speeds_that_contradict_each_other_are_named() {
    let mut contradictions = 0;
    for name in embedded::names() {
        let table = embedded::deck(name).unwrap();
        let (model, estimate) = fitted(&table.samples(&Dof::TWO), &FrequencyFit::default());
        let tested = table.tested_range(&Dof::TWO);
        let at = onset_within(&model, Some(tested));
        let search = OnsetSearch::default();
        let speeds = speed_onsets(&estimate, &structure(), &at, (&search, tested)).unwrap();
        assert_eq!(speeds.each.len(), 2, "{name}");
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
            let estimate = by_blocks(estimate);
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

/// Forty decks of the family, eight of each range: nothing false is said of any, and every deck whose tests surround its onset is
/// answered.
#[test]
fn a_family_of_decks_is_told_nothing_false() {
    let plan = FamilyPlan {
        decks: 40,
        ..FamilyPlan::default()
    };
    let report = family_coverage(&plan, &|_| ()).unwrap();
    for d in &report.decks {
        println!("DECK {}", serde_json::to_string(d).unwrap());
    }
    for r in &report.ranges {
        println!("{r:?}");
        assert_eq!(r.false_no_flutter, 0, "{r:?}");
        assert_eq!(r.met_against_truth, 0, "{r:?}");
        assert_eq!(r.unsafe_side, 0, "{r:?}");
    }
    let normal = &report.ranges[0];
    assert_eq!((normal.range, normal.decks), (FamilyRange::Normal, 8));
    assert_eq!((normal.refused, normal.held.inside), (0, 8));
    let all = report.ranges.last().unwrap();
    assert!(all.held.of >= 20, "{all:?}");
}
