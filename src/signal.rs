//! Operations on sampled signals that know nothing of bridges: filters, interpolation, correlation, harmonics.
//!
//! None of them moves a phase unasked: the low-pass runs forward and backward, interpolation is that of Lagrange, derivatives
//! are those of fitted harmonics.

mod butterworth;
mod correlation;
mod delay;
mod fourier;
mod harmonics;
mod resample;
mod samples;

pub use butterworth::ButterworthLowPass;
pub(crate) use correlation::CrossCorrelation;
pub(crate) use delay::delay;
pub(crate) use fourier::Fourier;
pub use harmonics::Plateau;
pub(crate) use harmonics::{HarmonicFit, fit_harmonics, fit_sine, plateau, refine_frequency};
pub(crate) use resample::{delayed, resampled};
pub(crate) use samples::{
    clipped_stretches, extremes, largest_about_mean, mean, mean_and_deviation, random_stream,
    robust_deviation,
};
pub use samples::{median, rate};
