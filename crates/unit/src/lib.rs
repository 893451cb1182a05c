//! The coupled section, its forces alone, or a whole bridge as a co-simulation slave: what an FMU holds. Variables ([`variables`]),
//! version-neutral life cycle ([`instance`], [`lifecycle`]), what is read at instantiation ([`resources`]), forces on strips
//! whose motion is prescribed ([`prescribed`]), and the C interfaces of FMI 2.0 and 3.0 ([`fmi2`], [`fmi3`]).
//!
//! `aerodeck-runtime` makes the shared library of an FMU of it.
#![deny(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::undocumented_unsafe_blocks))]

use aerodeck_core::{
    aerodynamics, aeroelastic, bridge, error, flutter, response, section, state_space,
    trained_model, units,
};
use error::Error;

pub mod bridge_gusts;
pub mod bridge_options;
#[allow(unsafe_code)]
pub mod fmi2;
#[allow(unsafe_code)]
pub mod fmi3;
pub mod force_options;
pub mod groups;
mod gust_channels;
pub mod identity;
pub mod instance;
pub mod lifecycle;
pub mod location;
pub mod log_categories;
pub mod onset_bounds;
pub mod onset_start;
pub mod prescribed;
pub mod refusal;
pub mod resources;
pub mod si;
pub mod standard;
pub mod variables;
