//! Figures 2.1 to 2.11 and 3.10 of the thesis: Laguerre functions and their gain, and the first-order example.

use super::response_figures::{TimePanel, time_history_figure};
use super::transfer_figure::{TransferCurve, TransferPlot, transfer_figure};
use super::vocabulary::{Figure, PlottedSeries};
use crate::error::Result;
use crate::reference::{
    ALPHA, ALPHA_OF_ORDERS, FILTERS, FirstOrderResults, Lines, STEP_S, VALIDATION_HZ,
};

const TIME: &str = "Dimensionless time τ";
const PARTS: &str = "Part of half the sampling frequency";
/// Number in the thesis, title, ordinate and abscissa of each figure.
const FIGURES: [[&str; 4]; 6] = [
    ["2.1", "Laguerre functions, p = 0.2", "l (–)", TIME],
    ["2.2", "Second-order function", "l (–)", TIME],
    ["2.3", "Discrete functions, α = 0.4", "g (–)", "Sample k"],
    ["2.4", "Second-order discrete function", "g (–)", "Sample k"],
    ["2.5", "Gain, the same for every order", "|G| (–)", PARTS],
    [
        "3.10",
        "Filters of the decks, L = 3, α = 0.6",
        "g (–)",
        "Sample k",
    ],
];

/// The six figures with the number of each in the thesis.
pub fn laguerre_figures(functions: &[Lines; 6]) -> Result<Vec<(&'static str, Figure)>> {
    let one = |([number, title, y_label, x_label], lines): ([&'static str; 4], &Lines)| {
        let series = lines.iter();
        let series = series.map(|(label, points)| PlottedSeries::new(label, points.clone()));
        let panel = TimePanel::new(y_label, series);
        Ok((number, time_history_figure(title, &[panel], x_label)?))
    };
    FIGURES.into_iter().zip(functions).map(one).collect()
}

/// The six figures with the number of each in the thesis: training input, predicted output, transfer function and impulse
/// response of the model, transfer functions for several `α` and for several `L`.
pub fn first_order_figures(results: &FirstOrderResults) -> Result<Vec<(&'static str, Figure)>> {
    let over_time = |(label, values): &(&str, &Vec<f64>)| {
        let points = values.iter().enumerate();
        let points = points.map(|(k, y)| (k as f64 * STEP_S, *y));
        PlottedSeries::new(*label, points.collect())
    };
    let history = |title: &str, label: &str, signals: &[(&str, &Vec<f64>)]| {
        let panel = TimePanel::new(label, signals.iter().map(over_time));
        time_history_figure(title, &[panel], "Time (s)")
    };
    let order = format!("L = {}", FILTERS);
    let parameters = format!("{order}, α = {}", ALPHA);
    let [training, _] = &results.training;
    let [_, system, model] = &results.validation;
    let [impulse, filters] = &results.impulse;
    let input = history("Training input", "u (–)", &[("input", training)])?;
    let output = history(
        &format!("Output at {} Hz, {parameters}", VALIDATION_HZ),
        "y (–)",
        &[("system", system), ("Laguerre model", model)],
    )?;
    let responses = history(
        &format!("Impulse response, {parameters}"),
        "h Δt (–)",
        &[("system", impulse), ("Laguerre model", filters)],
    )?;
    let system = &results.system;
    let both = transfer(system, &parameters, [&results.tustin, &results.model])?;
    let alphas = transfer(system, &order, &results.by_alpha)?;
    let one_alpha = format!("α = {}", ALPHA_OF_ORDERS);
    let orders = transfer(system, &one_alpha, &results.by_order)?;
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
    system: &TransferCurve,
    parameters: &str,
    models: impl IntoIterator<Item = &'a TransferCurve>,
) -> Result<Figure> {
    let plot = TransferPlot {
        name: "1/(τs + 1)".into(),
        reference: system.clone(),
        tolerance: None,
        models: models.into_iter().cloned().collect(),
    };
    transfer_figure(&format!("Transfer functions, {parameters}"), &[plot])
}
