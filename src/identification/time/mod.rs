//! Time domain: records as dimensionless slices, regressors, and their accumulation.

pub(crate) mod accumulate;
pub(crate) mod filters;
pub(crate) mod search;
pub(crate) mod slices;
pub(crate) mod stretches;
