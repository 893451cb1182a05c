//! Steps in time, at one wind speed and while it changes.

#![cfg(feature = "cli")]

#[path = "../common/steppers.rs"]
mod steppers;

mod changing_wind;
mod beside_a_structure;
mod quasi_steady;
mod stepping;
