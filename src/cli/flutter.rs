//! `aerodeck flutter`: curves and onsets of the trained models of a study.

use super::vocabulary::{
    Answer, FlutterStudy, OnsetMethod, OutputDir, Progress, Result, Study, StudyArgs, TrainedModel,
    Verdict, attempt,
};
use super::{headline, result_files, routes, select, stages, text};
use crate::study::{
    Deck, KnownUncertainty, StageFailure, route_table, saved_moved_onset, saved_uncertainty,
    section_evidence, state_route_intervals,
};
use crate::verdict::Evidence;
use std::fmt::Write as _;
use std::path::Path;

/// Runs the command.
pub(crate) fn run(args: &StudyArgs, all: bool, progress: &Progress) -> Result<Answer> {
    let study = select::with_saved(args.read()?);
    let deck = Deck::load(&study)?;
    let directory = args.directory();
    let mut failed = Vec::new();
    let models = stages::read_models(&study, &deck, &directory, &mut failed)?;
    let known = models.iter().map(|m| saved_uncertainty(m, &directory));
    let known = known.collect::<Result<Vec<_>>>()?;
    let mut results = stages::flutter(&study, &deck, &models, &known, progress)?;
    let mut out = OutputDir::new(&directory)?;
    let verdict = verdict(
        &study, &deck, &results, &models, &known, &directory, &failed,
    )?;
    let mut text = headline::text(&study.name, &verdict, &deck.warnings());
    let _ = writeln!(text, "{}", deck.description());
    text.push_str(&text::deck_warnings(&deck));
    text.push('\n');
    let mut value = serde_json::json!({ "verdict": verdict, "warnings": deck.warnings() });
    if all {
        let stage = progress.stage("onset by every route");
        let mut table = route_table(&study, &deck, &models)?;
        state_route_intervals(&mut table, &study, &models, &known)?;
        drop(stage);
        let marked = routes::marked(&table);
        // a figure that cannot be drawn does not take the table with it
        if let Err(e) = result_files::routes_figure(&study, &table.curves, &marked, &mut out) {
            table.left_out.push(format!("figure of all routes: {e}"));
        }
        text.push_str(&routes::text(&table, study.speeds().searched_to_m_s));
        value["routes"] = serde_json::json!(table);
        value["failed"] = serde_json::json!(failed);
    } else {
        let figure = result_files::flutter_figure(&study, &results, Some(&verdict), &mut out);
        attempt(&mut failed, "figure", figure)?;
        let curves = result_files::write_curves(&study, &results.curves, &mut out);
        attempt(&mut failed, "curves", curves)?;
        results.failed.splice(0..0, failed);
        text.push_str(&text::found(&results));
        value["flutter"] = serde_json::json!(results);
        failed = results.failed;
    }
    text.push_str(&text::failures(&failed));
    Ok(out
        .answer(text, value)?
        .passed_if(failed.is_empty())
        .with_outcome_of(&verdict))
}

fn verdict(
    study: &Study,
    deck: &Deck,
    results: &FlutterStudy,
    models: &[TrainedModel],
    known: &[KnownUncertainty],
    folder: &Path,
    failed: &[StageFailure],
) -> Result<Verdict> {
    let name = &study.exported()?.name;
    let mut all = models.iter().zip(known);
    let (own, known) = all.find(|(m, _)| m.name == *name).unzip();
    let with = own.and_then(|m| results.search_of(&m.name, OnsetMethod::Eigenvalues));
    let moved = own.zip(with).map_or(Ok(None), |(model, with)| {
        let (section, search) = (&study.section, study.speeds().search());
        saved_moved_onset(model, &[folder.to_owned()], section, &search, &with)
    })?;
    let failed = [failed, &results.failed].concat();
    Ok(Verdict::judge(&Evidence {
        constraints: moved,
        ..section_evidence(study, deck, results, own, known, &failed)
    }))
}
