//! Aerodynamic derivatives P*, H*, A*: what they are, tables of measured values, interpolation between them.
//!
//! `G_yy = K²(H4* + iH1*)`, `G_yθ = K²(H3* + iH2*)`, `G_θy = K²(A4* + iA1*)`, `G_θθ = K²(A3* + iA2*)`, likewise
//! `P*` and the pairs 5, 6 of `H*`, `A*` for sway (equation 1.17).

/// `Display` and `FromStr` of a type that has names: how the trimmed text is found among them, and what is expected where it is not.
macro_rules! read_by_name {
    ($(#[$text:meta])* $type:ty, $key:literal, $find:expr, $expected:expr) => {
        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $type {
            type Err = crate::error::Error;

            $(#[$text])*
            fn from_str(text: &str) -> crate::error::Result<Self> {
                let find = $find;
                find(text.trim()).ok_or_else(|| {
                    crate::error::Error::input($key, $expected, format!("`{text}`"))
                })
            }
        }
    };
}

mod derivative;
mod interpolated;
mod interpolation;
mod missing;
pub mod notation;
pub mod table;

pub use derivative::{Derivative, Part};
pub use interpolated::{Extrapolation, InterpolatedTable};
pub use interpolation::Interpolation;
pub use missing::Missing;
pub use table::{DerivativePoint, DerivativeTable, TableHeader};

use crate::section::Dof;

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
