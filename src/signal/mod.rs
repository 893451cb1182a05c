//! Operations on sampled signals that know nothing of bridges: filters, interpolation, correlation, harmonics.
//!
//! None of them moves a phase unasked: the low-pass runs forward and backward, interpolation is that of Lagrange, derivatives
//! are those of fitted harmonics.

mod butterworth;
mod clipping;
mod correlation;
mod delay;
mod differences;
mod harmonics;
mod lagrange;
mod resample;
mod robust;
mod zero_phase;

pub use butterworth::{ButterworthLowPass, Section};
pub use clipping::clipped_stretches;
pub use correlation::CrossCorrelation;
pub use delay::{Delay, delay};
pub use differences::{acceleration, rate};
pub use harmonics::{HarmonicFit, Plateau, fit_harmonics, fit_sine, plateau, refine_frequency};
pub use lagrange::{NODES, delayed, lagrange_weights, value_at};
pub use resample::resampled;
pub use robust::{median, robust_deviation};
