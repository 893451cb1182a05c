//! The coupled section as a co-simulation slave: version-neutral instance, variables, resources, packing, importer.

#[allow(unsafe_code)]
pub mod fmi2;
