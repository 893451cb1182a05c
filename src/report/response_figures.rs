//! Time histories.

use super::axis::Axis;
use super::drawing::Drawing;
use super::figure::Figure;
use super::legend::Entry;
use super::panel::Panel;
use super::series::{PlottedSeries, index_of, labels_of};
use super::style::{Ink, colour, dash};
use crate::error::Result;

/// Histories with a common ordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct TimePanel {
    /// Name, symbol and unit of the ordinate.
    pub y_label: String,
    /// Time (s) and value; series of the same label in several panels share colour and legend entry.
    pub series: Vec<PlottedSeries>,
}

/// Histories over time, one panel below the other with the time axis `t_label` in common.
///
/// Of long histories every px column shows its first, lowest, highest and last point, so that no peak is lost.
///
/// # Errors
/// [`crate::Error::Input`] for no data, numbers that are not finite, and more labels than colours.
pub fn time_history_figure(title: &str, panels: &[TimePanel], t_label: &str) -> Result<Figure> {
    const PLACE: &str = "time history";
    let labels = labels_of(panels.iter().flat_map(|p| &p.series));
    // few distinct lines may lie exactly on each other: later ones are dashed, so that the first shows through
    let ink = |i: usize| -> Result<Ink> { Ok(Ink::stroke(colour(PLACE, i)?, dash(i), 1.3)) };
    let ends = panels
        .iter()
        .flat_map(|p| &p.series)
        .flat_map(|s| &s.points)
        .map(|p| p.0)
        .filter(|t| t.is_finite())
        .fold(None, |ends: Option<(f64, f64)>, t| {
            Some(ends.map_or((t, t), |(a, b)| (a.min(t), b.max(t))))
        });
    let mut drawn = Vec::with_capacity(panels.len());
    for (i, panel) in panels.iter().enumerate() {
        let mut time = Axis::new(if i + 1 == panels.len() { t_label } else { "" });
        time.range = ends.filter(|(first, last)| first < last);
        let mut drawing = Panel::new(time, Axis::new(&panel.y_label));
        drawing.level = Some(0.0);
        for series in &panel.series {
            let ink = ink(index_of(&labels, &series.label))?;
            drawing.add(&series.label, series.points.clone(), ink);
        }
        drawn.push(drawing);
    }
    let mut legend = Vec::with_capacity(labels.len());
    for (i, label) in labels.iter().enumerate() {
        legend.push(Entry::new(label, ink(i)?));
    }
    Drawing {
        name: PLACE,
        title: Some(title.to_owned()).filter(|t| !t.is_empty()),
        panels: drawn,
        columns: 1,
        axes: (640.0, 170.0),
        legend: vec![legend],
    }
    .draw()
}
