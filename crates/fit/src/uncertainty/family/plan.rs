//! How many decks, drawn from which seed.

use serde::{Deserialize, Serialize};

/// A family of decks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FamilyPlan {
    /// Number of decks; ranges and numbers of motions take turns.
    pub decks: usize,
    /// Seed of the first deck; each has its own.
    pub seed: u64,
    /// Whether transfer functions scatter between mean speeds as those of measured decks do.
    pub speeds_scatter: bool,
}

impl Default for FamilyPlan {
    fn default() -> Self {
        Self {
            decks: 400,
            seed: 1,
            speeds_scatter: true,
        }
    }
}
