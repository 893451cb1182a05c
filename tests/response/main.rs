//! Steps in time, at one wind speed and while it changes.

#[path = "../common/steppers.rs"]
mod steppers;

mod beside_a_structure;
mod changing_wind;
mod quasi_steady;
mod stepping;
