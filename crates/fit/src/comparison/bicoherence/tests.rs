use super::*;
use approx::assert_relative_eq;
use std::f64::consts::TAU;

fn parameters() -> BicoherenceParameters {
    BicoherenceParameters {
        wavelet: WaveletParameters {
            level_count: 33,
            frequency_min_hz: 1.0,
            frequency_max_hz: 9.0,
            ..WaveletParameters::default()
        },
        surrogate_count: 40,
        ..BicoherenceParameters::default()
    }
}

/// Harmonics of 1.5 and 2.5 Hz, and one at their sum with a phase that wanders unless `coupled`.
fn triad(amplitude: f64, coupled: bool) -> Vec<f64> {
    (0..2000)
        .map(|k| {
            let t = 0.02 * k as f64;
            let wander = if coupled {
                0.0
            } else {
                2.0 * (0.7 * t).sin() + t
            };
            (TAU * 1.5 * t).cos()
                + (TAU * 2.5 * t).cos()
                + amplitude * (TAU * 4.0 * t + wander).cos()
        })
        .collect()
}

fn metric(x1: &[f64], x2: &[f64]) -> Metric<BicoherenceDetails> {
    let pair = SignalPair::new(x1, x2, 0.02).unwrap();
    bicoherence(&pair, &parameters()).unwrap()
}

#[test]
fn coupling_is_found_at_its_frequencies_and_scales_with_the_product() {
    let metric = metric(&triad(0.8, true), &triad(0.4, true));
    let strongest = metric
        .details
        .couplings
        .iter()
        .max_by(|a, b| a.reference.total_cmp(&b.reference))
        .unwrap();
    assert_relative_eq!(strongest.first_hz, 1.5, max_relative = 1e-12);
    assert_relative_eq!(strongest.second_hz, 2.5, max_relative = 1e-12);
    // √B is the product of the three moduli, nearly proportional to the amplitude of the sum: the side lobes
    // of the truncated wavelets let the other two harmonics into the third level.
    assert_relative_eq!(
        strongest.compared / strongest.reference,
        0.25,
        max_relative = 5e-2
    );
    // So where both are coupled the relative distance is a half; fewer cells pass in the weaker signal.
    assert!((0.5..0.65).contains(&metric.value), "{}", metric.value);
}

#[test]
fn equal_signals_give_one_and_lost_coupling_nothing() {
    let coupled = triad(0.8, true);
    assert_eq!(metric(&coupled, &coupled).value, 1.0);
    let uncoupled = triad(0.8, false);
    let lost = metric(&coupled, &uncoupled);
    assert!(
        lost.details.couplings.iter().all(|c| c.compared == 0.0),
        "{:?}",
        lost.details.couplings
    );
    assert_eq!(lost.value, 0.0);
}

#[test]
fn unusable_parameters_are_refused() {
    let x = triad(0.8, true);
    let pair = SignalPair::new(&x, &x, 0.02).unwrap();
    let narrow = BicoherenceParameters {
        wavelet: WaveletParameters {
            frequency_max_hz: 1.5,
            ..parameters().wavelet
        },
        ..parameters()
    };
    assert!(bicoherence(&pair, &narrow).is_err());
    let one = BicoherenceParameters {
        surrogate_count: 1,
        ..parameters()
    };
    assert!(bicoherence(&pair, &one).is_err());
}
