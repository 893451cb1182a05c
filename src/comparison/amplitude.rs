//! Metrics of amplitude without regard to frequency: peak, RMS, unwarped magnitude.

use super::{Metric, SignalPair, exponential};
use crate::error::Result;
use serde::Serialize;

/// One level of each signal, in the unit of the signals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LevelDetails {
    /// Level of the reference.
    pub reference: f64,
    /// Level of the compared signal.
    pub compared: f64,
}

/// A distance and what it is relative to, both Euclidean norms in the unit of the signals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DistanceDetails {
    /// `‖X₁ − X₂‖₂`.
    pub distance: f64,
    /// `‖X₁‖₂`.
    pub reference_norm: f64,
}

/// Peak metric `M_p = exp(−|P₁ − P₂|/P₁)`, `P = max|X|`.
///
/// # Errors
/// [`crate::Error::Input`] if the reference is zero throughout.
pub fn peak(pair: &SignalPair<'_>) -> Result<Metric<LevelDetails>> {
    let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    levels(largest(pair.reference()), largest(pair.compared()))
}

/// RMS metric `M_rms = exp(−|rms₁ − rms₂|/rms₁)`; means are not removed.
///
/// # Errors
/// [`crate::Error::Input`] if the reference is zero throughout, [`crate::Error::Numerical`] if a square overflows.
pub fn rms(pair: &SignalPair<'_>) -> Result<Metric<LevelDetails>> {
    let root_n = (pair.sample_count() as f64).sqrt();
    let level = |x: &[f64]| norm(x.iter().copied()) / root_n;
    levels(level(pair.reference()), level(pair.compared()))
}

/// Unwarped magnitude metric `M_muw = exp(−‖X₁ − X₂‖₂/‖X₁‖₂)`.
///
/// # Errors
/// [`crate::Error::Input`] if the reference is zero throughout, [`crate::Error::Numerical`] if a square overflows.
pub fn magnitude(pair: &SignalPair<'_>) -> Result<Metric<DistanceDetails>> {
    distance_metric(
        pair.reference()
            .iter()
            .copied()
            .zip(pair.compared().iter().copied()),
    )
}

/// `exp(−‖X₁ − X₂‖₂/‖X₁‖₂)` over the pairs `(X₁, X₂)` handed in.
pub(super) fn distance_metric(
    pairs: impl Iterator<Item = (f64, f64)> + Clone,
) -> Result<Metric<DistanceDetails>> {
    let distance = norm(pairs.clone().map(|(a, b)| a - b));
    let reference_norm = norm(pairs.map(|(a, _)| a));
    Ok(Metric {
        value: exponential(distance, reference_norm)?,
        details: DistanceDetails {
            distance,
            reference_norm,
        },
    })
}

fn levels(reference: f64, compared: f64) -> Result<Metric<LevelDetails>> {
    Ok(Metric {
        value: exponential(reference - compared, reference)?,
        details: LevelDetails {
            reference,
            compared,
        },
    })
}

fn norm(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::TAU;

    /// `X₁ = cos ωt`, `X₂ = a cos(ωt − φ)` over whole periods of 400 samples, φ a whole number of samples.
    fn harmonics(a: f64, phase_samples: usize) -> (Vec<f64>, Vec<f64>) {
        let angle = |k: usize| TAU * (k % 400) as f64 / 400.0;
        let reference = (0..4000).map(|k| angle(k).cos()).collect();
        let compared = (0..4000)
            .map(|k| a * angle(k + 400 - phase_samples).cos())
            .collect();
        (reference, compared)
    }

    #[test]
    fn harmonics_follow_the_closed_forms() {
        for (a, shift) in [(1.3, 0), (0.4, 30), (1.0, 100), (2.0, 200)] {
            let phi = TAU * shift as f64 / 400.0;
            let (x1, x2) = harmonics(a, shift);
            let pair = SignalPair::new(&x1, &x2, 0.01).unwrap();
            let ratio = (-(1.0 - a).abs()).exp();
            let distance = (1.0 + a * a - 2.0 * a * phi.cos()).sqrt();
            // Sums of 4000 terms over whole periods: rounding only.
            assert_relative_eq!(peak(&pair).unwrap().value, ratio, epsilon = 1e-13);
            assert_relative_eq!(rms(&pair).unwrap().value, ratio, epsilon = 1e-13);
            assert_relative_eq!(
                magnitude(&pair).unwrap().value,
                (-distance).exp(),
                epsilon = 1e-13
            );
        }
    }

    #[test]
    fn details_are_the_levels_themselves() {
        let pair = SignalPair::new(&[3.0, -4.0], &[0.0, 5.0], 1.0).unwrap();
        let details = rms(&pair).unwrap().details;
        assert_relative_eq!(details.reference, 12.5_f64.sqrt());
        assert_relative_eq!(details.compared, 12.5_f64.sqrt());
        assert_eq!(peak(&pair).unwrap().details.reference, 4.0);
        assert_eq!(peak(&pair).unwrap().value, (-0.25_f64).exp());
        assert_relative_eq!(magnitude(&pair).unwrap().details.distance, 90.0_f64.sqrt());
    }

    #[test]
    fn a_zero_reference_or_an_overflow_is_refused() {
        let zero = [0.0; 4];
        let one = [1.0; 4];
        let pair = SignalPair::new(&zero, &one, 1.0).unwrap();
        assert!(peak(&pair).is_err() && rms(&pair).is_err() && magnitude(&pair).is_err());
        let huge = [1e200; 4];
        let pair = SignalPair::new(&huge, &one, 1.0).unwrap();
        assert!(rms(&pair).is_err());
        assert!(peak(&pair).is_ok());
    }
}
