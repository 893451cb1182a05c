//! FMUs: what they hold (the crate of the unit), their description, packing, and an importer.

pub mod description;
pub mod description_fmi3;
pub mod package;
pub mod ssp;
mod ssv;
mod vocabulary;

pub use aerodeck_fmu_host as importer;
pub use aerodeck_unit::{
    bridge_gusts, bridge_options, fmi2, fmi3, force_options, groups, identity, instance, lifecycle,
    location, log_categories, onset_bounds, onset_start, prescribed, refusal, resources, si,
    standard, variables,
};
