//! What laboratories and bridges are written down in, and what is done to it before a model is fitted: file formats ([`files`]), sampled
//! signals ([`signal`]), campaigns, load cells and the virtual wind tunnel ([`wind_tunnel`]).
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

use aerodeck_core::{aerodynamics, bridge, error, plausibility, section, units};
use error::Error;

pub mod files;
pub mod signal;
pub mod wind_tunnel;
