//! Stationary companions of a signal: its spectrum with random phases.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;
use std::f64::consts::TAU;

/// Random numbers of one purpose: the same for the same seed and stream, whatever else is drawn.
pub(super) fn random_stream(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(stream);
    random
}

/// `count` signals with the Fourier moduli of a `signal` of even length and phases uniform in 0…2π; mean and
/// Nyquist term are kept.
pub(super) fn phase_randomised(signal: &[f64], count: usize, seed: u64) -> Vec<Vec<f64>> {
    let n = signal.len();
    let mut planner = FftPlanner::new();
    let inverse = planner.plan_fft_inverse(n);
    let mut spectrum: Vec<Complex64> = signal.iter().map(|&x| Complex64::from(x)).collect();
    planner.plan_fft_forward(n).process(&mut spectrum);
    (0..count)
        .map(|index| {
            let mut random = random_stream(seed, index as u64);
            let mut buffer = spectrum.clone();
            for k in 1..n / 2 {
                let phase = random.random_range(0.0..TAU);
                buffer[k] = Complex64::from_polar(spectrum[k].norm(), phase);
                buffer[n - k] = buffer[k].conj();
            }
            inverse.process(&mut buffer);
            buffer.iter().map(|z| z.re / n as f64).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

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
}
