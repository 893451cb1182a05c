//! Metrics that compare two signals.

use crate::entry::Job;
use aerodeck::comparison::{
    BicoherenceParameters, PhaseParameters, SignalPair, StationarityParameters, WaveletParameters,
    bicoherence, magnitude_warped, phase, probability_density, stationarity, warping_path, wavelet,
};
use serde_json::{Value, json};
use std::cell::Cell;
use std::hint::black_box;
use std::rc::Rc;

const STEP_S: f64 = 0.005;
const LONG: usize = 20_000;
/// 20 s at 200 Hz.
const SHORT: usize = 4000;

/// Two forces at 2 Hz and its odd multiples with noise, the second late, weaker and with other noise.
fn signals(samples: usize) -> (Vec<f64>, Vec<f64>) {
    let mut state = 1_u64;
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        0.1 * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
    };
    let force = |t: f64| (12.6 * t).cos() + 0.2 * (37.7 * t + 0.4).cos();
    (0..samples)
        .map(|k| STEP_S * k as f64)
        .map(|t| (force(t) + noise(), 0.9 * force(t - 0.012) + noise()))
        .unzip()
}

/// Distance and path; the baseline finds the same squared distance.
pub(crate) fn warping() -> Job {
    let (reference, compared) = signals(LONG);
    let found = Rc::new(Cell::new(f64::NAN));
    let answer = Rc::clone(&found);
    let work = move || {
        let path = warping_path(&compared, &reference, None).expect("a path");
        found.set(path.distance);
    };
    Job::new(work).finding(move || vec![answer.get()])
}

pub(crate) fn warping_argument() -> Value {
    let (reference, compared) = signals(LONG);
    json!({ "reference": reference, "compared": compared })
}

fn metric(of: impl Fn(&SignalPair<'_>) -> aerodeck::Result<f64> + 'static) -> Job {
    let (x1, x2) = signals(SHORT);
    Job::new(move || {
        let pair = SignalPair::new(&x1, &x2, STEP_S).expect("a pair");
        black_box(of(&pair).expect("a metric"));
    })
}

pub(crate) fn metric_phase() -> Job {
    metric(|pair| Ok(phase(pair, &PhaseParameters::default())?.value))
}

pub(crate) fn metric_magnitude_warped() -> Job {
    metric(|pair| Ok(magnitude_warped(pair, None)?.value))
}

pub(crate) fn metric_wavelet() -> Job {
    metric(|pair| Ok(wavelet(pair, &WaveletParameters::default())?.value))
}

pub(crate) fn metric_density() -> Job {
    metric(|pair| Ok(probability_density(pair, true)?.value))
}

pub(crate) fn metric_stationarity() -> Job {
    let few = WaveletParameters {
        level_count: 120,
        ..WaveletParameters::default()
    };
    metric(move |pair| {
        let parameters = StationarityParameters {
            wavelet: few,
            ..StationarityParameters::default()
        };
        Ok(stationarity(pair, &parameters)?.value)
    })
}

pub(crate) fn metric_bicoherence() -> Job {
    metric(|pair| Ok(bicoherence(pair, &BicoherenceParameters::default())?.value))
}
