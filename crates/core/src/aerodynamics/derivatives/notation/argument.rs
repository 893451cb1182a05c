//! What a table is tabulated over: one of the four numbers with two names.

use crate::units::{ReducedFrequency, ReducedVelocity};
use serde::{Deserialize, Serialize};

/// Reduced velocity or reduced frequency of a test point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Argument {
    /// `V̂ = V/(ωB)`, as in the NTNU workbooks. The crate's own.
    #[default]
    VHat,
    /// `V* = V/(fB)`.
    VStar,
    /// `K = ωB/V`, full width.
    KFull,
    /// `k = ωb/V`, semi-chord `b = B/2`.
    KSemi,
}

impl Argument {
    /// All arguments.
    pub const ALL: [Self; 4] = [Self::VHat, Self::VStar, Self::KFull, Self::KSemi];

    /// The word for it in commands and studies, and the name of its column.
    pub fn name(self) -> &'static str {
        match self {
            Self::VHat => "v_hat",
            Self::VStar => "v_star",
            Self::KFull => "k_full",
            Self::KSemi => "k_semi",
        }
    }

    /// Name with definition, as it stands in the header of files.
    pub fn definition(self) -> &'static str {
        match self {
            Self::VHat => "v_hat = V/(omega B)",
            Self::VStar => "v_star = V/(f B)",
            Self::KFull => "k_full = omega B/V",
            Self::KSemi => "k_semi = omega b/V, b = B/2",
        }
    }

    /// Its value where the reduced velocity is `V̂`; `V̂` itself is kept bit for bit.
    pub fn at_v_hat(self, v_hat: f64) -> f64 {
        let k = ReducedFrequency::from_v_hat(v_hat);
        match self {
            Self::VHat => v_hat,
            Self::VStar => ReducedVelocity::from(k).v_star(),
            Self::KFull => k.full_width(),
            Self::KSemi => k.semi_chord(),
        }
    }

    /// The reduced velocity `V̂` at which it has this value.
    pub fn to_v_hat(self, value: f64) -> f64 {
        match self {
            Self::VHat => value,
            Self::VStar => ReducedFrequency::from(ReducedVelocity::new(value)).v_hat(),
            Self::KFull => ReducedFrequency::from_full_width(value).v_hat(),
            Self::KSemi => ReducedFrequency::from_semi_chord(value).v_hat(),
        }
    }
}

read_by_name!(
    /// Reads the word, alone or with its definition.
    Argument,
    "argument",
    |text: &str| Self::ALL.into_iter().find(|a| a.name() == text || a.definition() == text),
    format!("one of {}", Self::ALL.map(Self::definition).join("; "))
);
