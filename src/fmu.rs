//! The coupled section, its forces alone, or a whole bridge as a co-simulation slave: version-neutral instance, variables, resources, packing, importer.

pub mod bridge_gusts;
pub mod bridge_options;
#[cfg(feature = "cli")]
pub mod description;
#[cfg(feature = "cli")]
pub mod description_fmi3;
#[allow(unsafe_code)]
pub mod fmi2;
#[allow(unsafe_code)]
pub mod fmi3;
pub mod force_options;
pub mod groups;
pub mod identity;
#[cfg(feature = "cli")]
#[allow(unsafe_code)]
pub mod importer;
pub mod instance;
pub mod lifecycle;
pub mod location;
pub mod log_categories;
pub mod onset_bounds;
pub mod onset_start;
#[cfg(feature = "cli")]
pub mod package;
pub mod refusal;
pub mod resources;
pub mod si;
pub mod standard;
pub mod variables;
#[cfg(feature = "cli")]
mod xml;
