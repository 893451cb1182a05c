//! Steps in time, at one wind speed and while it changes.

#![cfg(feature = "cli")]

#[path = "../common/steppers.rs"]
mod steppers;

mod changing_wind;
mod stepping;
