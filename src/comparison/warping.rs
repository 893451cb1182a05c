//! Magnitude after dynamic time warping.

use super::amplitude::{DistanceDetails, distance_metric};
use super::{Metric, SignalPair, warping_path};
use crate::error::Result;
use serde::Serialize;

/// Parameters of [`magnitude_warped`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct WarpingParameters {
    /// Largest shift allowed, samples; default none, the global optimum as published.
    pub band_samples: Option<usize>,
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
/// [`warping_path`], which matches `X₂` (rows) to `X₁` (columns).
///
/// The order in which ties are resolved enters the path length and so the last digits of `‖X₁ʷ‖₂`.
///
/// # Errors
/// [`crate::Error::Input`] if the reference is zero throughout, [`crate::Error::Numerical`] if the cost overflows.
pub fn magnitude_warped(
    pair: &SignalPair<'_>,
    parameters: &WarpingParameters,
) -> Result<Metric<WarpingDetails>> {
    let path = warping_path(pair.compared(), pair.reference(), parameters.band_samples)?;
    let matched = path
        .cells
        .iter()
        .map(|&(i, j)| (pair.reference()[j], pair.compared()[i]));
    let metric = distance_metric(matched)?;
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
    use crate::comparison::magnitude;
    use approx::assert_relative_eq;

    #[test]
    fn warping_forgives_a_delay_and_keeps_the_cost() {
        let x1: Vec<f64> = (0..500).map(|k| (0.05 * k as f64).sin()).collect();
        let x2: Vec<f64> = (0..500).map(|k| (0.05 * (k as f64 - 6.0)).sin()).collect();
        let pair = SignalPair::new(&x1, &x2, 0.005).unwrap();
        let warped = magnitude_warped(&pair, &WarpingParameters::default()).unwrap();
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
        let parameters = WarpingParameters {
            band_samples: Some(0),
        };
        let warped = magnitude_warped(&pair, &parameters).unwrap();
        assert_eq!(warped.value, magnitude(&pair).unwrap().value);
        assert!(warped.details.band_binds);
        assert_eq!(warped.details.largest_shift_samples, 0);
    }
}
