//! Time histories.

use super::axis::Axis;
use super::drawing::Drawing;
use super::figure::Figure;
use super::legend::entries;
use super::panel::Panel;
use super::series::{PlottedSeries, labels_of};
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
    let mut drawn = Vec::with_capacity(panels.len());
    for panel in panels {
        let mut drawing = Panel::new(Axis::new(t_label).tight(), Axis::new(&panel.y_label));
        drawing.level = Some(0.0);
        if scale < panel.series.len() {
            let first = panel.series.iter().take(scale).flat_map(|s| &s.points);
            let greatest = first.map(|p| ROOM * p.1.abs()).fold(0.0, f64::max);
            drawing.y.within = Some((-greatest, greatest));
        }
        drawing.add_labelled(&panel.series, &labels, ink)?;
        drawn.push(drawing);
    }
    Drawing::stacked(PLACE, title, drawn, 170.0, vec![entries(&labels, ink)?])
}
