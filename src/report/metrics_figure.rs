//! Metrics of goodness of fit over the frequency of the motion, side by side.

use super::axis::Axis;
use super::drawing::{Drawing, titled};
use super::figure::Figure;
use super::legend::entries;
use super::panel::Panel;
use super::response_figures::TimePanel;
use super::series::labels_of;
use super::style::{Ink, Shape, colour, dash};
use crate::error::Result;

/// Panels row by row, each of one metric of one force over the frequency (Hz), with the ordinate from 0 to 1 in common; series of one label share ink and legend entry.
///
/// # Errors
/// [`crate::Error::Input`] for no data, numbers that are not finite, and more labels than colours.
pub(crate) fn metrics_figure(title: &str, panels: &[TimePanel], columns: usize) -> Result<Figure> {
    const PLACE: &str = "metrics";
    let labels = labels_of(panels.iter().flat_map(|p| &p.series));
    let line = |i: usize| -> Result<Ink> { Ok(Ink::line(colour(PLACE, i)?, dash(i))) };
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
    Drawing {
        name: PLACE,
        title: titled(title),
        panels: drawn,
        columns: columns.max(1),
        axes: (230.0, 160.0),
        legend: vec![entries(&labels, line)?],
    }
    .over_one_abscissa()
    .draw()
}

const SHAPES: [Shape; 4] = [Shape::Circle, Shape::Square, Shape::Diamond, Shape::Cross];
