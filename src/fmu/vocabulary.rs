//! The vocabulary of descriptions and archives.

pub(super) use aerodeck_fmu_host::xml::Element;
pub(super) use aerodeck_unit::bridge_gusts::{TURBULENCE_FILE, TurbulenceOptions};
pub(super) use aerodeck_unit::bridge_options::{BRIDGE_FILE, BridgeOptions};
pub(super) use aerodeck_unit::force_options::{FORCE_FILE, ForceOptions, MAX_STRIPS};
pub(super) use aerodeck_unit::groups::{Groups, array_of};
pub(super) use aerodeck_unit::identity::MODEL_IDENTIFIER;
pub(super) use aerodeck_unit::onset_bounds::{BOUNDS_FILE, OnsetBounds};
pub(super) use aerodeck_unit::resources::{GUST_FILE, OPTION_FILES, Resources};
pub(super) use aerodeck_unit::standard::{FmiTerm, FmiVersion, each_once};
pub(super) use aerodeck_unit::variables::{
    Causality, Dependency, DependencyKind, Response, Role, SectionParameter, StartValue, Variable,
    VariableTable,
};
