//! Figures 2.1 to 2.5 and 3.10 of the thesis: Laguerre functions and their gain.

use super::figure::Figure;
use super::response_figures::{TimePanel, time_history_figure};
use super::series::PlottedSeries;
use crate::error::Result;
use crate::reference::Lines;

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
        let panel = TimePanel {
            y_label: y_label.to_owned(),
            series: series.collect(),
        };
        Ok((number, time_history_figure(title, &[panel], x_label)?))
    };
    FIGURES.into_iter().zip(functions).map(one).collect()
}
