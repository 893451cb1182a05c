//! Resampling at a longer step by six-point Lagrange interpolation.
//!
//! Interpolation moves no phase. Its relative error for a motion sampled `m` times a period is about `(2.6/m)⁶`; nothing is
//! filtered before, so components near half the sampling frequency must be absent already.

use super::lagrange::lagrange_weights;

/// The signal at the times `m · ratio`, in units of its own step; `ratio` of the steps is at least one. The last one or two
/// samples, whose neighbours are not there, are left out.
pub fn resampled(x: &[f64], ratio: f64) -> Vec<f64> {
    let mut out = Vec::with_capacity((x.len() as f64 / ratio) as usize + 1);
    loop {
        let at = out.len() as f64 * ratio;
        // two nodes before and three after, but none before the signal
        let window = (at as usize).saturating_sub(2);
        let Some(nodes) = x.get(window..window + 6) else {
            return out;
        };
        let weights = lagrange_weights(at - window as f64);
        out.push(nodes.iter().zip(weights).map(|(x, w)| x * w).sum());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Polynomials of degree five are exact.
    #[test]
    fn quintics_are_exact() {
        let value = |t: f64| 1.0 + t * (0.5 - t * (0.02 + 1e-5 * t * t * t));
        let input: Vec<f64> = (0..60).map(|i| value(0.1 * f64::from(i))).collect();
        let ratio = 1.34;
        let whole = resampled(&input, ratio);
        assert!(whole.len() >= 42);
        for (m, x) in whole.iter().enumerate() {
            assert!((x - value(0.1 * ratio * m as f64)).abs() < 1e-12);
        }
    }
}
