//! `aerodeck compare models`: Laguerre models against rational functions on one girder.

use super::common::{self, beside_the_thesis, metrics_of, metrics_table};
use crate::cli::figures;
use crate::cli::vocabulary::{
    Answer, DerivativePlot, Dof, Figure, OutputDir, PageSection, PlottedSeries, Progress, Result,
    TimePanel, counted, csv_cell, time_history_figure,
};
use crate::comparison::forces::{
    CompareOptions, History, ModelsComparison, Score, compare_models, in_magnitude_band,
    in_phase_band, score_table,
};
use crate::report::{TransferCurve, TransferPlot, derivatives_figure, transfer_figure};
use std::fmt::Write as _;
use std::path::Path;

/// Runs the command, whose results stand in the folder `left_in`.
pub(crate) fn run(options: &CompareOptions, left_in: &Path, progress: &Progress) -> Result<Answer> {
    let mut out = OutputDir::new(left_in)?;
    let results = progress.counting("records", |on_done| compare_models(options, on_done))?;
    out.write("models_metrics.csv", score_table(&results.scores))?;
    out.write("models_transfer.csv", transfer_table(&results))?;
    figures::write("models_transfer", &mut out, || transfer_functions(&results))?;
    figures::write("models_derivatives", &mut out, || derivatives(&results))?;
    for &motion in &options.dofs {
        let stem = format!("models_metrics_{}", motion.name());
        figures::write(&stem, &mut out, || metrics(options, &results, motion))?;
    }
    for (stem, figure) in histories(&results)? {
        figures::write(&stem, &mut out, || Ok(figure))?;
    }
    let text = text(&results);
    out.answer(text, serde_json::json!({ "comparison": results }))
}

/// Metrics over the frequency of a motion (Figures 3.12, 3.13, 3.27, 3.28).
fn metrics(options: &CompareOptions, results: &ModelsComparison, motion: Dof) -> Result<Figure> {
    let chosen = results.scores.iter().filter(|s| s.case.motion == motion);
    let (deck, speed, name) = (&results.deck, results.speed_m_s, motion.name());
    let title = format!("{deck} at {speed:.2} m/s: metrics of the predicted forces, {name} motion");
    let label = |s: &Score| s.case.model.clone();
    metrics_of(&title, &options.dofs, &chosen.collect::<Vec<_>>(), &label)
}

/// Magnitude and phase with the bands (Figures 3.21 and 3.22).
fn transfer_functions(results: &ModelsComparison) -> Result<Figure> {
    let plots = results.entries.iter().map(|entry| {
        let (force, motion) = (entry.force.force_name(), entry.motion.name());
        let points = entry.points.iter();
        let points = points.map(|p| (p.frequency_hz, p.magnitude, p.phase_deg));
        TransferPlot {
            name: format!("{force} due to {motion} motion"),
            reference: TransferCurve {
                model: "measured".into(),
                points: points.collect(),
            },
            tolerance: Some((0.15, 5.0)),
            models: entry.curves.clone(),
        }
    });
    let (deck, speed) = (&results.deck, results.speed_m_s);
    let title = format!("{deck} at {speed:.2} m/s: transfer functions");
    transfer_figure(&title, &plots.collect::<Vec<_>>())
}

/// Derivatives over reduced velocity (Figures 3.23 to 3.26).
fn derivatives(results: &ModelsComparison) -> Result<Figure> {
    let all = results.derivatives.iter().map(|d| {
        let fitted = d.models.iter();
        let fitted = fitted.map(|(model, points)| PlottedSeries::new(model, points.clone()));
        DerivativePlot {
            name: d.name.to_owned(),
            measured: vec![PlottedSeries::new("measured", d.measured.clone())],
            fitted: fitted.collect(),
            ..DerivativePlot::default()
        }
    });
    let all: Vec<DerivativePlot> = all.collect();
    let (deck, speed) = (&results.deck, results.speed_m_s);
    let title = format!("{deck} at {speed:.2} m/s: aerodynamic derivatives");
    derivatives_figure(&title, "V̂ = V/(ωB)", "", &all)
}

/// Forces over a few periods, one figure per motion and frequency (Figures 3.29 to 3.32).
fn histories(results: &ModelsComparison) -> Result<Vec<(String, Figure)>> {
    let same = |a: &History, b: &History| (a.motion, a.frequency_hz) == (b.motion, b.frequency_hz);
    results
        .histories
        .chunk_by(same)
        .map(|group| {
            let panels: Vec<TimePanel> = group.iter().map(|h| panel(results, h)).collect();
            let (motion, f) = (group[0].motion.name(), group[0].frequency_hz);
            let title = format!("{}: {motion} motion at {f:.2} Hz", results.deck);
            let figure = time_history_figure(&title, &panels, "Time (s)")?;
            Ok((format!("models_history_{motion}_{f:.1}_hz"), figure))
        })
        .collect()
}

fn panel(results: &ModelsComparison, history: &History) -> TimePanel {
    let series = |label: &str, values: &[f64]| {
        let points = history.time_s.iter().copied().zip(values.iter().copied());
        PlottedSeries::new(label, points.collect())
    };
    let unit = match history.force {
        Dof::Torsion => "N·m/m",
        _ => "N/m",
    };
    let mut all = vec![series("measured", &history.measured)];
    let models = results.models.iter().zip(&history.predicted);
    all.extend(models.map(|(m, values)| series(&m.name, values)));
    TimePanel::new(format!("{} ({unit})", history.force.force_name()), all)
}

/// The section of the page of the thesis.
pub(super) fn section(progress: &Progress) -> Result<PageSection> {
    let options = CompareOptions {
        decks: vec!["LN21-5200".to_owned()],
        ..CompareOptions::default()
    };
    let results = progress.counting("records of one girder", |on_done| {
        compare_models(&options, on_done)
    })?;
    let (first, second) = (transfer_functions(&results)?, derivatives(&results)?);
    let mut figures = Vec::new();
    for (dof, caption) in [
        (
            Dof::Vertical,
            "Figures 3.12 (the Laguerre model alone) and 3.28: metrics over the frequency of vertical motion",
        ),
        (
            Dof::Torsion,
            "Figures 3.13 (the Laguerre model alone) and 3.27: metrics over the frequency of torsional motion",
        ),
    ] {
        figures.push((caption.to_owned(), metrics(&options, &results, dof)?));
    }
    for (stem, figure) in histories(&results)? {
        figures.push((history_caption(&stem), figure));
    }
    figures.push((
        "Figures 3.21 and 3.22: magnitude and phase of the transfer functions, with ±15 % and ±5°"
            .to_owned(),
        first,
    ));
    figures.push((
        "Figures 3.23 to 3.26: aerodynamic derivatives over the reduced velocity".to_owned(),
        second,
    ));
    let title = "3.5.2, 3.5.5, 3.5.6 Models of one girder, on rebuilt records";
    let mut section = common::section(title, &results.statements, figures);
    section.text.push(
        "The laboratory's records are not published, so records are rebuilt from the published derivatives: spikes, noise and \
         resonances of the rig, which the thesis sees in Figures 3.12, 3.13, 3.16 and 3.17, are not in them and cannot be repeated."
            .to_owned(),
    );
    Ok(section)
}

/// What a figure of forces over time shows.
fn history_caption(stem: &str) -> String {
    let (printed, motion) = match stem {
        "models_history_vertical_0.5_hz" => ("3.17 and 3.29", "vertical motion at 0.5 Hz"),
        "models_history_torsion_0.5_hz" => ("3.16 and 3.30", "torsional motion at 0.5 Hz"),
        "models_history_vertical_2.0_hz" => ("3.14 and 3.31", "vertical motion at 2.0 Hz"),
        "models_history_torsion_2.0_hz" => ("3.15 and 3.32", "torsional motion at 2.0 Hz"),
        other => return other.to_owned(),
    };
    format!("Figures {printed}: lift and moment due to {motion}, measured and by the models")
}

fn text(results: &ModelsComparison) -> String {
    let mut text = format!(
        "Models of {} at {:.2} m/s against what was measured\n\n",
        results.deck, results.speed_m_s
    );
    for model in &results.models {
        let poles: Vec<String> = model.poles.iter().map(|p| format!("{p:.3}")).collect();
        let poles = match poles.is_empty() {
            true => String::new(),
            false => format!(", poles {}", poles.join(", ")),
        };
        let coefficients = counted(model.coefficients, "coefficient");
        let (name, method) = (&model.name, &model.method);
        text += &format!("{name}: {method}; {coefficients} a transfer function{poles}\n");
    }
    text.push_str(
        "\nFrequency domain, bands of the thesis (±15 %, ±5°) around the measured derivatives\n",
    );
    for entry in &results.entries {
        let (force, motion) = (entry.force.name(), entry.motion.name());
        let _ = writeln!(text, "{force} force due to {motion} motion");
        for (m, model) in results.models.iter().enumerate() {
            let _ = writeln!(text, "  {:<34} {}", model.name, entry.describe(m));
        }
    }
    text.push_str("\nTime domain\n");
    text.push_str(&metrics_table(&results.summaries, |s| &s.case.model));
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
                let (magnitude, phase) = (in_magnitude_band(off.0), in_phase_band(off.1));
                let (force, motion) = (entry.force.name(), entry.motion.name());
                let (hertz, k, size, angle) = (
                    point.frequency_hz,
                    point.k,
                    point.magnitude,
                    point.phase_deg,
                );
                text += &format!("{force},{motion},{hertz:.4},{k:.5},{size:.6},{angle:.3},");
                let (model, (size, angle)) = (csv_cell(&model.model), off);
                text += &format!("{model},{size:.3},{angle:.3},{magnitude},{phase}\n");
            }
        }
    }
    text
}
