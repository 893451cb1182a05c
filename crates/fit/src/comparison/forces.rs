//! The comparisons of chapter 3 of the thesis on the embedded decks: one model on several girders (section 3.5.4), and
//! several models on one girder (sections 3.5.5 and 3.5.6).
//!
//! The decks come as derivatives, so that the "measured" forces are those of the virtual tunnel at the test points: exactly
//! the measured derivatives, without the noise, drift and knocks of the thesis's records. What the metrics see here is the
//! model alone.

mod decks;
mod entries;
mod models;
mod options;
mod score;
mod statements;

pub use decks::{DecksComparison, compare_decks};
pub use entries::{PerModel, in_magnitude_band, in_phase_band};
pub use models::{History, ModelsComparison, compare_models};
pub use options::{CompareOptions, Scoring, THESIS_DECKS};
pub use score::{ForceMetrics, Score, ScoreSummary, score_table};
pub use statements::Statement;

#[cfg(test)]
mod tests;
