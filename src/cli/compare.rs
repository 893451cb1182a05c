//! `aerodeck compare`: the thesis's comparisons on the embedded decks, and any two time histories.

mod common;
mod decks;
mod models;
mod signals;

use super::answer::Answer;
use super::progress::Progress;
use crate::error::Result;
use crate::report::PageSection;
use common::Common;
use std::path::PathBuf;

/// Predicted against measured forces: one model on several decks, several models on one, or two signals of a file
#[derive(clap::Subcommand)]
pub(crate) enum Compare {
    Decks(decks::CompareDecksArgs),
    Models(models::CompareModelsArgs),
    Signals(signals::CompareSignalsArgs),
}

/// Sections 3.5.4 to 3.5.6 of the thesis on rebuilt records: its sentences beside what is found, and the figures.
pub(super) fn thesis_comparisons(progress: &Progress) -> Result<[PageSection; 2]> {
    let common = Common {
        speed: 8.0,
        filters: 3,
        alpha: 0.6,
        lateral: false,
        noise: 0.0,
        seed: 1,
        significant_phase: 5.0,
        out: PathBuf::new(),
    };
    Ok([
        decks::section(&common, progress)?,
        models::section(&common, progress)?,
    ])
}

/// Runs the command.
pub(crate) fn run(command: &Compare, progress: &Progress) -> Result<Answer> {
    match command {
        Compare::Decks(args) => decks::run(args, progress),
        Compare::Models(args) => models::run(args, progress),
        Compare::Signals(args) => signals::run(args, progress),
    }
}
