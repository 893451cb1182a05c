//! `aerodeck flutter`: curves and onsets of the trained models of a study.

use super::answer::Answer;
use super::common::StudyArgs;
use super::output::{OutputDir, list};
use super::progress::Progress;
use super::{account, stages};
use crate::error::Result;
use crate::study::Deck;

/// Frequencies, damping and flutter onset of the trained models of a study (see `train`)
///
/// Example: aerodeck flutter study.toml
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
    let models = stages::read_models(&study, &directory)?;
    let known = stages::read_uncertainties(&study, &directory)?;
    let results = stages::flutter(&study, &deck, &models, &known, progress)?;
    let mut out = OutputDir::new(&directory)?;
    stages::flutter_figure(&study, &results, &[], &mut out)?;
    let written = out.commit()?;
    let mut text = format!("{}\n{}\n\n", study.name, deck.description());
    text.push_str(&account::onsets(&results.onsets, &results.stable));
    text.push_str(&account::divergence(&results.divergence));
    text.push_str(&account::deviations(&results.deviations));
    text.push_str(&list(&written));
    Answer::new(
        text,
        &serde_json::json!({ "flutter": results, "files": written }),
    )
}
