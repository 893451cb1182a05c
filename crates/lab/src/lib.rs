//! What laboratories and bridges are written down in, and what is done to it before a model is fitted: file formats ([`files`]),
//! campaigns, load cells and the virtual wind tunnel ([`wind_tunnel`]).
#![deny(unsafe_code)]

use aerodeck_core::{aerodynamics, bridge, error, json, section, units};
use aerodeck_judgement::plausibility;
use aerodeck_signal::signal;
use error::Error;

pub mod files;
pub mod wind_tunnel;
