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
pub use correlation::CrossCorrelation;
pub use delay::delay;
pub use fourier::Fourier;
pub use harmonics::{HarmonicFit, Plateau, fit_harmonics, fit_sine, plateau, refine_frequency};
pub use resample::{delayed, resampled};
pub use rustfft::num_complex::Complex64;
pub use samples::{
    check_clipping, check_finite, clipped_stretches, extremes, largest_about_mean,
    largest_magnitude, mean, mean_and_deviation, median, random_stream, rate, robust_deviation,
    root_mean_square,
};
