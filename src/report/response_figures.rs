//! Time histories and the search for poles.

use super::axis::{Axis, significant};
use super::figure::Figure;
use super::legend::Entry;
use super::panel::{Note, Panel};
use super::series::{PlottedSeries, index_of, labels_of};
use super::sheet::Sheet;
use super::style::{BLACK, Ink, Shape, colour, dash};
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
    let ink = |i: usize| -> Result<Ink> {
        Ok(Ink::Line {
            colour: colour(PLACE, i)?,
            dash: dash(i),
            width: 1.3,
        })
    };
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
    Sheet {
        name: PLACE,
        title: Some(title.to_owned()).filter(|t| !t.is_empty()),
        panels: drawn,
        columns: 1,
        axes: (640.0, 170.0),
        legend: vec![legend],
    }
    .draw()
}

/// What was tried in a search for the poles of a model, for the figure.
#[derive(Debug, Clone, PartialEq)]
pub struct PoleSearchPlot {
    /// Line above the figure; empty for none.
    pub title: String,
    /// Name of the pole, e.g. `Pole p (–)`.
    pub pole_label: String,
    /// Name of the objective and its unit.
    pub objective_label: String,
    /// Pole and objective, one series e.g. for each number of filters.
    pub curves: Vec<PlottedSeries>,
    /// The pole that was chosen and its objective.
    pub chosen: Option<(f64, f64)>,
}

/// Objective over the pole, every trial a dot; logarithmic where positive objectives differ by more than a factor of 30.
///
/// # Errors
/// [`crate::Error::Input`] for no data, numbers that are not finite, and more curves than colours.
pub fn pole_search_figure(search: &PoleSearchPlot) -> Result<Figure> {
    const PLACE: &str = "pole search";
    let mut panel = Panel::new(
        Axis::new(&search.pole_label),
        Axis {
            logarithmic: spread(&search.curves) > 30.0,
            ..Axis::new(&search.objective_label)
        },
    );
    let mut legend = Vec::with_capacity(search.curves.len());
    for (i, curve) in search.curves.iter().enumerate() {
        let ink = Ink::line(colour(PLACE, i)?, dash(i));
        panel.add(&curve.label, curve.points.clone(), ink);
        legend.push(Entry::new(&curve.label, ink));
    }
    for (i, curve) in search.curves.iter().enumerate() {
        let mut dots = Ink::dots(colour(PLACE, i)?, Shape::Circle);
        if let Ink::Dots { radius, .. } = &mut dots {
            *radius = 2.4;
        }
        panel.add(&curve.label, curve.points.clone(), dots);
    }
    if let Some(at) = search.chosen {
        let ink = Ink::Dots {
            colour: BLACK,
            shape: Shape::Diamond,
            radius: 4.5,
            hollow: false,
        };
        panel.add("chosen pole", vec![at], ink);
        panel.notes.push(Note {
            at,
            text: significant(at.0),
            colour: BLACK,
        });
        legend.push(Entry::new("chosen", ink));
    }
    Sheet {
        name: PLACE,
        title: Some(search.title.clone()).filter(|t| !t.is_empty()),
        panels: vec![panel],
        columns: 1,
        axes: (560.0, 300.0),
        legend: vec![legend],
    }
    .draw()
}

/// Largest over smallest of positive objectives; 1 when one is not positive.
fn spread(curves: &[PlottedSeries]) -> f64 {
    let values = || curves.iter().flat_map(|c| &c.points).map(|p| p.1);
    let low = values().fold(f64::INFINITY, f64::min);
    if low > 0.0 {
        values().fold(0.0, f64::max) / low
    } else {
        1.0
    }
}
