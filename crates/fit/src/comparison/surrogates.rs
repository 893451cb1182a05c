//! Stationary companions of a signal, its spectrum with random phases; and the gamma distribution of what is found of them, by
//! maximum likelihood.

use crate::signal::{Complex64, Fourier, random_stream};
use rand::Rng;
use statrs::function::gamma::{checked_gamma_lr, digamma};
use std::f64::consts::TAU;

/// `count` signals with the Fourier moduli of a `signal` of even length and phases uniform in 0…2π; mean and
/// Nyquist term are kept.
pub(super) fn phase_randomised(signal: &[f64], count: usize, seed: u64) -> Vec<Vec<f64>> {
    let n = signal.len();
    let fourier = Fourier::new(n);
    let spectrum = fourier.spectrum(signal.iter().copied());
    let drawn = |index| {
        let mut random = random_stream(seed, index as u64);
        let mut buffer = spectrum.clone();
        for k in 1..n / 2 {
            let phase = random.random_range(0.0..TAU);
            buffer[k] = Complex64::from_polar(spectrum[k].norm(), phase);
            buffer[n - k] = buffer[k].conj();
        }
        fourier.sums(buffer).iter().map(|x| x / n as f64).collect()
    };
    (0..count).map(drawn).collect()
}

/// Shape and scale of the gamma distribution of a sample, by maximum likelihood: `ln k − ψ(k) = ln x̄ − mean ln x`, `θ = x̄/k`.
///
/// `None` unless all values are positive and finite and not all are equal.
pub(super) fn gamma_fit(sample: &[f64]) -> Option<[f64; 2]> {
    const ITERATIONS: usize = 50;
    if !sample.iter().all(|x| x.is_finite() && *x > 0.0) {
        return None;
    }
    let n = sample.len() as f64;
    let mean = sample.iter().sum::<f64>() / n;
    let target = mean.ln() - sample.iter().map(|x| x.ln()).sum::<f64>() / n;
    // Equal values leave the rounding error of the two sums.
    if target.is_nan() || target < 1e-13 {
        return None;
    }
    // Start accurate to 1.5 % (Minka 2002), then Newton.
    let root = ((target - 3.0).powi(2) + 24.0 * target).sqrt();
    let mut shape = (3.0 - target + root) / (12.0 * target);
    for _ in 0..ITERATIONS {
        let slope = 1.0 / shape - trigamma(shape);
        let step = (shape.ln() - digamma(shape) - target) / slope;
        shape = (shape - step).max(0.5 * shape);
        if step.abs() <= 1e-12 * shape {
            break;
        }
    }
    Some([shape, mean / shape])
}

/// Probability of values up to `x`: the regularised incomplete gamma function `P(k, x/θ)`.
pub(super) fn gamma_cumulative(shape: f64, scale: f64, x: f64) -> f64 {
    checked_gamma_lr(shape, x.max(0.0) / scale).unwrap_or(f64::NAN)
}

/// `ψ'(x)` by recurrence up to 10 and the asymptotic series there (DLMF 5.15.8).
fn trigamma(mut x: f64) -> f64 {
    let mut below = 0.0;
    while x < 10.0 {
        below += 1.0 / (x * x);
        x += 1.0;
    }
    let r = 1.0 / (x * x);
    let tail = 1.0 / 6.0 - r * (1.0 / 30.0 - r * (1.0 / 42.0 - r * (1.0 / 30.0 - r * 5.0 / 66.0)));
    below + 1.0 / x + 0.5 * r + r / x * tail
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    #[test]
    fn power_and_correlation_are_kept_and_seeds_repeat() {
        let x: Vec<f64> = (0..200)
            .map(|k| (0.01 * (k * k) as f64).sin() + 0.3)
            .collect();
        let circular =
            |y: &[f64], lag: usize| -> f64 { (0..200).map(|k| y[k] * y[(k + lag) % 200]).sum() };
        let surrogates = phase_randomised(&x, 3, 7);
        for y in &surrogates {
            assert!(y.iter().zip(&x).any(|(a, b)| (a - b).abs() > 0.1));
            for lag in [0, 1, 17] {
                assert_abs_diff_eq!(circular(y, lag), circular(&x, lag), epsilon = 1e-10);
            }
        }
        assert_eq!(surrogates, phase_randomised(&x, 3, 7));
        assert_ne!(surrogates, phase_randomised(&x, 3, 8));
    }

    #[test]
    fn closed_forms_of_whole_shapes() {
        // P(1, x) = 1 − e^(−x), P(3, x) = 1 − e^(−x)(1 + x + x²/2): both branches.
        for x in [0.01_f64, 0.7, 2.0, 5.0, 30.0] {
            let gamma = |shape| gamma_cumulative(shape, 2.0, 2.0 * x);
            let tail = (-x).exp();
            assert_relative_eq!(gamma(1.0), -(-x).exp_m1(), max_relative = 1e-13);
            let three = 1.0 - tail * (1.0 + x + 0.5 * x * x);
            assert_abs_diff_eq!(gamma(3.0), three, epsilon = 1e-14);
        }
    }

    #[test]
    fn trigamma_at_a_known_place() {
        let expected = std::f64::consts::PI.powi(2) / 6.0;
        assert_abs_diff_eq!(trigamma(1.0), expected, epsilon = 1e-13);
    }

    #[test]
    fn a_fit_finds_the_shape_of_quantiles() {
        // Quantiles of the exponential distribution, shape 1 and scale 3.
        let sample: Vec<f64> = (0..20_000)
            .map(|k| -3.0 * (1.0 - (f64::from(k) + 0.5) / 20_000.0).ln())
            .collect();
        let [shape, scale] = gamma_fit(&sample).unwrap();
        // The quantiles cut off the tails.
        assert_relative_eq!(shape, 1.0, max_relative = 2e-3);
        assert_relative_eq!(scale, 3.0, max_relative = 2e-3);
        assert!(gamma_fit(&[2.0; 5]).is_none());
        assert!(gamma_fit(&[1.0, 0.0]).is_none());
    }
}
