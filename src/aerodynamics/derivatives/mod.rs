//! Aerodynamic derivatives P*, H*, A*: what they are, tables of measured values, interpolation between them.
//!
//! `G_yy = K²(H4* + iH1*)`, `G_yθ = K²(H3* + iH2*)`, `G_θy = K²(A4* + iA1*)`, `G_θθ = K²(A3* + iA2*)`, likewise
//! `P*` and the pairs 5, 6 of `H*`, `A*` for sway (equation 1.17).

use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// One of the 18 aerodynamic derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[allow(missing_docs)] // the names are the documentation
pub enum Derivative {
    P1,
    P2,
    P3,
    P4,
    P5,
    P6,
    H1,
    H2,
    H3,
    H4,
    H5,
    H6,
    A1,
    A2,
    A3,
    A4,
    A5,
    A6,
}

/// Which part of `G/K²` a derivative is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Part {
    /// In phase with the displacement.
    Real,
    /// In phase with the velocity.
    Imaginary,
}

/// One measured number of the transfer matrix: the real or imaginary part of one entry at its own `K`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransferSample {
    /// Force (row of `G`).
    pub force: Dof,
    /// Motion (column of `G`).
    pub motion: Dof,
    /// Real or imaginary.
    pub part: Part,
    /// Reduced frequency of the test point.
    pub k: crate::units::ReducedFrequency,
    /// The value of that part of `G` (not of the derivative: `K²` times it).
    pub value: f64,
    /// Mean wind speed of the test point, m/s; `None` for a source without speeds.
    pub mean_speed_m_s: Option<f64>,
}
