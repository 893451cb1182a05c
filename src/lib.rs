//! Self-excited wind forces on bridge decks: models, coupling, flutter, FMU.
#![deny(unsafe_code, missing_docs)]

pub mod aerodynamics;
pub mod aeroelastic;
#[cfg(feature = "identification")]
pub mod benchmarks;
#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "identification")]
pub mod comparison;
pub mod error;
pub mod flutter;
pub mod fmu;
#[cfg(feature = "identification")]
pub mod identification;
#[cfg(feature = "report")]
pub mod report;
pub mod response;
pub mod section;
pub mod state_space;
#[cfg(feature = "cli")]
pub mod study;
pub mod trained_model;
pub mod units;
#[cfg(feature = "identification")]
pub mod wind_tunnel;

pub use error::{Error, Result};
