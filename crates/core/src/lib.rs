//! What a deck, a force model and a structure are, and what their coupling does: the part of aerodeck that every other part sees.
//!
//! Every aerodynamic model is a transfer matrix `q̂(K) = G(K) r̂(K)` ([`aerodynamics`]) and, where it has one, a state-space
//! realisation. A structure is `(M, R, K)` ([`section`], [`bridge`]). Their coupling at a wind speed is one linear system
//! ([`aeroelastic`]), whose modes and onsets [`flutter`] finds and whose exact steps [`response`] takes. [`trained_model`] is what is
//! saved, in the [`json`] that says what it is.
#![deny(unsafe_code)]

// the macro in it is known to what stands below
#[macro_use]
pub mod threads;

pub mod aerodynamics;
pub mod aeroelastic;
pub mod bridge;
pub mod error;
pub mod flutter;
pub mod json;
pub mod response;
pub mod section;
pub mod state_space;
pub mod trained_model;
pub mod units;

pub use error::{Error, Result};
