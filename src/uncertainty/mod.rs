//! From the scatter of the data to the derivatives and the onset: intervals, and the check that they keep their word.
//!
//! The covariance of the coefficients is that of [`crate::identification::CoefficientUncertainty`]. The onset follows
//! by two routes that check each other: the gradient of the onset speed by eigenvalue sensitivities ([`onset_error`],
//! the interval that is printed), and onsets solved anew for resampled blocks or drawn coefficients
//! ([`resample_onset`]). Intervals hold scatter only; [`coverage`] shows bias beside it where the truth is known.

mod coverage;
mod derivatives;
mod model;
mod onset;
mod scattered;
mod sensitivity;
mod speeds;

pub use coverage::{CoveragePlan, CoverageReport, Share, Truth, coverage};
pub use derivatives::{DerivativeInterval, derivative_intervals, spread_over};
pub use model::ModelUncertainty;
pub use onset::{
    CONFIDENCE, OnsetError, ResampledOnset, Resampling, ResamplingPlan, onset_error, resample_onset,
};
pub use sensitivity::onset_gradient;
pub use speeds::{Contradiction, SpeedOnset, SpeedOnsets, speed_onsets};

#[cfg(test)]
mod tests;
