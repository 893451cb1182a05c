//! `aerodeck study`: the whole chain of a study file.

use super::answer::Answer;
use super::common::StudyArgs;
use super::output::{OutputDir, Written, list};
use super::progress::Progress;
use super::{account, stages};
use crate::error::Result;
use crate::flutter::Onset;
use crate::identification::FitReport;
use crate::study::{
    Deck, Deviation, Divergence, KnownUncertainty, OnsetSummary, RecordSet, SteppedOnset, Study,
    interval_of, stepped_onset,
};
use serde::Serialize;
use std::path::PathBuf;

/// Run the whole chain of a study file: records, training, flutter, FMU, onset by stepping the FMU
///
/// Example: aerodeck study study.toml --out results
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
}

/// What `summary.json` holds.
#[derive(Serialize)]
pub struct Summary {
    /// Program and version.
    pub generator: String,
    /// Name of the study.
    pub study: String,
    /// What the aerodynamics come from.
    pub deck: String,
    /// Licence of the data.
    pub licence: String,
    /// All onsets found, one entry a model and method.
    pub onsets: Vec<Onset>,
    /// Searches that found none.
    pub stable: Vec<OnsetSummary>,
    /// Static divergence.
    pub divergence: Vec<Divergence>,
    /// Onsets against the deck's own.
    pub deviations: Vec<Deviation>,
    /// The fits in short.
    pub fits: Vec<FitSummary>,
    /// The FMU stepped through its C interface.
    pub stepped: Option<SteppedOnset>,
    /// Files written.
    pub files: Vec<PathBuf>,
}

/// A fit in short.
#[derive(Serialize)]
pub struct FitSummary {
    /// Name of the model.
    pub model: String,
    /// Full account.
    #[serde(flatten)]
    pub report: FitReport,
    /// Uncertainty, or why it is not known.
    pub uncertainty: KnownUncertainty,
}

/// Runs the command.
pub fn run(args: &Args, progress: &Progress) -> Result<Answer> {
    let study = args.study.read()?;
    let out = OutputDir::new(&args.study.directory())?;
    run_chain(&study, out, progress)
}

/// The whole chain into `out`.
pub fn run_chain(study: &Study, mut out: OutputDir, progress: &Progress) -> Result<Answer> {
    let deck = Deck::load(study)?;
    let records = if study.deck.records.is_empty() {
        RecordSet::staged(stages::tunnel(study, &deck, &mut out, progress)?)?
    } else {
        RecordSet::measured(study)?
    };
    let trained = stages::train(study, &deck, &records, &mut out, progress)?;
    let models: Vec<_> = trained.iter().map(|t| t.model.clone()).collect();
    let known: Vec<_> = trained.iter().map(|t| t.uncertainty.clone()).collect();
    let results = stages::flutter(study, &deck, &models, &known, progress)?;
    let exported = study.exported()?;
    let mut stepped = None;
    for model in models.iter().filter(|m| m.name == exported.name) {
        let bytes = stages::export(model, progress)?;
        let path = out.stage(stages::FMU_FILE)?;
        std::fs::write(&path, bytes).map_err(|e| crate::Error::io(&path, e))?;
        let stage = progress.stage("stepping the FMU");
        stepped = stepped_onset(model, &path, study.flutter.speed_max_m_s)?;
        drop(stage);
        let own = models
            .iter()
            .zip(&known)
            .find(|(m, _)| m.name == model.name);
        if let (Some(stepped), Some((_, known))) = (&mut stepped, own) {
            let structure = study.section.structure()?;
            stepped.onset.interval = interval_of(&structure, model, known, &stepped.onset);
        }
    }
    let further: Vec<Onset> = stepped.iter().map(|s| s.onset.clone()).collect();
    stages::flutter_figure(study, &results, &further, &mut out)?;
    let summary_file = out.target("summary.json");
    let staged_summary = out.stage("summary.json")?;
    let mut summary = Summary {
        generator: format!("aerodeck {}", env!("CARGO_PKG_VERSION")),
        study: study.name.clone(),
        deck: deck.description(),
        licence: deck.licence(),
        onsets: results.onsets.iter().chain(&further).cloned().collect(),
        stable: results.stable,
        divergence: results.divergence,
        deviations: results.deviations,
        fits: trained
            .into_iter()
            .map(|t| FitSummary {
                model: t.model.name,
                report: t.report,
                uncertainty: t.uncertainty,
            })
            .collect(),
        stepped,
        files: out.targets(),
    };
    summary.files.sort();
    let json = serde_json::to_string_pretty(&summary)
        .map_err(|e| crate::Error::Numerical(e.to_string()))?;
    std::fs::write(&staged_summary, json + "\n").map_err(|e| crate::Error::io(&summary_file, e))?;
    let written = out.commit()?;
    Answer::new(
        account::chain(study, &deck, &summary, &shown(&written)),
        &summary,
    )
}

/// The files a reader looks for; records, models and fits are named by their folder.
fn shown(written: &[Written]) -> String {
    let top: Vec<Written> = written
        .iter()
        .filter(|w| {
            !w.path.parent().is_some_and(|p| {
                [stages::RECORDS, stages::MODELS, stages::FITS]
                    .iter()
                    .any(|folder| p.ends_with(folder))
            })
        })
        .cloned()
        .collect();
    list(&top)
}
