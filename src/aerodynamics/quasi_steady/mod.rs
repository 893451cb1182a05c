//! Quasi-steady theory: forces from static coefficients and the relative wind (1.1)–(1.7), and its linearisation
//! about a rotation (1.11)–(1.13, appendix A), with the corrections listed in `docs/quasi_steady.md`.
//!
//! The flow that a force component sees is that at a reference point at the distance `B₁` upwind of the axis; with
//! `B₁ᵢ` of its own for each component the theory is the corrected quasi-steady one.

mod arms;
pub(crate) mod coefficients;
mod forces;
mod linear;

pub use arms::Arms;
pub use coefficients::{CoefficientRow, CoefficientsAt, CoefficientsHeader, StaticCoefficients};
pub(crate) use coefficients::{TABLE_SIGN_CONVENTION, TABLE_UNITS};
pub use forces::QuasiSteady;
pub(crate) use forces::RelativeWind;
pub(crate) use linear::LinearQuasiSteady;
