//! From records and tables to models, and how well they are known: fits ([`identification`]), intervals of derivatives and onsets
//! ([`uncertainty`]), one of many models ([`selection`]), how alike two time histories are ([`comparison`]).
// what is public can be reached from outside
#![deny(unsafe_code, missing_docs, unreachable_pub)]
// the process is the caller's: no abrupt end, and no word on its terminal
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::todo,
        clippy::unimplemented,
        clippy::unreachable,
        clippy::print_stdout,
        clippy::print_stderr,
        clippy::dbg_macro
    )
)]

use aerodeck_core::{
    aerodynamics, aeroelastic, error, flutter, section, state_space, trained_model, units,
};
use aerodeck_lab::{files, signal, wind_tunnel};
use error::Error;

pub mod comparison;
pub mod identification;
pub mod selection;
pub mod uncertainty;
