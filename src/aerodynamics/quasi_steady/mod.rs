//! Quasi-steady theory: forces from static coefficients and the relative wind (1.1)–(1.7), and its linearisation
//! about a rotation (1.11)–(1.13, appendix A), with the corrections listed in `docs/quasi_steady.md`.
//!
//! The flow that a force component sees is that at a reference point at the distance `B₁` upwind of the axis; with
//! `B₁ᵢ` of its own for each component the theory is the corrected quasi-steady one.

mod arms;
mod coefficients;
mod forces;
mod linear;

#[cfg(feature = "cli")]
mod csv_file;
#[cfg(feature = "cli")]
pub mod embedded;

pub use arms::Arms;
pub use coefficients::{
    CoefficientRow, CoefficientsAt, CoefficientsHeader, StaticCoefficients, TABLE_SIGN_CONVENTION,
    TABLE_UNITS,
};
#[cfg(feature = "cli")]
pub use csv_file::{
    COEFFICIENT_COLUMNS, parse_coefficients, read_coefficients, write_coefficients,
};
pub use forces::{QuasiSteady, RelativeWind};
pub use linear::LinearQuasiSteady;

/// The static coefficients of that name: an embedded table, or a file (`.csv`) whose path is read against `directory`.
///
/// # Errors
/// Those of [`embedded::coefficients`] and [`read_coefficients`].
#[cfg(feature = "cli")]
pub fn named_coefficients(
    name: &str,
    directory: &std::path::Path,
) -> crate::Result<StaticCoefficients> {
    if name.to_lowercase().ends_with(".csv") {
        read_coefficients(directory.join(name))
    } else {
        embedded::coefficients(name)
    }
}
