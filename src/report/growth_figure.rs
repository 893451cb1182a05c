//! What something costs over its size.

use super::axis::Axis;
use super::drawing::{Drawing, titled};
use super::figure::Figure;
use super::legend::entries;
use super::panel::Panel;
use super::style::{COLOURS, Ink, Shape};
use crate::error::Result;

/// One cost over one size, both axes logarithmic.
#[derive(Debug, Clone, PartialEq)]
pub struct GrowthPanel {
    /// What is done, with the exponents.
    pub title: String,
    /// What the size counts.
    pub x_label: String,
    /// Size and cost, as measured.
    pub measured: Vec<(f64, f64)>,
    /// Ends of the line of the exponent fitted.
    pub fitted: Vec<(f64, f64)>,
    /// Ends of the line of the exponent expected.
    pub expected: Vec<(f64, f64)>,
}

/// Panels of cost over size, `columns` beside each other, with `y_label` in common.
///
/// # Errors
/// [`crate::Error::Input`] for no data and numbers that are not finite.
pub fn growth_figure(
    title: &str,
    panels: &[GrowthPanel],
    y_label: &str,
    columns: usize,
) -> Result<Figure> {
    let logarithmic = |label: &str| Axis::new(label).logarithmic();
    let inks = [
        Ink::dots(COLOURS[0], Shape::Circle),
        Ink::stroke(COLOURS[0], None, 1.3),
        Ink::stroke(COLOURS[1], Some("7 3"), 1.3),
    ];
    let labels = ["measured", "fitted", "by theory"].map(str::to_owned);
    let drawn = panels.iter().map(|panel| {
        let mut drawing = Panel::new(logarithmic(&panel.x_label), logarithmic(y_label));
        drawing.title = Some(panel.title.clone());
        let all = [&panel.measured, &panel.fitted, &panel.expected];
        for ((points, ink), label) in all.into_iter().zip(inks).zip(&labels) {
            if !points.is_empty() {
                drawing.add(label, points.clone(), ink);
            }
        }
        drawing
    });
    Drawing {
        name: "cost over size",
        title: titled(title),
        panels: drawn.collect(),
        columns,
        axes: (230.0, 150.0),
        legend: vec![entries(&labels, |i| Ok(inks[i]))?],
    }
    .draw()
}
