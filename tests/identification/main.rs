//! Fits under constraints.

#[path = "../common/fits.rs"]
mod fits;
#[path = "../common/matrix.rs"]
#[allow(dead_code)] // each room needs a part of it
mod matrix;

mod dissipative;
mod dissipative_fits;
mod moved_onsets;
