//! `aerodeck study`: the whole chain of a study file.

use super::answer::Answer;
use super::common::StudyArgs;
use super::output::{OutputDir, Written, list};
use super::progress::Progress;
use super::ran::{self, Ran};
use super::report::{self, REPORT, SUMMARY};
use super::summary::{FitSummary, Summary};
use super::{account, evidence, headline, measured_forces, select, stages};
use crate::error::{Error, Result};
use crate::flutter::Onset;
use crate::fmu::package::Growing;
use crate::study::{
    Deck, FITS, KnownUncertainty, RecordSet, StageFailure, Study, attempt, interval_of,
    stepped_onset, study_warnings,
};
use crate::trained_model::TrainedModel;
use std::path::PathBuf;

/// Run the whole chain of a study file: records, training, flutter, FMU, onset by stepping the FMU
///
/// Example: aerodeck study study.toml --out results
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Export a model that grows below its onset, at reduced frequencies that were not tested.
    #[arg(long)]
    allow_unstable: bool,
    /// Replace a study.toml in the folder of results that differs; without, this study stands beside it as study_as_run.toml.
    #[arg(long)]
    force: bool,
}

/// Runs the command.
pub(crate) fn run(args: &Args, progress: &Progress) -> Result<Answer> {
    let (study, text) = args.study.read_with_text()?;
    let mut out = OutputDir::new(&args.study.directory())?;
    if args.force {
        out.replace(ran::STUDY);
    }
    let ran = Ran {
        study: &study,
        text: &text,
        file: args.study.file(),
    };
    run_chain(&ran, out, stages::growing(args.allow_unstable), progress)
}

/// The whole chain into `out`. A stage that fails is reported in its place and leaves the others as they are; then the
/// answer did not pass.
pub(crate) fn run_chain(
    ran: &Ran<'_>,
    mut out: OutputDir,
    growing: Growing,
    progress: &Progress,
) -> Result<Answer> {
    let study = ran.study;
    let deck = Deck::load(study)?;
    let study_file = ran::leave(ran, &mut out)?;
    let mut failed = Vec::new();
    let records = records(study, &deck, &mut out, progress);
    let records_error = records.as_ref().err().map(ToString::to_string);
    let records = attempt(&mut failed, "records", records)?;
    let selected = match &records {
        Some(records) if study.select => {
            let selected = select::with_selected(study, records, progress);
            attempt(&mut failed, "selection", selected)?
        }
        _ => None,
    };
    let study = selected.as_ref().unwrap_or(study);
    let aside = (&mut out, &mut failed);
    let trained = stages::train(study, &deck, records.as_ref(), aside, progress)?;
    if let (true, Some(reason)) = (trained.is_empty(), records_error) {
        return Err(Error::Numerical(format!(
            "no model can be trained: {reason}"
        )));
    }
    let models: Vec<_> = trained.iter().map(|t| t.model.clone()).collect();
    let known: Vec<_> = trained.iter().map(|t| t.uncertainty.clone()).collect();
    let mut results = stages::flutter(study, &deck, &models, &known, progress)?;
    failed.append(&mut results.failed);
    let name = study.exported()?.name.clone();
    let exported = export(
        study,
        (&models, &known),
        (&mut out, &mut failed),
        growing,
        progress,
    )?;
    let mut stepped = None;
    if let Some((model, path)) = exported {
        let stage = progress.stage("stepping the FMU");
        let found = stepped_onset(model, &path, study.speeds().speed_max_m_s);
        drop(stage);
        stepped = attempt(&mut failed, "stepping the FMU", found)?
            .and_then(|answer| results.take_stepped(answer, &model.name));
        let own = models
            .iter()
            .zip(&known)
            .find(|(m, _)| m.name == model.name);
        if let (Some(stepped), Some((_, known))) = (&mut stepped, own) {
            let structure = study.section.structure()?;
            stepped.onset.interval = interval_of(&structure, model, known, &stepped.onset);
        }
    }
    let further = stepped.iter().map(|s| s.onset.clone());
    let (further, open): (Vec<Onset>, Vec<Onset>) = further.partition(|o| o.headline_m_s().is_ok());
    results.undetermined.extend(open);
    let figure = stages::flutter_figure(study, &results, &further, &mut out);
    attempt(&mut failed, "figure", figure)?;
    let derivatives = evidence::write_derivatives(study, &deck, &trained, &mut out);
    attempt(&mut failed, "figure of derivatives", derivatives)?;
    let curves = evidence::write_curves(study, &results.curves, &mut out);
    attempt(&mut failed, "curves", curves)?;
    results.onsets.extend(further);
    let exported = models.iter().find(|m| m.name == name);
    if let (Some(model), Some(at)) = (exported, headline::own_onset(&results, &name)) {
        let at = (at.at.speed_m_s, at.at.frequency_hz);
        if let Some(records) = &records {
            let forces = measured_forces::write(model, records, at, &mut out);
            attempt(&mut failed, "figure of measured forces", forces)?;
        }
        let response = evidence::write_response(model, at, &mut out);
        attempt(&mut failed, "figure of the motion", response)?;
    }
    let answer = headline::answer(study, &results, &name);
    let limits = headline::limits(&deck, &results, &name, &failed);
    let comparisons = headline::comparisons(&results, stepped.as_ref(), &name);
    out.stage(REPORT)?;
    let summary_file = out.target(SUMMARY);
    let staged_summary = out.stage(SUMMARY)?;
    let mut summary = Summary {
        answer,
        limits,
        comparisons,
        study_file,
        generator: format!("aerodeck {}", env!("CARGO_PKG_VERSION")),
        study: study.name.clone(),
        deck: deck.description(),
        warnings: [deck.warnings(), study_warnings(study)].concat(),
        licence: deck.licence(),
        speeds: study.speeds(),
        onsets: results.onsets,
        undetermined: results.undetermined,
        unstable: results.unstable,
        stable: results.stable,
        growth: results.growth,
        divergence: results.divergence,
        deviations: results.deviations,
        fits: trained.into_iter().map(FitSummary::from).collect(),
        stepped,
        failed,
        files: out.targets(),
    };
    summary.files.sort();
    let json = serde_json::to_string_pretty(&summary)
        .map_err(|e| crate::Error::Numerical(e.to_string()))?;
    std::fs::write(&staged_summary, json + "\n").map_err(|e| crate::Error::io(&summary_file, e))?;
    let page = report::page(out.staging(), &out.target(""))?;
    out.write(REPORT, page)?;
    let written = out.commit()?;
    let answer = Answer::new(
        account::chain(
            study,
            &deck,
            &summary,
            (&shown(&written), progress.verbose()),
        ),
        &summary,
    )?;
    Ok(answer.with_verdict(summary.failed.is_empty()))
}

/// The records of the study: measured, or those of the virtual tunnel.
fn records(
    study: &Study,
    deck: &Deck,
    out: &mut OutputDir,
    progress: &Progress,
) -> Result<RecordSet> {
    if study.deck.records.is_empty() {
        RecordSet::staged(stages::tunnel(study, deck, out, progress)?)
    } else {
        RecordSet::measured(study)
    }
}

/// Packs the model that the study exports; it with the place of its FMU.
fn export<'a>(
    study: &Study,
    (models, known): (&'a [TrainedModel], &[KnownUncertainty]),
    (out, failed): (&mut OutputDir, &mut Vec<StageFailure>),
    growing: Growing,
    progress: &Progress,
) -> Result<Option<(&'a TrainedModel, PathBuf)>> {
    let name = &study.exported()?.name;
    let Some((model, known)) = models.iter().zip(known).find(|(m, _)| m.name == *name) else {
        let reason = format!("{name} was not trained");
        failed.push(StageFailure::new("export", reason));
        return Ok(None);
    };
    let bytes = stages::export((model, known), study, growing, progress);
    let Some(bytes) = attempt(failed, "export", bytes)? else {
        return Ok(None);
    };
    out.write(stages::FMU_FILE, bytes)?;
    Ok(Some((model, out.stage(stages::FMU_FILE)?)))
}

/// The files a reader looks for; records, models and fits are named by their folder.
fn shown(written: &[Written]) -> String {
    let top: Vec<Written> = written
        .iter()
        .filter(|w| {
            !w.path.parent().is_some_and(|p| {
                [stages::RECORDS, stages::MODELS, FITS]
                    .iter()
                    .any(|folder| p.ends_with(folder))
            })
        })
        .cloned()
        .collect();
    list(&top)
}
