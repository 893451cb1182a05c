//! The jobs of the entries, by what they are about.

pub(crate) mod bridge;
pub(crate) mod c_interface;
pub(crate) mod changes;
pub(crate) mod fits;
pub(crate) mod growth;
pub(crate) mod metrics;
pub(crate) mod models;
pub(crate) mod onset;
pub(crate) mod samples;
pub(crate) mod steps;
