//! How alike two time histories are: metrics between 0 and 1, 1 for equal signals.
//!
//! Definitions of Kavrakov, Kareem and Morgenthal, "Comparison metrics for time-histories: application to
//! bridge aerodynamics", J. Eng. Mech. 146(9) 04020093, 2020, for a reference `X₁` and a compared signal `X₂`:
//!
//! | function | metric | sees |
//! |---|---|---|
//! | [`phase`] | `M_φ` | mean delay |
//! | [`peak`] | `M_p` | largest absolute value |
//! | [`rms`] | `M_rms` | mean power |
//! | [`magnitude`] | `M_muw` | sample by sample difference |
//! | [`magnitude_warped`] | `M_m` | the same after dynamic time warping |
//! | [`wavelet`], [`wavelet_normalised`] | `M_w`, `M_wf` | amplitude over time and frequency |
//! | [`probability_density`] | `M_pdf` | distribution of values |
//! | [`stationarity`] | `M_s` | non-stationary content |
//! | [`bicoherence`] | `M_b` | quadratic coupling of frequencies |
//!
//! Metrics are functions of a [`SignalPair`] and of a parameter struct with documented defaults; they return
//! the value with the quantities it was made from ([`Metric`]). They know nothing of bridges; [`forces`] applies them to the
//! forces that models predict for the records of a deck.

mod amplitude;
mod bicoherence;
mod density;
mod dtw;
pub mod forces;
mod gamma;
mod kde;
mod morlet;
mod pair;
mod phase;
mod stationarity;
mod surrogates;
mod warping;
mod wavelet;

pub use amplitude::{DistanceDetails, LevelDetails, magnitude, peak, rms};
pub use bicoherence::{BicoherenceDetails, BicoherenceParameters, Coupling, bicoherence};
pub use density::{DensityDetails, DensityParameters, probability_density};
pub use dtw::{WarpingPath, warping_path};
pub use morlet::WaveletParameters;
pub use pair::SignalPair;
pub use phase::{LagEstimate, PhaseDetails, PhaseParameters, phase};
pub use stationarity::{
    StationarityDetails, StationarityParameters, StationarityTest, stationarity,
};
pub use warping::{WarpingDetails, WarpingParameters, magnitude_warped};
pub use wavelet::{NormalisedWaveletDetails, WaveletDetails, wavelet, wavelet_normalised};

use crate::error::{Error, Result};
use serde::Serialize;

/// A metric and what it was made from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Metric<D> {
    /// The metric, 1 for equal signals, towards 0 for unlike ones.
    pub value: f64,
    /// The quantities behind it.
    pub details: D,
}

/// `exp(−|difference|/scale)`, the form of every metric of differences.
///
/// # Errors
/// [`Error::Input`] if the scale, a norm of the reference, is zero; [`Error::Numerical`] if a norm overflowed.
fn exponential(difference: f64, scale: f64) -> Result<f64> {
    if scale == 0.0 {
        return Err(zero_signal("reference signal"));
    }
    if !(difference.is_finite() && scale.is_finite()) {
        return Err(Error::Numerical(format!(
            "a norm of the compared signals is too large for double precision: difference {difference}, reference {scale}"
        )));
    }
    Ok((-difference.abs() / scale).exp())
}

fn zero_signal(place: &str) -> Error {
    Error::input(place, "a signal that is not zero throughout", "only zeros")
}
