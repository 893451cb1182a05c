//! Metrics of amplitude without regard to frequency: peak, RMS, magnitude as it is and after dynamic time warping.

use super::{Metric, SignalPair, exponential, warping_path};
use crate::error::Result;
use crate::signal::largest_magnitude;
use serde::Serialize;

/// One level of each signal, in the unit of the signals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LevelDetails {
    /// Level of the reference.
    pub reference: f64,
    /// Level of the compared signal.
    pub compared: f64,
}

/// A distance and what it is relative to: Euclidean norms in the unit of the signals, of wavelet coefficients those over
/// all inside the cone of influence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DistanceDetails {
    /// `‖X₁ − X₂‖₂`, of wavelets `‖|W₁| − |W₂|‖_F`.
    pub distance: f64,
    /// `‖X₁‖₂`.
    pub reference_norm: f64,
}

/// Peak metric `M_p = exp(−|P₁ − P₂|/P₁)`, `P = max|X|`.
///
/// # Errors
/// [`crate::Error::Input`] if the reference is zero throughout.
pub fn peak(pair: &SignalPair<'_>) -> Result<Metric<LevelDetails>> {
    let [reference, compared] = [pair.reference, pair.compared].map(largest_magnitude);
    levels(reference, compared)
}

/// RMS metric `M_rms = exp(−|rms₁ − rms₂|/rms₁)`; means are not removed.
///
/// # Errors
/// [`crate::Error::Input`] if the reference is zero throughout, [`crate::Error::Numerical`] if a square overflows.
pub fn rms(pair: &SignalPair<'_>) -> Result<Metric<LevelDetails>> {
    let root_n = (pair.sample_count() as f64).sqrt();
    let level = |x: &[f64]| norm(x.iter().copied()) / root_n;
    levels(level(pair.reference), level(pair.compared))
}

/// Unwarped magnitude metric `M_muw = exp(−‖X₁ − X₂‖₂/‖X₁‖₂)`.
///
/// # Errors
/// [`crate::Error::Input`] if the reference is zero throughout, [`crate::Error::Numerical`] if a square overflows.
pub fn magnitude(pair: &SignalPair<'_>) -> Result<Metric<DistanceDetails>> {
    let compared = pair.compared.iter().copied();
    distance_metric(pair.reference.iter().copied().zip(compared))
}

/// `exp(−‖X₁ − X₂‖₂/‖X₁‖₂)` over the pairs `(X₁, X₂)` handed in.
pub(super) fn distance_metric(
    pairs: impl Iterator<Item = (f64, f64)> + Clone,
) -> Result<Metric<DistanceDetails>> {
    let distance = norm(pairs.clone().map(|(a, b)| a - b));
    relative_distance(distance, norm(pairs.map(|(a, _)| a)))
}

/// `exp(−distance/reference_norm)`.
pub(super) fn relative_distance(
    distance: f64,
    reference_norm: f64,
) -> Result<Metric<DistanceDetails>> {
    Ok(Metric {
        value: exponential(distance, reference_norm)?,
        details: DistanceDetails {
            distance,
            reference_norm,
        },
    })
}

/// The same as [`distance_metric`] over contents `≥ 0` that a signal may have none of: 1 where neither has any, 0 where one has.
pub(super) fn content_metric(
    pairs: impl Iterator<Item = (f64, f64)> + Clone,
) -> Result<Metric<DistanceDetails>> {
    let nothing = |value| Metric {
        value,
        details: DistanceDetails {
            distance: 0.0,
            reference_norm: 0.0,
        },
    };
    let all = || pairs.clone();
    match (all().any(|p| p.0 > 0.0), all().any(|p| p.1 > 0.0)) {
        (true, true) => distance_metric(pairs),
        (false, false) => Ok(nothing(1.0)),
        _ => Ok(nothing(0.0)),
    }
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

/// What [`magnitude_warped`] found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WarpingDetails {
    /// Norms of the warped signals.
    pub warped: DistanceDetails,
    /// Cost of the path, the sum of squared differences along it (unit of the signals squared).
    pub path_cost: f64,
    /// Number of cells of the path; that of the samples if nothing is warped.
    pub path_length: usize,
    /// Largest shift between matched samples.
    pub largest_shift_samples: usize,
    /// Whether the path touches the band, so that the metric may be lower than without one.
    pub band_binds: bool,
}

/// Warped magnitude metric `M_m = exp(−‖X₁ʷ − X₂ʷ‖₂/‖X₁ʷ‖₂)` of the signals stretched along the path of
/// [`warping_path`], which matches `X₂` (rows) to `X₁` (columns). `band_samples` is the largest shift allowed; without one the path is
/// the global optimum, as published.
///
/// The order in which ties are resolved enters the path length and so the last digits of `‖X₁ʷ‖₂`.
///
/// # Errors
/// [`crate::Error::Input`] if the reference is zero throughout, [`crate::Error::Numerical`] if the cost overflows.
pub fn magnitude_warped(
    pair: &SignalPair<'_>,
    band_samples: Option<usize>,
) -> Result<Metric<WarpingDetails>> {
    let path = warping_path(pair.compared, pair.reference, band_samples)?;
    let cells = path.cells.iter();
    let metric = distance_metric(cells.map(|&(i, j)| (pair.reference[j], pair.compared[i])))?;
    let shift = path.cells.iter().map(|&(i, j)| i.abs_diff(j)).max();
    Ok(Metric {
        value: metric.value,
        details: WarpingDetails {
            warped: metric.details,
            path_cost: path.distance,
            path_length: path.cells.len(),
            largest_shift_samples: shift.unwrap_or(0),
            band_binds: path.band_binds,
        },
    })
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

    #[test]
    fn warping_forgives_a_delay_and_keeps_the_cost() {
        let x1: Vec<f64> = (0..500).map(|k| (0.05 * k as f64).sin()).collect();
        let x2: Vec<f64> = (0..500).map(|k| (0.05 * (k as f64 - 6.0)).sin()).collect();
        let pair = SignalPair::new(&x1, &x2, 0.005).unwrap();
        let warped = magnitude_warped(&pair, None).unwrap();
        assert!(warped.value > magnitude(&pair).unwrap().value);
        // The distance along the path, summed here and in the recursion.
        assert_relative_eq!(
            warped.details.warped.distance.powi(2),
            warped.details.path_cost,
            max_relative = 1e-12
        );
        assert!(warped.details.path_length >= 500);
    }

    #[test]
    fn without_shift_the_metric_is_the_unwarped_one() {
        let x1 = [1.0, 2.0, 3.0, 4.0];
        let x2 = [1.1, 2.2, 3.3, 4.4];
        let pair = SignalPair::new(&x1, &x2, 1.0).unwrap();
        let warped = magnitude_warped(&pair, Some(0)).unwrap();
        assert_eq!(warped.value, magnitude(&pair).unwrap().value);
        assert!(warped.details.band_binds);
        assert_eq!(warped.details.largest_shift_samples, 0);
    }
}
