//! Digital Butterworth low-pass as second-order sections.
//!
//! Analogue poles `s_k = Ω e^{iπ(2k+N−1)/(2N)}`, k = 1…N, with the pre-warped cut-off `Ω = 4 tan(π f_c/f_s)`, taken to
//! `z_k = (4 + s_k)/(4 − s_k)`; every zero lies at −1 (Oppenheim & Schafer, *Discrete-Time Signal Processing*, section 7.2).
//! Each section has unit gain for a constant, and its `1 − z_k` is computed as `−2s_k/(4 − s_k)`, without the
//! cancellation that ruins the polynomial form at low cut-offs.

use crate::error::{Result, counted, ensure, positive};
use nalgebra::Complex;
use std::f64::consts::PI;

/// Highest order: beyond it the sections ring for longer than a test point lasts.
const ORDER_AT_MOST: usize = 12;

/// `y[k] = b₀x[k] + b₁x[k−1] + b₂x[k−2] − a₁y[k−1] − a₂y[k−2]`; a first-order section has `b₂ = a₂ = 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SecondOrderSection {
    /// Numerator, from `z⁰` on.
    pub b: [f64; 3],
    /// Denominator without its leading one.
    pub a: [f64; 2],
}

impl SecondOrderSection {
    /// From `p = 1 − z` of a pole: a pair of conjugate ones.
    fn pair(p: Complex<f64>) -> Self {
        let gain = 0.25 * p.norm_sqr();
        let z = Complex::new(1.0, 0.0) - p;
        Self {
            b: [gain, 2.0 * gain, gain],
            a: [-2.0 * z.re, z.norm_sqr()],
        }
    }

    fn single(p: f64) -> Self {
        Self {
            b: [0.5 * p, 0.5 * p, 0.0],
            a: [p - 1.0, 0.0],
        }
    }

    /// States of the transposed direct form when the input has been one for ever.
    fn steady_state(&self) -> [f64; 2] {
        let second = self.b[2] - self.a[1];
        [self.b[1] - self.a[0] + second, second]
    }

    /// Filters in place, starting as if the first sample had always been there.
    pub(super) fn run(&self, samples: &mut [f64], first: f64) {
        let [mut s1, mut s2] = self.steady_state().map(|s| s * first);
        for x in samples {
            let y = self.b[0] * *x + s1;
            s1 = self.b[1] * *x - self.a[0] * y + s2;
            s2 = self.b[2] * *x - self.a[1] * y;
            *x = y;
        }
    }
}

/// A low-pass of given order and cut-off (half power at one passage).
#[derive(Debug, Clone, PartialEq)]
pub struct ButterworthLowPass {
    order: usize,
    sections: Vec<SecondOrderSection>,
}

impl ButterworthLowPass {
    /// The low-pass of `order` with the cut-off `cutoff_hz` for signals sampled at `sampling_hz`.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for an order that is not 1 to 12, frequencies that are not positive, and a cut-off that is not
    /// below half the sampling frequency.
    pub fn new(order: usize, cutoff_hz: f64, sampling_hz: f64) -> Result<Self> {
        positive("sampling_hz", sampling_hz)?;
        positive("low-pass cutoff_hz", cutoff_hz)?;
        let fits = (1..=ORDER_AT_MOST).contains(&order);
        let expected = format_args!("1 to {ORDER_AT_MOST}");
        ensure(fits, "low-pass order", expected, order)?;
        let (nyquist, found) = (0.5 * sampling_hz, format_args!("{cutoff_hz} Hz"));
        let expected =
            format_args!("below the Nyquist frequency, {nyquist} Hz at {sampling_hz} Hz");
        ensure(cutoff_hz < nyquist, "low-pass cutoff_hz", expected, found)?;
        let warped = 4.0 * (PI * cutoff_hz / sampling_hz).tan();
        let away_from_one = |k: usize| {
            let angle = PI * (2 * k + order - 1) as f64 / (2 * order) as f64;
            let s = Complex::from_polar(warped, angle);
            s * -2.0 / (Complex::new(4.0, 0.0) - s)
        };
        let middle = (order % 2 == 1).then(|| away_from_one(order.div_ceil(2)).re);
        let single = middle.into_iter().map(SecondOrderSection::single);
        let pairs = (1..=order / 2).map(|k| SecondOrderSection::pair(away_from_one(k)));
        let sections = single.chain(pairs).collect();
        Ok(Self { order, sections })
    }

    /// Amplitude that a harmonic keeps at one passage.
    pub fn gain(&self, frequency_hz: f64, sampling_hz: f64) -> f64 {
        let z = Complex::from_polar(1.0, -2.0 * PI * frequency_hz / sampling_hz);
        let of_one = |s: &SecondOrderSection| {
            let above = z * (z * s.b[2] + s.b[1]) + s.b[0];
            let below = z * (z * s.a[1] + s.a[0]) + 1.0;
            (above / below).norm()
        };
        self.sections.iter().map(of_one).product()
    }

    /// Samples that a signal must exceed to be filtered.
    pub fn padding(&self) -> usize {
        3 * (self.order + 1)
    }

    /// `signal` without what lies above the cut-off, filtered forward and backward: the phase of every component stays, its
    /// amplitude is scaled by the squared gain.
    ///
    /// The signal is continued oddly at both ends (`2x₀ − x_k`) by three times the number of coefficients, and each passage
    /// starts as if its first sample had always been there (Gustafsson 1996, IEEE Trans. Signal Process. 44(4), for the
    /// start). The numbers are those of `scipy.signal.sosfiltfilt` with its default padding.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for a signal not longer than [`Self::padding`].
    pub fn zero_phase(&self, signal: &[f64]) -> Result<Vec<f64>> {
        let (n, pad) = (signal.len(), self.padding());
        let expected = format_args!("more than {}", counted(pad, "sample"));
        ensure(n > pad, "signal to be filtered", expected, n)?;
        let (first, last) = (signal[0], signal[n - 1]);
        let before = (1..=pad).rev().map(|k| 2.0 * first - signal[k]);
        let after = (1..=pad).map(|k| 2.0 * last - signal[n - 1 - k]);
        let mut extended: Vec<f64> = before.chain(signal.iter().copied()).chain(after).collect();
        for _ in 0..2 {
            let start = extended[0];
            for section in &self.sections {
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

    /// The bilinear transform maps the analogue gain `1/√(1 + (Ω/Ω_c)^2N)` exactly, with `Ω = tan(πf/f_s)`.
    #[test]
    fn the_gain_is_that_of_the_analogue_filter() {
        for order in 1..=8 {
            let filter = ButterworthLowPass::new(order, 7.0, 200.0).unwrap();
            for f in [0.25, 2.5, 7.0, 20.0] {
                let ratio = (PI * f / 200.0).tan() / (PI * 7.0 / 200.0_f64).tan();
                let analogue = 1.0 / (1.0 + ratio.powi(2 * order as i32)).sqrt();
                // rounding of eight sections
                assert!(
                    (filter.gain(f, 200.0) - analogue).abs() < 1e-11,
                    "{order} {f}"
                );
            }
        }
    }

    #[test]
    fn impossible_filters_are_refused() {
        let message = |order, cutoff| {
            ButterworthLowPass::new(order, cutoff, 200.0)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            message(4, 100.0),
            "low-pass cutoff_hz: expected below the Nyquist frequency, 100 Hz at 200 Hz, found 100 Hz"
        );
        assert!(message(0, 3.0).contains("1 to 12"));
        assert!(message(4, f64::NAN).contains("positive"));
    }

    #[derive(serde::Deserialize)]
    struct Reference {
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
            "/../../tests/data/butterworth_golden.json"
        );
        let text = std::fs::read_to_string(path).unwrap();
        let cases: Vec<Reference> = serde_json::from_str(&text).unwrap();
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
