//! Figures 2.1 to 2.5 and 3.10 of the thesis: Laguerre functions and their gain.

use super::figure::Figure;
use super::response_figures::{TimePanel, time_history_figure};
use super::series::PlottedSeries;
use crate::error::Result;
use crate::reference::{LaguerreFunctions, Lines};

/// The six figures with the number of each in the thesis.
pub fn laguerre_figures(functions: &LaguerreFunctions) -> Result<Vec<(&'static str, Figure)>> {
    let (samples, time) = ("Sample k", "Dimensionless time τ");
    let all = [
        (
            "2.1",
            "Laguerre functions, p = 0.2",
            "l (–)",
            time,
            &functions.by_order,
        ),
        (
            "2.2",
            "Second-order function",
            "l (–)",
            time,
            &functions.by_decay_rate,
        ),
        (
            "2.3",
            "Discrete functions, α = 0.4",
            "g (–)",
            samples,
            &functions.discrete_by_order,
        ),
        (
            "2.4",
            "Second-order discrete function",
            "g (–)",
            samples,
            &functions.discrete_by_alpha,
        ),
        (
            "2.5",
            "Gain, the same for every order",
            "|G| (–)",
            "Part of half the sampling frequency",
            &functions.gain,
        ),
        (
            "3.10",
            "Filters of the decks, L = 3, α = 0.6",
            "g (–)",
            samples,
            &functions.of_the_decks,
        ),
    ];
    let one = |(number, title, y, x, lines)| Ok((number, lines_figure(title, y, x, lines)?));
    all.into_iter().map(one).collect()
}

fn lines_figure(title: &str, y_label: &str, x_label: &str, lines: &Lines) -> Result<Figure> {
    let series = lines.iter();
    let series = series.map(|(label, points)| PlottedSeries::new(label, points.clone()));
    let panel = TimePanel {
        y_label: y_label.to_owned(),
        series: series.collect(),
    };
    time_history_figure(title, &[panel], x_label)
}
