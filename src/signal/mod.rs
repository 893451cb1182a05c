//! Operations on sampled signals that know nothing of bridges: filters, interpolation, correlation, harmonics.
//!
//! None of them moves a phase unasked: the low-pass runs forward and backward, interpolation is that of Lagrange, derivatives
//! are those of fitted harmonics.

mod butterworth;
mod correlation;
mod delay;
mod harmonics;
mod resample;
mod samples;

pub use butterworth::ButterworthLowPass;
pub use correlation::CrossCorrelation;
pub use delay::{Delay, delay};
pub use harmonics::{HarmonicFit, Plateau, fit_harmonics, fit_sine, plateau, refine_frequency};
pub use resample::{delayed, resampled, value_at};
pub use samples::{clipped_stretches, median, rate, robust_deviation};
