//! Time domain: records as dimensionless slices, regressors, and their accumulation.

pub(crate) mod accumulate;
pub(crate) mod discrete_columns;
pub(crate) mod filters;
pub(crate) mod layout;
mod motion_start;
pub(crate) mod search;
pub(crate) mod selection;
pub(crate) mod slices;
mod spectrum;
pub(crate) mod stretches;
