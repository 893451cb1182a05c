//! What may be said: [`plausibility`] judges what is given, [`verdict`] whether a required wind speed is met by what was found.
//!
//! Nothing is computed here that a model, a search or a table does not say of itself.
#![deny(unsafe_code)]

use aerodeck_core::{
    aerodynamics, aeroelastic, bridge, error, flutter, section, trained_model, units,
};

pub mod plausibility;
pub mod verdict;
