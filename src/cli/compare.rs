//! `aerodeck compare`: the thesis's comparisons on the embedded decks, and any two time histories.

mod common;
mod decks;
mod models;
mod signals;

use super::vocabulary::{Answer, PageSection, Progress, Result};
use crate::comparison::forces::THESIS_DECKS;
use common::Common;

/// Predicted against measured forces: one model on several decks, several models on one, or two signals of a file
#[derive(clap::Subcommand)]
pub(crate) enum Compare {
    /// Several girders, a Laguerre model each: metrics of the predicted forces side by side (thesis, section 3.5.4)
    ///
    /// Example: aerodeck compare decks --out decks
    #[command(verbatim_doc_comment)]
    Decks {
        /// Embedded decks to compare.
        #[arg(
            long,
            value_delimiter = ',',
            default_value = THESIS_DECKS.join(",")
        )]
        decks: Vec<String>,
        /// Train on this deck only and predict the forces of all.
        #[arg(long)]
        trained_on: Option<String>,
        #[command(flatten)]
        common: Common,
    },
    /// Laguerre models against rational functions on one girder, in time and frequency (thesis, sections 3.5.5, 3.5.6)
    ///
    /// Example: aerodeck compare models --deck LN21-5200
    #[command(verbatim_doc_comment)]
    Models {
        /// Embedded deck.
        #[arg(long, default_value = "LN21-5200")]
        deck: String,
        #[command(flatten)]
        common: Common,
    },
    Signals(signals::CompareSignalsArgs),
}

/// Sections 3.5.4 to 3.5.6 of the thesis on rebuilt records: its sentences beside what is found, and the figures.
pub(super) fn thesis_comparisons(progress: &Progress) -> Result<[PageSection; 2]> {
    Ok([decks::section(progress)?, models::section(progress)?])
}

/// Runs the command.
pub(crate) fn run(command: &Compare, progress: &Progress) -> Result<Answer> {
    match command {
        Compare::Decks {
            decks,
            trained_on,
            common,
        } => {
            let options = common.options(decks.clone(), trained_on.clone());
            decks::run(&options, &common.out, progress)
        }
        Compare::Models { deck, common } => {
            let options = common.options(vec![deck.clone()], None);
            models::run(&options, &common.out, progress)
        }
        Compare::Signals(args) => signals::run(args, progress),
    }
}
