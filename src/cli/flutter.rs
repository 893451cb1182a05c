//! `aerodeck flutter`: curves and onsets of the trained models of a study.

use super::{
    Answer, OutputDir, Progress, StudyArgs, headline, result_files, routes, select, stages, text,
};
use crate::error::Result;
use crate::flutter::OnsetMethod;
use crate::study::{
    Deck, FlutterStudy, KnownUncertainty, RouteTable, StageFailure, Study, attempt, route_table,
    saved_moved_onset, saved_uncertainty, section_evidence, state_route_intervals,
};
use crate::trained_model::TrainedModel;
use crate::verdict::{Evidence, Verdict};
use std::fmt::Write as _;
use std::path::Path;

/// Frequencies, damping and flutter onset of the trained models of a study (see `train`)
///
/// Example: aerodeck flutter study.toml --all
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct FlutterArgs {
    #[command(flatten)]
    study: StudyArgs,
    /// Every route side by side: eigenvalues, determinant, p-k iteration, quasi-steady limit, flat plate, Selberg and
    /// Rocard; with an onset card for each force model.
    #[arg(long)]
    all: bool,
}

/// Runs the command.
pub(crate) fn run(args: &FlutterArgs, progress: &Progress) -> Result<Answer> {
    let study = select::with_saved(args.study.read()?);
    let deck = Deck::load(&study)?;
    let directory = args.study.directory();
    let mut failed = Vec::new();
    let models = stages::read_models(&study, &deck, &directory, &mut failed)?;
    let known = models.iter().map(|m| saved_uncertainty(m, &directory));
    let known = known.collect::<Result<Vec<_>>>()?;
    let mut results = stages::flutter(&study, &deck, &models, &known, progress)?;
    let mut out = OutputDir::new(&directory)?;
    let verdict = verdict(
        &study, &deck, &results, &models, &known, &directory, &failed,
    )?;
    if args.all {
        let stage = progress.stage("onset by every route");
        let mut table = route_table(&study, &deck, &models)?;
        state_route_intervals(&mut table, &study, &models, &known)?;
        drop(stage);
        return all_routes(&study, &deck, table, &verdict, out, &failed);
    }
    let figure = result_files::flutter_figure(&study, &results, Some(&verdict), &mut out);
    attempt(&mut failed, "figure", figure)?;
    let curves = result_files::write_curves(&study, &results.curves, &mut out);
    attempt(&mut failed, "curves", curves)?;
    results.failed.splice(0..0, failed);
    let mut text = headline::text(&study.name, &verdict, &deck.warnings());
    let _ = writeln!(text, "{}", deck.description());
    text.push_str(&text::deck_warnings(&deck));
    text.push('\n');
    text.push_str(&text::found(&results));
    text.push_str(&text::failures(&results.failed));
    let value = serde_json::json!({
        "verdict": verdict, "flutter": results, "warnings": deck.warnings()
    });
    Ok(out
        .answer(text, value)?
        .passed_if(results.failed.is_empty())
        .with_outcome_of(&verdict))
}

/// What the models saved in a folder of results amount to.
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
    let place = models.iter().position(|m| m.name == *name);
    let own = place.map(|i| &models[i]);
    let with = own.and_then(|m| results.search_of(&m.name, OnsetMethod::Eigenvalues));
    let moved = own.zip(with).map_or(Ok(None), |(model, with)| {
        let (section, search) = (&study.section, study.speeds().search());
        saved_moved_onset(model, &[folder.to_owned()], section, &search, &with)
    })?;
    let failed = [failed, &results.failed].concat();
    let known = place.and_then(|i| known.get(i));
    Ok(Verdict::judge(&Evidence {
        constraints: moved,
        ..section_evidence(study, deck, results, own, known, &failed)
    }))
}

/// Every route in one table, with cards and a figure.
fn all_routes(
    study: &Study,
    deck: &Deck,
    mut table: RouteTable,
    verdict: &Verdict,
    mut out: OutputDir,
    failed: &[StageFailure],
) -> Result<Answer> {
    // a figure that cannot be drawn does not take the table with it
    if let Err(e) =
        result_files::routes_figure(study, &table.curves, &routes::marked(&table), &mut out)
    {
        table.left_out.push(format!("figure of all routes: {e}"));
    }
    let mut text = headline::text(&study.name, verdict, &deck.warnings());
    let _ = writeln!(text, "{}", deck.description());
    text.push_str(&text::deck_warnings(deck));
    text.push('\n');
    text.push_str(&routes::text(&table, study.speeds().searched_to_m_s));
    text.push_str(&text::failures(failed));
    let value = serde_json::json!({
        "verdict": verdict, "routes": table, "failed": failed, "warnings": deck.warnings()
    });
    Ok(out
        .answer(text, value)?
        .passed_if(failed.is_empty())
        .with_outcome_of(verdict))
}
