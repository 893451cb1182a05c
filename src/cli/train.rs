//! `aerodeck train`: the models of a study from its records and tables.

use super::vocabulary::{Answer, OutputDir, Progress, Result, StudyArgs, attempt};
use super::{select, stages, text};
use crate::fmu::package::growth_of;
use crate::study::{Deck, ModelGrowth, RecordSet};

/// Runs the command.
pub(crate) fn run(args: &StudyArgs, progress: &Progress) -> Result<Answer> {
    let mut study = args.read()?;
    let deck = Deck::load(&study)?;
    let directory = args.directory();
    let records = if study.deck.records.is_empty() {
        RecordSet::in_folder(&study, &deck, &directory.join(stages::RECORDS))?
    } else {
        RecordSet::measured(&study)?
    };
    let mut out = OutputDir::new(&directory)?;
    let (mut failed, mut selection) = (Vec::new(), None);
    if study.select {
        let selected = select::with_selected(&study, &deck, &records, progress);
        match attempt(&mut failed, "selection", selected)? {
            Some(selected) => (study, selection) = selected,
            // that of an earlier run is not of these records
            None => out.outdated(select::saved_model()),
        }
    }
    let all = Some(&records);
    let trained = stages::train(&study, &deck, all, &mut out, &mut failed, progress)?;
    let mut text = format!("{}\n{}\n", study.name, deck.description());
    text.push_str(&text::deck_warnings(&deck));
    text.push_str(&text::selected(selection.as_ref()));
    let mut growths = Vec::new();
    for result in &trained {
        let name = &result.model.name;
        text.push_str(&text::fit(name, &result.report, &result.uncertainty));
        let growth = growth_of(&result.model);
        let stage = format!("scan for growth of {name}");
        if let Some(growth) = attempt(&mut failed, stage, growth)? {
            text.push_str(&text::growth(name, &growth));
            let model = name.clone();
            growths.push(ModelGrowth { model, growth });
        }
    }
    text.push_str(&text::failures(&failed));
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
        "trained": fits, "selection": selection, "growth": growths, "failed": failed,
        "warnings": deck.warnings()
    });
    Ok(out.answer(text, value)?.passed_if(failed.is_empty()))
}
