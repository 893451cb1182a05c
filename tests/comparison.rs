//! Comparison metrics against independently computed numbers (`tests/data/comparison_golden.json`).
use aerodeck::comparison::{
    PhaseParameters, SignalPair, WaveletParameters, magnitude, magnitude_warped, peak, phase, rms,
    wavelet, wavelet_normalised,
};
use approx::assert_relative_eq;
use serde_json::Value;
use std::f64::consts::{FRAC_PI_3, FRAC_PI_6, PI, TAU};

const STEP_S: f64 = 0.01;
const AMPLITUDES: [f64; 2] = [1.0, 1.3];
const FREQUENCIES_HZ: [f64; 2] = [2.0, 2.8];
const CHIRP_END_HZ: f64 = 3.6;

/// Both programs add up rounding errors of 1000 to 10 000 terms in a different order; the signals themselves
/// agree to an ulp or two only.
const ALL_DIGITS: f64 = 2e-14;

/// Signals of one golden pair, as the header of the data file defines them.
fn signals(name: &str, sample_count: usize) -> (Vec<f64>, Vec<f64>) {
    let duration_s = STEP_S * sample_count as f64;
    let sweep = (CHIRP_END_HZ - FREQUENCIES_HZ[1]) / duration_s;
    (1..=sample_count)
        .map(|k| {
            let t = STEP_S * k as f64;
            let angle = TAU * FREQUENCIES_HZ[0] * t;
            let second_angle = TAU * FREQUENCIES_HZ[1] * t + FRAC_PI_3;
            let u = |p: f64| AMPLITUDES[0] * (angle + p).cos();
            let v = |p: f64| AMPLITUDES[1] * (second_angle + p).cos();
            let x1 = u(0.0) + v(0.0);
            let x2 = match name {
                "case1_phase" => u(PI) + v(FRAC_PI_6),
                "case2_amp" => 2.0 * x1,
                "case3_chirp" => u(0.0) + v(PI * sweep * t * t),
                _ => {
                    let product = u(0.0) / AMPLITUDES[0] * v(0.0) / AMPLITUDES[1];
                    x1 + 0.5 * (AMPLITUDES[0] + AMPLITUDES[1]) * product
                }
            };
            (x1, x2)
        })
        .unzip()
}

fn golden() -> Vec<(String, Value)> {
    let text = include_str!("data/comparison_golden.json");
    let file: Value = serde_json::from_str(text).unwrap();
    let pairs = file["pairs"].as_object().unwrap();
    assert_eq!(pairs.len(), 8);
    pairs.iter().map(|(k, v)| (k.clone(), v.clone())).collect()
}

fn number(entry: &Value, key: &str) -> f64 {
    entry[key].as_f64().unwrap()
}

#[test]
fn golden_numbers_are_met_to_all_digits() {
    for (name, entry) in golden() {
        let (case, duration) = name.rsplit_once('_').unwrap();
        let sample_count = if duration == "100s" { 10_000 } else { 1000 };
        let (x1, x2) = signals(case, sample_count);
        let pair = SignalPair::new(&x1, &x2, STEP_S).unwrap();
        let close = |value: f64, key: &str| {
            assert_relative_eq!(value, number(&entry, key), max_relative = ALL_DIGITS);
        };
        let phase = phase(&pair, &PhaseParameters::published(1.0)).unwrap();
        close(phase.value, "M_phi");
        assert_eq!(
            phase.details.whole_lag_samples.unsigned_abs() as u64,
            entry["lag"]
        );
        close(peak(&pair).unwrap().value, "M_p");
        close(rms(&pair).unwrap().value, "M_rms");
        close(magnitude(&pair).unwrap().value, "M_muw");
        if duration == "10s" {
            let warped = magnitude_warped(&pair, None).unwrap();
            close(warped.value, "M_m_warped");
            close(warped.details.path_cost, "dtw_distance");
            assert_eq!(warped.details.path_length as u64, entry["path_len"]);
            let levels = WaveletParameters {
                level_count: 120,
                ..WaveletParameters::default()
            };
            close(wavelet(&pair, &levels).unwrap().value, "M_w_120");
            close(
                wavelet_normalised(&pair, &levels).unwrap().value,
                "M_wf_120",
            );
        }
    }
}
