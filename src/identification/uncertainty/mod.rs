//! Covariance of fitted coefficients when residuals are correlated.
//!
//! Residuals of a wind-tunnel record are not white: the low-pass colours noise, turbulence and the support have spectra
//! of their own, and what the model cannot follow repeats in every period. A formula for independent residuals
//! is then wrong by the ratio of the spectra at the motion's frequency. Blocks of the record that are long against the
//! memory of the noise need no spectrum and no lag to be chosen (as Newey–West's estimator does), and at the ends of
//! segments motion and force come to rest, so that blocks do not leak into each other.
//! See [`CoefficientUncertainty::assumption`] for what is assumed in each case.

mod alone;
mod coefficients;
mod columns;
mod constraints;
mod design;
mod poles;
mod records;
mod segments;
mod speeds;
mod student;
mod table;

pub use coefficients::{CoefficientUncertainty, Coordinates, Parameter, SearchedPole};
pub use columns::LinearModel;
pub use poles::SEARCHED_POLES;
pub use records::{discrete_uncertainty, record_uncertainty};
pub use speeds::{ForceScatter, SpeedScatter};
pub use student::{incomplete_beta, two_sided_quantile};
pub use table::table_uncertainty;
