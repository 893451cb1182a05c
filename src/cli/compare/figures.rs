//! From the results of the comparisons to what the figures take.

use crate::comparison::forces::{History, ModelsComparison, Score};
use crate::error::Result;
use crate::report::{
    DerivativePlot, DerivativesPlot, Figure, MetricPanel, PlottedSeries, TimePanel, TransferCurve,
    TransferPlot, derivatives_figure, metrics_figure, time_history_figure, transfer_figure,
};
use crate::section::Dof;

/// The thesis's three metrics of every force over frequency, one line a label (Figures 3.20, 3.27 and 3.28).
pub(crate) fn metrics_of(
    title: &str,
    forces: &[Dof],
    scores: &[&Score],
    label: &dyn Fn(&Score) -> String,
) -> Result<Figure> {
    let mut panels = Vec::new();
    for &force in forces {
        for (name, pick) in [
            ("phase", (|s| s.metrics.phase) as fn(&Score) -> f64),
            ("peak", |s| s.metrics.peak),
            ("warped magnitude", |s| s.metrics.magnitude_warped),
        ] {
            let mut series: Vec<PlottedSeries> = Vec::new();
            for score in scores.iter().filter(|s| s.force == force) {
                let (label, point) = (label(score), (score.frequency_hz, pick(score)));
                match series.iter_mut().find(|s| s.label == label) {
                    Some(known) => known.points.push(point),
                    None => series.push(PlottedSeries::new(label, vec![point])),
                }
            }
            panels.push(MetricPanel {
                title: format!("{}: {name}", force_name(force)),
                series,
            });
        }
    }
    metrics_figure(title, &panels, 3)
}

fn force_name(force: Dof) -> &'static str {
    match force {
        Dof::Vertical => "lift",
        Dof::Lateral => "drag",
        Dof::Torsion => "moment",
    }
}

/// Magnitude and phase with the bands (Figures 3.21 and 3.22).
pub(crate) fn transfer_functions(results: &ModelsComparison) -> Result<Figure> {
    let plots: Vec<TransferPlot> = results
        .entries
        .iter()
        .map(|entry| TransferPlot {
            name: format!(
                "{} due to {} motion",
                force_name(entry.force),
                entry.motion.name()
            ),
            reference: TransferCurve {
                label: "measured".into(),
                points: entry
                    .points
                    .iter()
                    .map(|p| (p.frequency_hz, p.magnitude, p.phase_deg))
                    .collect(),
            },
            reference_is_points: true,
            tolerance: Some((0.15, 5.0)),
            models: entry
                .curves
                .iter()
                .map(|c| TransferCurve {
                    label: c.model.clone(),
                    points: c.points.clone(),
                })
                .collect(),
        })
        .collect();
    let title = format!(
        "{} at {:.2} m/s: transfer functions",
        results.deck, results.speed_m_s
    );
    transfer_figure(&title, "Frequency (Hz)", &plots)
}

/// Derivatives over reduced velocity (Figures 3.23 to 3.26).
pub(crate) fn derivatives(results: &ModelsComparison) -> Result<Figure> {
    derivatives_figure(&DerivativesPlot {
        title: format!(
            "{} at {:.2} m/s: aerodynamic derivatives",
            results.deck, results.speed_m_s
        ),
        velocity_label: "V̂ = V/(ωB)".into(),
        bars_label: String::new(),
        derivatives: results
            .derivatives
            .iter()
            .map(|d| DerivativePlot {
                name: d.name.to_owned(),
                measured: vec![PlottedSeries::new("measured", d.measured.clone())],
                bars: Vec::new(),
                fitted: d
                    .models
                    .iter()
                    .map(|(model, points)| PlottedSeries::new(model, points.clone()))
                    .collect(),
                reference: Vec::new(),
            })
            .collect(),
    })
}

/// Forces over a few periods, one figure a motion and frequency (Figures 3.29 to 3.32).
pub(crate) fn histories(results: &ModelsComparison) -> Result<Vec<(String, Figure)>> {
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
    let unit = if history.force == Dof::Torsion {
        "N·m/m"
    } else {
        "N/m"
    };
    let measured = [series("measured", &history.measured)];
    let models = results.models.iter().zip(&history.predicted);
    TimePanel {
        y_label: format!("{} ({unit})", force_name(history.force)),
        series: measured
            .into_iter()
            .chain(models.map(|(m, values)| series(&m.name, values)))
            .collect(),
    }
}
