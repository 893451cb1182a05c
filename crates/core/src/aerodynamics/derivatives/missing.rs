//! Tables without `H4*`, `A4*`: what stands in their place.

use serde::{Deserialize, Serialize};

/// What is taken for `H4*`, `A4*` when a table does not hold them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Missing {
    /// Zero: no force in phase with heave.
    #[default]
    Zero,
    /// `H4* = K H2*`, `A4* = K A2*`: heaving acts through the angle of attack `−ẏ/V` as rotation does (R. H. Scanlan,
    /// N. P. Jones, L. Singh, J. Wind Eng. Ind. Aerodyn. 69–71, 1997, 829), here without added mass.
    QuasiSteady,
}

impl Missing {
    /// The word for it in studies and commands.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::QuasiSteady => "quasi_steady",
        }
    }
}

read_by_name!(
    Missing,
    "missing",
    |text: &str| [Self::Zero, Self::QuasiSteady]
        .into_iter()
        .find(|m| m.name() == text),
    "zero or quasi_steady"
);
