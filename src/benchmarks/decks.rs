//! Measured decks on the section of Table 4.1.

use super::Case;

/// Figures about measured decks.
pub const CASES: &[Case] = &[];
