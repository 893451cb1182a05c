//! Quasi-steady theory: forces from static coefficients and the relative wind (1.1)–(1.7), and its linearisation
//! about a rotation (1.11)–(1.13, appendix A), with the corrections listed in `docs/quasi_steady.md`.
//!
//! The flow that a force component sees is that at a reference point at the distance `B₁` upwind of the axis; with
//! `B₁ᵢ` of its own for each component the theory is the corrected quasi-steady one.

mod arms;
mod coefficients;
mod forces;
mod linear;
mod spline;

#[cfg(feature = "identification")]
mod csv_file;
#[cfg(feature = "identification")]
pub mod embedded;

pub use arms::Arms;
pub use coefficients::{
    CoefficientRow, CoefficientsAt, CoefficientsHeader, StaticCoefficients, TABLE_SIGN_CONVENTION,
    TABLE_UNITS,
};
#[cfg(feature = "identification")]
pub use csv_file::{
    COEFFICIENT_COLUMNS, parse_coefficients, read_coefficients, write_coefficients,
};
pub use forces::{QuasiSteady, RelativeWind};
pub use linear::LinearQuasiSteady;
