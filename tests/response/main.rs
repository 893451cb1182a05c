//! Steps in time, at one wind speed and while it changes.

#[path = "../common/steppers.rs"]
mod steppers;

mod changing_wind;
mod quasi_steady;
mod stepping;
