//! Rows of points in panels: over time, metrics of goodness of fit over the frequency, and what something costs over its size.

use super::vocabulary::{
    Axis, COLOURS, Drawing, Figure, Ink, Panel, PlottedSeries, Shape, colour, dash, entries,
    labels_of,
};
use crate::error::Result;

/// Histories with a common ordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct TimePanel {
    /// Name, symbol and unit of the ordinate.
    pub y_label: String,
    /// Time (s) and value; series of the same label in several panels share colour and legend entry.
    pub series: Vec<PlottedSeries>,
}

impl TimePanel {
    /// Histories with this name of the ordinate.
    pub fn new(
        y_label: impl Into<String>,
        series: impl IntoIterator<Item = PlottedSeries>,
    ) -> Self {
        Self {
            y_label: y_label.into(),
            series: series.into_iter().collect(),
        }
    }
}

/// Histories over time, one panel below the other with the time axis `t_label` in common.
///
/// Of long histories every px column shows its first, lowest, highest and last point, so that no peak is lost.
///
/// # Errors
/// [`crate::Error::Input`] for no data, numbers that are not finite, and more labels than colours.
pub fn time_history_figure(title: &str, panels: &[TimePanel], t_label: &str) -> Result<Figure> {
    scaled_history_figure(title, panels, t_label, usize::MAX)
}

/// Room above the histories that give the scale.
const ROOM: f64 = 1.4;

/// The same with ordinates that show the first `scale` histories of each panel whole; those that grow leave it.
///
/// # Errors
/// As [`time_history_figure`].
pub(crate) fn scaled_history_figure(
    title: &str,
    panels: &[TimePanel],
    t_label: &str,
    scale: usize,
) -> Result<Figure> {
    const PLACE: &str = "time history";
    let labels = labels_of(panels.iter().flat_map(|p| &p.series));
    // few distinct lines may lie exactly on each other: later ones are dashed, so that the first shows through
    let ink = |i: usize| -> Result<Ink> { Ok(Ink::stroke(colour(PLACE, i)?, dash(i), 1.3)) };
    let draw = |panel: &TimePanel| {
        let mut drawing = Panel::new(Axis::new(t_label).tight(), Axis::new(&panel.y_label));
        drawing.level = Some(0.0);
        if scale < panel.series.len() {
            let first = panel.series.iter().take(scale).flat_map(|s| &s.points);
            let greatest = first.map(|p| ROOM * p.1.abs()).fold(0.0, f64::max);
            drawing.y.within = Some((-greatest, greatest));
        }
        drawing.add_labelled(&panel.series, &labels, ink)?;
        Ok(drawing)
    };
    let drawn = panels.iter().map(draw).collect::<Result<_>>()?;
    Drawing::stacked(PLACE, title, drawn, 170.0, vec![entries(&labels, ink)?])
}

/// Panels row by row, each of one metric of one force over the frequency (Hz), with the ordinate from 0 to 1 in common; series of one label share ink and legend entry.
///
/// # Errors
/// [`crate::Error::Input`] for no data, numbers that are not finite, and more labels than colours.
pub(crate) fn metrics_figure(title: &str, panels: &[TimePanel]) -> Result<Figure> {
    const PLACE: &str = "metrics";
    let labels = labels_of(panels.iter().flat_map(|p| &p.series));
    let line = |i: usize| Ink::nth(PLACE, i);
    let dots = |i: usize| Ok(Ink::dots(colour(PLACE, i)?, SHAPES[i % SHAPES.len()]));
    let mut drawn = Vec::with_capacity(panels.len());
    for panel in panels {
        let mut y = Axis::new("");
        y.range = Some((0.0, 1.05));
        let mut drawing = Panel::new(Axis::new("Frequency (Hz)").zero_based(), y);
        drawing.title = Some(panel.y_label.clone());
        drawing.add_labelled(&panel.series, &labels, line)?;
        drawing.add_labelled(&panel.series, &labels, dots)?;
        drawn.push(drawing);
    }
    let (axes, legend) = ([230.0, 160.0], vec![entries(&labels, line)?]);
    let drawing = Drawing::grid(PLACE, title, drawn, 3, axes, legend);
    drawing.over_one_abscissa().draw()
}

const SHAPES: [Shape; 4] = [Shape::Circle, Shape::Square, Shape::Diamond, Shape::Cross];

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

/// Panels of cost over size, three beside each other, with `y_label` in common.
///
/// # Errors
/// [`crate::Error::Input`] for no data and numbers that are not finite.
pub fn growth_figure(title: &str, panels: &[GrowthPanel], y_label: &str) -> Result<Figure> {
    let logarithmic = |label: &str| Axis::new(label).logarithmic();
    let inks = [
        Ink::dots(COLOURS[0], Shape::Circle),
        Ink::solid(COLOURS[0], 1.3),
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
    let (panels, legend) = (drawn.collect(), vec![entries(&labels, |i| Ok(inks[i]))?]);
    let axes = [230.0, 150.0];
    Drawing::grid("cost over size", title, panels, 3, axes, legend).draw()
}
