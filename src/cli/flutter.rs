//! `aerodeck flutter`: curves and onsets of the trained models of a study.

use super::result_files::{flutter_figure, of_first_models, write_curves};
use super::stages::Stages;
use super::vocabulary::{
    Answer, FlutterStudy, OnsetMethod, OutputDir, Progress, Result, StudyArgs, TrainedModel,
    Verdict,
};
use super::{figures, headline, routes, select, text};
use crate::study::{
    KnownUncertainty, route_table, saved_moved_onset, saved_uncertainty, section_evidence,
    state_route_intervals,
};
use crate::verdict::Evidence;
use std::fmt::Write as _;

/// Runs the command.
pub(crate) fn run(args: &StudyArgs, all: bool, progress: &Progress) -> Result<Answer> {
    let study = select::with_saved(args.read()?);
    let directory = args.directory();
    let mut stages = Stages::new(study, OutputDir::new(&directory)?, progress)?;
    let models = stages.read_models()?;
    let known = models.iter().map(|m| saved_uncertainty(m, &directory));
    let known = known.collect::<Result<Vec<_>>>()?;
    let mut results = stages.flutter(&models, &known)?;
    let verdict = stages.saved_verdict(&results, &models, &known)?;
    let (study, deck) = (&stages.study, &stages.deck);
    let mut text = headline::text(&study.name, &verdict, &deck.warnings());
    let _ = writeln!(text, "{}", deck.description());
    text.push_str(&text::deck_warnings(deck));
    text.push('\n');
    let mut value = serde_json::json!({ "verdict": verdict, "warnings": deck.warnings() });
    if all {
        let stage = progress.stage("onset by every route");
        let mut table = route_table(study, deck, &models)?;
        state_route_intervals(&mut table, study, &models, &known)?;
        drop(stage);
        let marked = routes::marked(&table);
        let title = format!("{}: all routes", study.name);
        let draw = || of_first_models(&table.curves, &marked, &title, None);
        // a figure that cannot be drawn does not take the table with it
        if let Err(e) = figures::write("routes", &mut stages.out, draw) {
            table.left_out.push(format!("figure of all routes: {e}"));
        }
        text.push_str(&routes::text(&table, study.speeds().searched_to_m_s));
        value["routes"] = serde_json::json!(table);
        value["failed"] = serde_json::json!(stages.failed);
    } else {
        let figure = flutter_figure(study, &results, Some(&verdict), &mut stages.out);
        let curves = write_curves(study, &results.curves, &mut stages.out);
        stages.attempt("figure", figure)?;
        stages.attempt("curves", curves)?;
        results.failed.splice(0..0, stages.failed);
        text.push_str(&text::found(&results));
        value["flutter"] = serde_json::json!(results);
        stages.failed = results.failed;
    }
    text.push_str(&text::failures(&stages.failed));
    let answer = stages.out.answer(text, value)?;
    let answer = answer.passed_if(stages.failed.is_empty());
    Ok(answer.with_outcome_of(&verdict))
}

impl Stages<'_> {
    /// What the models that were read amount to.
    fn saved_verdict(
        &self,
        results: &FlutterStudy,
        models: &[TrainedModel],
        known: &[KnownUncertainty],
    ) -> Result<Verdict> {
        let (study, deck) = (&self.study, &self.deck);
        let name = &study.exported()?.name;
        let mut all = models.iter().zip(known);
        let (own, known) = all.find(|(m, _)| m.name == *name).unzip();
        let with = own.and_then(|m| results.search_of(&m.name, OnsetMethod::Eigenvalues));
        let moved = own.zip(with).map_or(Ok(None), |(model, with)| {
            let (section, search) = (&study.section, study.speeds().search());
            saved_moved_onset(model, &[self.out.target("")], section, &search, &with)
        })?;
        let failed = [&self.failed[..], &results.failed].concat();
        Ok(Verdict::judge(&Evidence {
            constraints: moved,
            ..section_evidence(study, deck, results, own, known, &failed)
        }))
    }
}
