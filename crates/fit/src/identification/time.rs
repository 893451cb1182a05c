//! Time domain: dimensionless records, passes over them, the systems that a pass yields and the search of poles.

pub(crate) mod continuous;
pub(crate) mod driven;
pub(crate) mod filters;
pub(crate) mod fitted;
pub(crate) mod low_pass;
pub(crate) mod pass;
pub(crate) mod record;
pub(crate) mod search;
pub(crate) mod signals;
pub(crate) mod systems;
