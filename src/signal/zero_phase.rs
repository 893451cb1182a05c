//! Filtering forward and backward: the phase of every component stays, its amplitude is scaled by the squared gain.
//!
//! The signal is continued oddly at both ends (`2x₀ − x_k`) by three times the number of coefficients, and each passage starts
//! as if its first sample had always been there (Gustafsson 1996, IEEE Trans. Signal Process. 44(4), for the start). The
//! numbers are those of `scipy.signal.sosfiltfilt` with its default padding.

use super::butterworth::ButterworthLowPass;
use crate::error::{Error, Result};

impl ButterworthLowPass {
    /// Samples that a signal must exceed to be filtered.
    pub fn padding(&self) -> usize {
        3 * (self.order() + 1)
    }

    /// `signal` without what lies above the cut-off, its phase kept.
    ///
    /// # Errors
    /// [`Error::Input`] for a signal not longer than [`Self::padding`].
    pub fn zero_phase(&self, signal: &[f64]) -> Result<Vec<f64>> {
        let (n, pad) = (signal.len(), self.padding());
        if n <= pad {
            return Err(Error::input(
                "signal to be filtered",
                format!("more than {pad} samples"),
                n.to_string(),
            ));
        }
        let (first, last) = (signal[0], signal[n - 1]);
        let before = (1..=pad).rev().map(|k| 2.0 * first - signal[k]);
        let after = (1..=pad).map(|k| 2.0 * last - signal[n - 1 - k]);
        let mut extended: Vec<f64> = before.chain(signal.iter().copied()).chain(after).collect();
        for _ in 0..2 {
            let start = extended[0];
            for section in self.sections() {
                section.run(&mut extended, start);
            }
            extended.reverse();
        }
        Ok(extended[pad..pad + n].to_vec())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[derive(serde::Deserialize)]
    struct Case {
        order: usize,
        cutoff_hz: f64,
        sampling_hz: f64,
        samples: usize,
        output: Vec<f64>,
    }

    /// The signal of the script.
    fn value(k: usize, sampling_hz: f64) -> f64 {
        let t = k as f64 / sampling_hz;
        2.0 + 1.5 * (TAU * 2.5 * t + 0.3).sin() + (0.37 * (k * k) as f64).cos()
    }

    /// Numbers of SciPy, written by `tests/data/make_butterworth.py`.
    #[test]
    fn the_numbers_are_those_of_scipy() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/tests/data/butterworth_golden.json"
        );
        let text = std::fs::read_to_string(path).unwrap();
        let cases: Vec<Case> = serde_json::from_str(&text).unwrap();
        assert!(cases.len() >= 20);
        for case in cases {
            let filter =
                ButterworthLowPass::new(case.order, case.cutoff_hz, case.sampling_hz).unwrap();
            let input: Vec<f64> = (0..case.samples)
                .map(|k| value(k, case.sampling_hz))
                .collect();
            let ours = filter.zero_phase(&input).unwrap();
            let size = case.output.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let worst = ours
                .iter()
                .zip(&case.output)
                .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            // the order of the sections differs: rounding, amplified where the cut-off is a ten-thousandth of the sampling
            assert!(worst < 1e-8 * size, "order {}: {worst}", case.order);
        }
    }

    #[test]
    fn a_harmonic_keeps_its_phase_and_loses_the_squared_gain() {
        let filter = ButterworthLowPass::new(4, 5.0, 200.0).unwrap();
        let x = |k: usize| (TAU * 2.5 * k as f64 / 200.0 + 0.3).sin();
        let input: Vec<f64> = (0..4000).map(x).collect();
        let output = filter.zero_phase(&input).unwrap();
        let gain = filter.gain(2.5, 200.0).powi(2);
        for (k, y) in output.iter().enumerate().take(3000).skip(1000) {
            // transients of the ends have died out: e^(−1000·0.06)
            assert!((y - gain * x(k)).abs() < 1e-12);
        }
        assert!(filter.zero_phase(&input[..15]).is_err());
    }
}
