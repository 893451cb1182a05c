//! `aerodeck train`: the models of a study from its records and tables.

use super::answer::Answer;
use super::common::StudyArgs;
use super::output::{OutputDir, list};
use super::progress::Progress;
use super::{account, stages};
use crate::error::Result;
use crate::study::{Deck, RecordSet};

/// Train the models of a study from its records (see `tunnel`) and tables
///
/// Example: aerodeck train study.toml
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
}

/// Runs the command.
pub fn run(args: &Args, progress: &Progress) -> Result<Answer> {
    let study = args.study.read()?;
    let deck = Deck::load(&study)?;
    let directory = args.study.directory();
    let records = if study.deck.records.is_empty() {
        RecordSet::in_folder(&study, &directory.join(stages::RECORDS))?
    } else {
        RecordSet::measured(&study)?
    };
    let mut out = OutputDir::new(&directory)?;
    let trained = stages::train(&study, &deck, &records, &mut out, progress)?;
    let mut text = format!("{}\n{}\n", study.name, deck.description());
    for result in &trained {
        text.push_str(&account::fit(
            &result.model.name,
            &result.report,
            &result.uncertainty,
        ));
    }
    let written = out.commit()?;
    text.push_str(&list(&written));
    let fits: Vec<_> = trained
        .iter()
        .map(|t| {
            serde_json::json!({
                "model": t.model,
                "report": t.report,
                "uncertainty": t.uncertainty.as_ref().ok(),
            })
        })
        .collect();
    Answer::new(
        text,
        &serde_json::json!({ "trained": fits, "files": written }),
    )
}
