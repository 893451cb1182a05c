//! `aerodeck train`: the models of a study from its records and tables.

use super::stages::{RECORDS, Stages};
use super::text;
use super::vocabulary::{Answer, OutputDir, Progress, Result, StudyArgs};
use crate::flutter::UnwantedGrowth;
use crate::fmu::package::growth_of;
use crate::study::RecordSet;

/// Runs the command.
pub(crate) fn run(args: &StudyArgs, progress: &Progress) -> Result<Answer> {
    let study = args.read()?;
    let mut stages = Stages::new(study, OutputDir::new(&args.directory())?, progress)?;
    let (study, deck) = (&stages.study, &stages.deck);
    let records = match study.deck.records.is_empty() {
        true => RecordSet::in_folder(study, deck, &stages.out.target(RECORDS))?,
        false => RecordSet::measured(study)?,
    };
    let selection = stages.select(Some(&records))?;
    let trained = stages.train(Some(&records))?;
    let mut text = format!("{}\n{}\n", stages.study.name, stages.deck.description());
    text.push_str(&text::deck_warnings(&stages.deck));
    text.push_str(&text::selected(selection.as_ref()));
    let mut growths = Vec::new();
    for result in &trained {
        let name = &result.model.name;
        text.push_str(&text::fit(name, &result.report, &result.uncertainty));
        let growth = growth_of(&result.model);
        let stage = format!("scan for growth of {name}");
        if let Some(growth) = stages.attempt(stage, growth)? {
            text.push_str(&text::growth(name, &growth));
            let model = name.clone();
            growths.push(UnwantedGrowth { model, ..growth });
        }
    }
    text.push_str(&text::failures(&stages.failed));
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
    let value = serde_json::json!({
        "trained": fits, "selection": selection, "growth": growths, "failed": stages.failed,
        "warnings": stages.deck.warnings()
    });
    let passed = stages.failed.is_empty();
    Ok(stages.out.answer(text, value)?.passed_if(passed))
}
