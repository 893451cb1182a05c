//! The response of sections and whole bridges to turbulence: [`buffeting`].
#![deny(unsafe_code)]

use aerodeck_core::{
    aerodynamics, aeroelastic, bridge, error, flutter, response, section, state_space, units,
};
use aerodeck_fit::numbered;
use aerodeck_signal::signal;

pub mod buffeting;
