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
mod morlet;
mod phase;
mod scalogram;
mod stationarity;
mod surrogates;
mod wavelet;

pub use amplitude::{
    DistanceDetails, LevelDetails, WarpingDetails, magnitude, magnitude_warped, peak, rms,
};
pub use bicoherence::{BicoherenceDetails, BicoherenceParameters, Coupling, bicoherence};
pub use density::{DensityDetails, probability_density};
pub use dtw::{WarpingPath, warping_path};
pub use morlet::WaveletParameters;
pub use phase::{PhaseDetails, PhaseParameters, phase};
pub use stationarity::{
    StationarityDetails, StationarityParameters, StationarityTest, stationarity,
};
pub use wavelet::{NormalisedWaveletDetails, wavelet, wavelet_normalised};

use crate::error::{Error, Result, counted, ensure, positive};
use crate::signal::check_finite;
use serde::Serialize;

/// A reference signal and the signal compared with it, sampled together.
///
/// Both have the same unit, which is free. If the length is odd the last sample of both is left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignalPair<'a> {
    reference: &'a [f64],
    compared: &'a [f64],
    time_step_s: f64,
}

impl<'a> SignalPair<'a> {
    /// `reference` (`X₁`) and `compared` (`X₂`), sampled every `time_step_s`.
    ///
    /// # Errors
    /// [`Error::Input`] for unequal lengths, fewer than two samples, a sample that is not finite (named),
    /// or a time step that is not positive.
    pub fn new(reference: &'a [f64], compared: &'a [f64], time_step_s: f64) -> Result<Self> {
        positive("time step of the compared signals, s", time_step_s)?;
        ensure(
            reference.len() == compared.len(),
            "compared signal",
            counted(reference.len(), "sample") + ", as in the reference",
            counted(compared.len(), "sample"),
        )?;
        let samples = counted(reference.len(), "sample");
        ensure(
            reference.len() >= 2,
            "reference signal",
            "at least 2 samples",
            samples,
        )?;
        check_finite("reference signal", 0, reference)?;
        check_finite("compared signal", 0, compared)?;
        let even = reference.len() & !1;
        Ok(Self {
            reference: &reference[..even],
            compared: &compared[..even],
            time_step_s,
        })
    }

    /// Time between samples, s.
    pub const fn time_step_s(&self) -> f64 {
        self.time_step_s
    }

    /// Number of samples used, even.
    pub const fn sample_count(&self) -> usize {
        self.reference.len()
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_length_loses_its_last_sample() {
        let x = [1.0, 2.0, 3.0];
        let pair = SignalPair::new(&x, &x, 0.1).unwrap();
        assert_eq!(pair.reference, &[1.0, 2.0]);
        assert_eq!(pair.sample_count(), 2);
    }

    #[test]
    fn unusable_signals_are_named() {
        let x = [1.0, 2.0, 3.0, 4.0];
        let message = |r: Result<SignalPair<'_>>| r.unwrap_err().to_string();
        assert_eq!(
            message(SignalPair::new(&x, &x[1..], 0.1)),
            "compared signal: expected 4 samples, as in the reference, found 3 samples"
        );
        assert_eq!(
            message(SignalPair::new(&x, &[0.0, 1.0, f64::NAN, 0.0], 0.1)),
            "compared signal, sample 2: expected a finite number, found NaN"
        );
        assert!(SignalPair::new(&x, &x, 0.0).is_err());
        assert!(SignalPair::new(&x[..1], &x[..1], 0.1).is_err());
    }
}
