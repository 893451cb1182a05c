//! From the scatter of the data to coefficients, derivatives and the onset: covariances, intervals, and the check that they
//! keep their word.
//!
//! Residuals of a wind-tunnel record are not white: the low-pass colours noise, turbulence and the support have spectra
//! of their own, and what the model cannot follow repeats in every period. A formula for independent residuals
//! is then wrong by the ratio of the spectra at the motion's frequency. Blocks of the record that are long against the
//! memory of the noise need no spectrum and no lag to be chosen (as Newey–West's estimator does), and at the ends of
//! segments motion and force come to rest, so that blocks do not leak into each other.
//! See [`CoefficientUncertainty::assumption`] for what is assumed in each case.
//!
//! The onset follows by two routes that check each other: the gradient of the onset speed by eigenvalue sensitivities
//! (`onset_error`, the interval that is printed), and onsets solved anew for resampled blocks or drawn coefficients
//! (`resample_onset`). Intervals hold scatter only; [`coverage`] shows bias beside it where the truth is known.

mod coefficients;
mod columns;
mod coverage;
mod derivatives;
mod design;
mod model;
mod onset;
mod parameters;
mod record_covariance;
mod scattered;
mod segments;
mod sensitivity;
mod speed_onsets;
mod speed_scatter;
mod student;
mod table_covariance;

pub use coefficients::CoefficientUncertainty;
pub use coverage::{CoveragePlan, CoverageReport, Share, Truth, coverage};
pub use derivatives::DerivativeInterval;
pub use model::ModelUncertainty;
pub use onset::{OnsetError, ResampledOnset, Resampling};
pub(crate) use parameters::SEARCHED_POLES;
pub use parameters::{Coordinates, Parameter, SearchedPole};
pub(crate) use record_covariance::discrete_uncertainty;
pub use record_covariance::record_uncertainty;
pub use speed_onsets::{Contradiction, SpeedOnset, SpeedOnsets};
pub use speed_scatter::{ForceScatter, SpeedScatter};
pub(crate) use student::incomplete_beta;
pub use table_covariance::table_uncertainty;

#[cfg(test)]
mod tests;
