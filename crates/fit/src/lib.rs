//! From records and tables to models, and how well they are known: fits ([`identification`]), intervals of derivatives and onsets
//! ([`uncertainty`]), one of many models ([`selection`]), how alike two time histories are ([`comparison`]).
#![deny(unsafe_code)]

use aerodeck_core::{
    aerodynamics, aeroelastic, error, flutter, json, section, state_space, trained_model, units,
};
use aerodeck_judgement::{plausibility, verdict};
use aerodeck_lab::{files, wind_tunnel};
use aerodeck_signal::signal;
use error::Error;

pub mod comparison;
pub mod identification;
pub mod numbered;
pub mod selection;
pub mod uncertainty;
