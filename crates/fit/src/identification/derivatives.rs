//! Aerodynamic derivatives from forced-vibration records: least squares in the time domain (1.19–1.22).
//!
//! At a test point (a speed and a frequency) the steady parts of all runs are fitted together,
//!
//! ```text
//! q_i(t) = Σ_j [ Re G_ij r_j(t) + Im G_ij r_j'(t)/K ] + a_i + b_i t        G_ij = K² (real derivative + i imaginary one)
//! ```
//!
//! which is (1.14) without dimensions, for every force i and every motion j that some run of the point drives; constant and trend
//! belong to the run. A run that moves a little in a second degree of freedom is therefore no harm when that one has a run of its
//! own. The rate is not a difference of samples: whole periods of the motion are fitted by up to three harmonics, and motion and rate are
//! those of the fit, so that neither noise nor a one-sided difference turns the phase.
//!
//! # Standard errors
//!
//! Residuals are autocorrelated (filters, buffeting), so the white-noise formula `σ²(ZᵀZ)⁻¹` does not hold. For harmonic
//! regressors all that counts of the noise is its spectral density at the frequency of the motion (Grenander & Rosenblatt,
//! *Statistical Analysis of Stationary Time Series*, section 7.3):
//! `Cov = (ZᵀZ)⁻¹ [Σ_runs S_run(f) Z_runᵀZ_run] (ZᵀZ)⁻¹`, with `S(f)` the mean periodogram of the residual at the Fourier frequencies
//! next to `f`. What the alignment and the lag of the channels add is not in it.

mod regression;
mod result;
mod test_points;

pub use result::{DerivativeEstimate, DerivativeOptions, IdentifiedDerivatives};

use crate::error::{Error, Result};
use crate::wind_tunnel::RecordSource;

/// All derivatives that the harmonic segments of `records` determine.
///
/// # Errors
/// [`crate::Error::Input`] for records of different width or degrees of freedom, without segments or with samples that are
/// not finite, or without a force, for less than four samples in a period, and for test points at which the motions cannot be told apart.
pub fn identify_derivatives(
    records: &[&dyn RecordSource],
    options: &DerivativeOptions,
) -> Result<IdentifiedDerivatives> {
    options.validate()?;
    let none = || Error::input("records", "at least one", "none");
    let first = records.first().ok_or_else(none)?.header();
    let mut result = IdentifiedDerivatives {
        width_m: first.width_m,
        dofs: first.dofs.clone(),
        rotation_amplitude_deg: None,
        estimates: Vec::new(),
        warnings: Vec::new(),
    };
    let groups = test_points::collect(records, first, options, &mut result.warnings)?;
    result.rotation_amplitude_deg = test_points::rotation_amplitude_deg(&first.dofs, &groups);
    for group in &groups {
        regression::solve(&first.dofs, group, &mut result)?;
    }
    result.sort();
    Ok(result)
}

#[cfg(test)]
mod tests;
