//! Figures 2.6 to 2.11 of the thesis: the first-order example.

use super::figure::Figure;
use super::response_figures::{TimePanel, time_history_figure};
use super::series::PlottedSeries;
use super::transfer_figure::{TransferCurve, TransferPlot, transfer_figure};
use crate::error::Result;
use crate::reference::{FirstOrderResults, SampledTransfer};

/// The six figures with the number of each in the thesis: training input, predicted output, transfer function and impulse
/// response of the model, transfer functions for several `α` and for several `L`.
pub fn first_order_figures(results: &FirstOrderResults) -> Result<Vec<(&'static str, Figure)>> {
    let step = results.example.step_s;
    let over_time = |label: &str, values: &[f64]| {
        let points = values
            .iter()
            .enumerate()
            .map(|(k, y)| (k as f64 * step, *y));
        PlottedSeries::new(label, points.collect())
    };
    let history = |title: &str, label: &str, series: Vec<PlottedSeries>| {
        let panel = TimePanel {
            y_label: label.to_owned(),
            series,
        };
        time_history_figure(title, &[panel], "Time (s)")
    };
    let parameters = format!(
        "L = {}, α = {}",
        results.example.filters, results.example.alpha
    );
    let [training, _] = &results.training;
    let [_, system, model] = &results.validation;
    let [impulse, filters] = &results.impulse;
    Ok(vec![
        (
            "2.6",
            history(
                "Training input",
                "u (–)",
                vec![over_time("input", training)],
            )?,
        ),
        (
            "2.7",
            history(
                &format!(
                    "Output at {} Hz, {parameters}",
                    results.example.validation_hz
                ),
                "y (–)",
                vec![
                    over_time("system", system),
                    over_time("Laguerre model", model),
                ],
            )?,
        ),
        (
            "2.8",
            transfer(results, &parameters, &[&results.tustin, &results.model])?,
        ),
        (
            "2.9",
            history(
                &format!("Impulse response, {parameters}"),
                "h Δt (–)",
                vec![
                    over_time("system", impulse),
                    over_time("Laguerre model", filters),
                ],
            )?,
        ),
        (
            "2.10",
            transfer(
                results,
                &format!("L = {}", results.example.filters),
                &results.by_alpha.iter().collect::<Vec<_>>(),
            )?,
        ),
        (
            "2.11",
            transfer(
                results,
                &format!("α = {}", results.example.alpha_of_orders),
                &results.by_order.iter().collect::<Vec<_>>(),
            )?,
        ),
    ])
}

fn transfer(
    results: &FirstOrderResults,
    parameters: &str,
    models: &[&SampledTransfer],
) -> Result<Figure> {
    let curve = |t: &SampledTransfer| TransferCurve {
        label: t.label.clone(),
        points: results
            .frequencies_hz
            .iter()
            .zip(t.magnitude.iter().zip(&t.phase_deg))
            .map(|(f, (m, p))| (*f, *m, *p))
            .collect(),
    };
    let plot = TransferPlot {
        name: "1/(τs + 1)".into(),
        reference: curve(&results.system),
        reference_is_points: false,
        tolerance: None,
        models: models.iter().map(|m| curve(m)).collect(),
    };
    transfer_figure(
        &format!("Transfer functions, {parameters}"),
        "Frequency (Hz)",
        &[plot],
    )
}
