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
    let example = &results.example;
    let over_time = |(label, values): &(&str, &Vec<f64>)| {
        let points = values.iter().enumerate();
        let points = points.map(|(k, y)| (k as f64 * example.step_s, *y));
        PlottedSeries::new(*label, points.collect())
    };
    let history = |title: &str, label: &str, signals: &[(&str, &Vec<f64>)]| {
        let panel = TimePanel {
            y_label: label.to_owned(),
            series: signals.iter().map(over_time).collect(),
        };
        time_history_figure(title, &[panel], "Time (s)")
    };
    let order = format!("L = {}", example.filters);
    let parameters = format!("{order}, α = {}", example.alpha);
    let [training, _] = &results.training;
    let [_, system, model] = &results.validation;
    let [impulse, filters] = &results.impulse;
    let input = history("Training input", "u (–)", &[("input", training)])?;
    let output = history(
        &format!("Output at {} Hz, {parameters}", example.validation_hz),
        "y (–)",
        &[("system", system), ("Laguerre model", model)],
    )?;
    let responses = history(
        &format!("Impulse response, {parameters}"),
        "h Δt (–)",
        &[("system", impulse), ("Laguerre model", filters)],
    )?;
    let both = transfer(results, &parameters, [&results.tustin, &results.model])?;
    let alphas = transfer(results, &order, &results.by_alpha)?;
    let one_alpha = format!("α = {}", example.alpha_of_orders);
    let orders = transfer(results, &one_alpha, &results.by_order)?;
    Ok(vec![
        ("2.6", input),
        ("2.7", output),
        ("2.8", both),
        ("2.9", responses),
        ("2.10", alphas),
        ("2.11", orders),
    ])
}

fn transfer<'a>(
    results: &FirstOrderResults,
    parameters: &str,
    models: impl IntoIterator<Item = &'a SampledTransfer>,
) -> Result<Figure> {
    let curve = |t: &SampledTransfer| TransferCurve {
        model: t.label.clone(),
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
        models: models.into_iter().map(curve).collect(),
    };
    transfer_figure(
        &format!("Transfer functions, {parameters}"),
        "Frequency (Hz)",
        &[plot],
    )
}
