//! `aerodeck compare models`: Laguerre models against rational functions on one girder.

use super::common::{self, Common, beside_the_thesis, metrics_table};
use super::figures::{derivatives, histories, metrics_of, transfer_functions};
use crate::cli::answer::Answer;
use crate::cli::figures;
use crate::cli::output::OutputDir;
use crate::cli::progress::Progress;
use crate::comparison::forces::{ModelsComparison, compare_models, inside, score_table};
use crate::error::Result;
use crate::report::PageSection;
use std::fmt::Write as _;

/// Laguerre models against rational functions on one girder, in time and frequency (thesis, sections 3.5.5, 3.5.6)
///
/// Example: aerodeck compare models --deck LN21-5200
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// Embedded deck.
    #[arg(long, default_value = "LN21-5200")]
    deck: String,
    #[command(flatten)]
    common: Common,
}

/// Runs the command.
pub(crate) fn run(args: &Args, progress: &Progress) -> Result<Answer> {
    let options = args.common.options(vec![args.deck.clone()], None);
    let mut out = OutputDir::new(&args.common.out)?;
    let stage = progress.steps("records");
    let results = compare_models(&options, &|done, of| stage.at(done as u64, of as u64))?;
    drop(stage);
    out.write("models_metrics.csv", score_table(&results.scores))?;
    out.write("models_transfer.csv", transfer_table(&results))?;
    figures::write("models_transfer", &mut out, || transfer_functions(&results))?;
    figures::write("models_derivatives", &mut out, || derivatives(&results))?;
    for &motion in &options.dofs {
        let chosen: Vec<_> = results
            .scores
            .iter()
            .filter(|s| s.motion == motion)
            .collect();
        let title = format!(
            "{} at {:.2} m/s: metrics of the predicted forces, {} motion",
            results.deck,
            results.speed_m_s,
            motion.name()
        );
        let stem = format!("models_metrics_{}", motion.name());
        figures::write(&stem, &mut out, || {
            metrics_of(&title, &options.dofs, &chosen, &|s| s.model.clone())
        })?;
    }
    for (stem, figure) in histories(&results)? {
        figures::write(&stem, &mut out, || Ok(figure))?;
    }
    let text = account(&results);
    out.answer(text, serde_json::json!({ "comparison": results }))
}

/// The section of the page of the thesis.
pub(super) fn section(common: &Common, progress: &Progress) -> Result<PageSection> {
    let deck = "LN21-5200".to_owned();
    let stage = progress.steps("records of one girder");
    let results = compare_models(&common.options(vec![deck], None), &|done, of| {
        stage.at(done as u64, of as u64);
    })?;
    drop(stage);
    let mut figures = vec![
        (
            "Transfer functions (Figures 3.18 to 3.22)".to_owned(),
            transfer_functions(&results)?,
        ),
        (
            "Derivatives (Figures 3.23 to 3.26)".to_owned(),
            derivatives(&results)?,
        ),
    ];
    let forces = histories(&results)?.into_iter();
    figures.extend(
        forces.map(|(stem, figure)| (format!("Forces (Figures 3.29 to 3.32): {stem}"), figure)),
    );
    let title = "3.5.5, 3.5.6 Models of one girder, on rebuilt records";
    Ok(common::section(title, &results.statements, figures))
}

fn account(results: &ModelsComparison) -> String {
    let mut text = format!(
        "Models of {} at {:.2} m/s against what was measured\n\n",
        results.deck, results.speed_m_s
    );
    for model in &results.models {
        let poles: Vec<String> = model.poles.iter().map(|p| format!("{p:.3}")).collect();
        let _ = writeln!(
            text,
            "{}: {}; {} coefficients a transfer function{}",
            model.name,
            model.method,
            model.coefficients,
            if poles.is_empty() {
                String::new()
            } else {
                format!(", poles {}", poles.join(", "))
            }
        );
    }
    text.push_str(
        "\nFrequency domain, bands of the thesis (±15 %, ±5°) around the measured derivatives\n",
    );
    for entry in &results.entries {
        let _ = writeln!(
            text,
            "{} force due to {} motion",
            entry.force.name(),
            entry.motion.name()
        );
        for (m, model) in results.models.iter().enumerate() {
            let _ = writeln!(text, "  {:<34} {}", model.name, entry.describe(m));
        }
    }
    text.push_str("\nTime domain\n");
    text.push_str(&metrics_table(&results.summaries, |s| s.model.clone()));
    text.push('\n');
    text.push_str(&beside_the_thesis(&results.statements));
    text
}

/// Every test point of every transfer function with the deviations of the models.
fn transfer_table(results: &ModelsComparison) -> String {
    let mut text = String::from(
        "force,motion,frequency_hz,K,magnitude,phase_deg,model,magnitude_off_percent,phase_off_deg,inside_15_percent,inside_5_deg\n",
    );
    for entry in &results.entries {
        for model in &entry.models {
            for (point, off) in entry.points.iter().zip(&model.points) {
                let (magnitude, phase) = inside(off);
                let _ = writeln!(
                    text,
                    "{},{},{:.4},{:.5},{:.6},{:.3},\"{}\",{:.3},{:.3},{magnitude},{phase}",
                    entry.force.name(),
                    entry.motion.name(),
                    point.frequency_hz,
                    point.k,
                    point.magnitude,
                    point.phase_deg,
                    model.model,
                    off.0,
                    off.1
                );
            }
        }
    }
    text
}
