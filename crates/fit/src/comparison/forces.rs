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
mod tested_deck;

pub use decks::DecksComparison;
pub use decks::compare_decks;
pub use entries::{in_magnitude_band, in_phase_band};
pub use models::History;
pub use models::ModelsComparison;
pub use models::compare_models;
pub use options::CompareOptions;
pub use options::Scoring;
pub use options::THESIS_DECKS;
pub use score::ForceMetrics;
pub use score::Score;
pub use score::ScoreSummary;
pub use score::score_table;
pub use statements::Statement;

#[cfg(test)]
mod tests;
