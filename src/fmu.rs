//! FMUs: what they hold (the crate of the unit), their description, packing, and an importer.

pub mod description;
pub mod description_fmi3;
pub mod package;
pub mod ssp;
mod ssv;

pub use aerodeck_fmu_host as importer;
use aerodeck_fmu_host::xml;
pub use aerodeck_unit::{
    bridge_gusts, bridge_options, fmi2, fmi3, force_options, groups, identity, instance, lifecycle,
    location, log_categories, onset_bounds, onset_start, prescribed, refusal, resources, si,
    standard, variables,
};

// the vocabulary of descriptions and archives
use bridge_gusts::{TURBULENCE_FILE, TurbulenceOptions};
use bridge_options::{BRIDGE_FILE, BridgeOptions};
use force_options::{FORCE_FILE, ForceOptions, MAX_STRIPS};
use groups::{Groups, array_of};
use identity::MODEL_IDENTIFIER;
use onset_bounds::{BOUNDS_FILE, OnsetBounds};
use resources::{GUST_FILE, OptionFiles, Resources};
use standard::{FmiTerm, FmiVersion, each_once};
use variables::{
    Causality, Dependency, DependencyKind, Listing, Response, Role, SectionParameter, StartValue,
    Variable, VariableTable,
};
use xml::Element;
