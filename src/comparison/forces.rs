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

pub(crate) use decks::{DecksComparison, compare_decks};
pub(crate) use entries::{BandCheck, inside};
pub(crate) use models::{History, ModelsComparison, compare_models};
pub(crate) use options::{CompareOptions, OnRecords, Scoring, THESIS_DECKS};
pub(crate) use score::{ForceMetrics, Score, ScoreSummary, score_table};
pub(crate) use statements::Statement;

#[cfg(test)]
mod tests;
