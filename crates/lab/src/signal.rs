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
pub(crate) use delay::delay;
pub use fourier::Fourier;
pub use harmonics::Plateau;
pub use harmonics::plateau;
pub use harmonics::{HarmonicFit, fit_harmonics, fit_sine, refine_frequency};
pub(crate) use resample::delayed;
pub use resample::resampled;
pub use rustfft::num_complex::Complex64;
pub use samples::mean_and_deviation;
pub use samples::random_stream;
pub(crate) use samples::root_mean_square;
pub use samples::{
    check_clipping, check_finite, clipped_stretches, extremes, largest_about_mean,
    largest_magnitude, mean, robust_deviation,
};
pub use samples::{median, rate};
