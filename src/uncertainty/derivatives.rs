//! Aerodynamic derivatives of a fitted model with their intervals.

use super::coefficients::CoefficientUncertainty;
use super::onset::CONFIDENCE;
use super::student::two_sided_quantile;
use crate::aerodynamics::TransferMatrix;
use crate::aerodynamics::derivatives::{Derivative, Part};
use crate::error::Result;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use serde::{Deserialize, Serialize};

/// One derivative at one reduced frequency.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DerivativeInterval {
    /// Which one.
    pub derivative: Derivative,
    /// Reduced frequency `K = ωB/V`.
    pub k: f64,
    /// Value of the model.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// All derivatives of the model at the reduced frequencies `ks`.
pub(crate) fn derivative_intervals(
    estimate: &CoefficientUncertainty,
    ks: &[ReducedFrequency],
) -> Result<Vec<DerivativeInterval>> {
    let mut intervals = Vec::new();
    for (&k, (here, slopes)) in ks.iter().zip(estimate.transfer_slopes(ks)?) {
        for (i, &force) in estimate.dofs.iter().enumerate() {
            for (j, &motion) in estimate.dofs.iter().enumerate() {
                for part in [Part::Imaginary, Part::Real] {
                    let at = |g: &TransferMatrix| match part {
                        Part::Real => g[(i, j)].re,
                        Part::Imaginary => g[(i, j)].im,
                    } / k.full_width().powi(2);
                    let gradient: Vec<f64> = slopes.iter().map(at).collect();
                    let standard_error = estimate.standard_error(&gradient)?;
                    let nu = estimate
                        .degrees_of_freedom(&gradient)
                        .unwrap_or(f64::INFINITY);
                    let half = two_sided_quantile(CONFIDENCE, nu.min(1e6)) * standard_error;
                    let value = at(&here);
                    intervals.push(DerivativeInterval {
                        derivative: Derivative::of(force, motion, part),
                        k: k.full_width(),
                        value,
                        standard_error,
                        low: value - half,
                        high: value + half,
                    });
                }
            }
        }
    }
    Ok(intervals)
}

/// `points` reduced frequencies from one end of a range to the other, logarithmic.
pub(crate) fn spread_over(range: ReducedFrequencyRange, points: usize) -> Vec<ReducedFrequency> {
    let (low, high) = (range.min.full_width(), range.max.full_width());
    let last = points.max(2) as f64 - 1.0;
    (0..points)
        .map(|i| ReducedFrequency::from_full_width(low * (high / low).powf(i as f64 / last)))
        .collect()
}
