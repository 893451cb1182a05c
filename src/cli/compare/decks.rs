//! `aerodeck compare decks`: one model on several girders.

use super::common::{self, beside_the_thesis, metrics_of, metrics_table};
use crate::cli::figures as drawn;
use crate::cli::vocabulary::{Answer, Figure, OutputDir, PageSection, Progress, Result};
use crate::comparison::forces::{
    CompareOptions, DecksComparison, Score, compare_decks, score_table,
};
use std::path::Path;

/// Runs the command, whose results stand in the folder `left_in`.
pub(crate) fn run(options: &CompareOptions, left_in: &Path, progress: &Progress) -> Result<Answer> {
    let mut out = OutputDir::new(left_in)?;
    let results = progress.counting("records", |on_done| compare_decks(options, on_done))?;
    out.write("decks_metrics.csv", score_table(&results.scores))?;
    for (stem, figure) in figures(options, &results)? {
        drawn::write(&stem, &mut out, || Ok(figure))?;
    }
    let text = text(&results);
    out.answer(text, serde_json::json!({ "comparison": results }))
}

/// The metrics, one figure per motion and kind of speed.
fn figures(options: &CompareOptions, results: &DecksComparison) -> Result<Vec<(String, Figure)>> {
    let mut figures = Vec::new();
    for &motion in &options.dofs {
        for (held_out, which, ending) in [
            (false, "speed of the training", ""),
            (true, "other speed", "_held_out"),
        ] {
            let scores = results.scores.iter();
            let chosen = scores.filter(|s| s.case.motion == motion && s.case.held_out == held_out);
            let chosen: Vec<_> = chosen.collect();
            if chosen.is_empty() {
                continue;
            }
            let title = format!(
                "Metrics of the predicted forces, {} motion, {which}, {}",
                motion.name(),
                options.laguerre_name()
            );
            let label = |s: &Score| match options.trained_on.is_some() || held_out {
                true => format!("{} {:.2} m/s", s.case.deck, s.case.speed_m_s),
                false => s.case.deck.clone(),
            };
            let stem = format!("decks_{}{ending}", motion.name());
            figures.push((stem, metrics_of(&title, &options.dofs, &chosen, &label)?));
        }
    }
    Ok(figures)
}

/// The section of the page of the thesis.
pub(super) fn section(progress: &Progress) -> Result<PageSection> {
    let options = CompareOptions::default();
    let results = progress.counting("records of several girders", |on_done| {
        compare_decks(&options, on_done)
    })?;
    let drawn = figures(&options, &results)?.into_iter();
    let drawn = drawn.map(|(stem, figure)| (caption(&stem), figure));
    let title = "3.5.4 Several girders, on rebuilt records";
    Ok(common::section(title, &results.statements, drawn.collect()))
}

/// What a figure of the page shows.
fn caption(stem: &str) -> String {
    let motion = match stem.contains("torsion") {
        true => "torsional",
        false => "vertical",
    };
    let printed = match (motion, stem.ends_with("_held_out")) {
        ("torsional", false) => "Figure 3.20",
        _ => "Not printed, beside Figure 3.20",
    };
    let speed = match stem.ends_with("_held_out") {
        true => "at the speed that the models were not trained at",
        false => "at the speed of the training",
    };
    format!("{printed}: metrics of several girders over the frequency of {motion} motion, {speed}")
}

fn text(results: &DecksComparison) -> String {
    let mut text = String::from("Predicted against measured forces of several girders\n\n");
    for deck in &results.decks {
        let speeds: Vec<String> = deck.speeds_m_s.iter().map(|v| format!("{v:.2}")).collect();
        let (name, width, speeds) = (&deck.deck, deck.width_m, speeds.join(" and "));
        let (model, speed) = &deck.trained_on;
        text += &format!(
            "{name:<11} B {width:.4} m, tested at {speeds} m/s, model of {model} at {speed:.2} m/s\n"
        );
    }
    text.push_str(
        "Forces are those of the measured derivatives (virtual tunnel), without the disturbances of the thesis's records.\n\n",
    );
    text.push_str(&metrics_table(&results.summaries, |s| &s.case.deck));
    text.push('\n');
    text.push_str(&beside_the_thesis(&results.statements));
    text
}
