//! From the scatter of the data to coefficients, derivatives and the onset: covariances, intervals, and the check that
//! they are reliable.
//!
//! Residuals of a wind-tunnel record are not white: the low-pass colours noise, turbulence and the support have spectra
//! of their own, and what the model cannot follow repeats in every period. A formula for independent residuals
//! is then wrong by the ratio of the spectra at the motion's frequency. Blocks of the record that are long against the
//! memory of the noise need no spectrum and no lag to be chosen (as Newey–West's estimator does), and at the ends of
//! segments motion and force come to rest, so that blocks do not leak into each other.
//! See [`CoefficientUncertainty::assumption`] for what is assumed in each case.
//!
//! | what | does | for |
//! |---|---|---|
//! | covariance, [`CoefficientUncertainty`] | sandwich of the residuals of independent blocks, and the scatter between mean speeds | every interval of a fit |
//! | delta method, [`OnsetError`] | carries it to the onset by the sensitivities of an eigenvalue | the interval that is printed |
//! | bootstrap, [`ResampledOnset`] | weighs the blocks anew, or draws parameters from the covariance, and solves every onset anew | the check of that interval |
//! | Monte Carlo, [`monte_carlo`] | draws the section as well, and counts | the probability of flutter below a design speed |
//! | [`coverage`] | repeats virtual campaigns whose truth is known | whether intervals hold it: they hold scatter, not bias |

mod coefficients;
mod columns;
mod columns_in_files;
mod coverage;
mod design;
mod draws;
mod family;
mod forms;
mod model;
pub mod monte_carlo;
mod of_data;
mod onset;
mod parameters;
mod record_covariance;
mod segments;
mod speed_groups;
mod speed_onsets;
mod speed_prior;
mod speed_scatter;
mod statistics;
mod table_covariance;

pub use coefficients::CoefficientUncertainty;
pub use coverage::{CoveragePlan, CoverageReport, IntervalCoverage, Truth, coverage};
pub use design::Design;
pub use draws::ModelDraws;
pub use family::{DeckOutcome, FamilyPlan, FamilyRange, FamilyReport, RangeCount, family_coverage};
pub use forms::{AdmissibleForm, FormEnsemble, FormOnset, FormSpread};
pub use model::{DerivativeInterval, ModelUncertainty, interval_with_forms};
pub use of_data::ModelOfData;
pub use onset::{OnsetError, ResampledOnset, Resampling};
pub use parameters::{Coordinates, Parameter, SearchedPole};
pub use record_covariance::{discrete_uncertainty, record_uncertainty};
pub use speed_onsets::{Contradiction, SpeedOnset, SpeedOnsets, speed_onsets_by};
pub use speed_scatter::{ForceScatter, SpeedScatter};
pub use statistics::{SampledOnsets, StudentScale, sample_quantile};
pub use table_covariance::table_uncertainty;

#[cfg(test)]
mod tests;
