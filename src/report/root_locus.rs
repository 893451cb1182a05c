//! Paths of the eigenvalues over wind speed.

use super::axis::Axis;
use super::figure::Figure;
use super::flutter_figures::branch_names;
use super::legend::Entry;
use super::panel::{Note, Panel};
use super::series::index_of;
use super::sheet::Sheet;
use super::style::{BLACK, GREY, Ink, Shape, colour, dash};
use crate::error::Result;
use crate::flutter::{FlutterCurves, ModePoint};

const PLACE: &str = "root locus";
/// Intervals between the points of a path that are marked.
const INTERVALS: usize = 5;

/// Imaginary over real part of the eigenvalues (1/s), a colour a model and a line style a branch.
///
/// A path begins at a hollow marker at its lowest wind speed and carries dots at a few others, with the speeds of the
/// first model written beside them. To the right of the vertical line motions grow.
///
/// # Errors
/// [`crate::Error::Input`] for no curves, empty or non-finite ones, and for more models than colours.
pub fn root_locus_figure(title: &str, curves: &[FlutterCurves]) -> Result<Figure> {
    let branches = branch_names(curves)?;
    let mut panel = Panel::new(Axis::new("Re λ (1/s)"), Axis::new("Im λ (rad/s)"));
    panel.uprights.push((0.0, BLACK));
    let mut models = Vec::new();
    for (i, model) in curves.iter().enumerate() {
        let colour = colour(PLACE, i)?;
        models.push(Entry::new(&model.model, Ink::line(colour, None)));
        for branch in &model.branches {
            let ink = Ink::line(colour, dash(index_of(&branches, &branch.name)));
            let name = format!("{}, {} branch", model.model, branch.name);
            let path = branch.points.iter().map(at).collect();
            panel.add(name, path, ink);
        }
    }
    for (i, model) in curves.iter().enumerate() {
        for branch in &model.branches {
            mark_speeds(&mut panel, &branch.points, colour(PLACE, i)?, i == 0);
        }
    }
    let mut kinds: Vec<Entry> = branches
        .iter()
        .enumerate()
        .map(|(i, name)| Entry::new(format!("{name} branch"), Ink::line(GREY, dash(i))))
        .collect();
    kinds.push(Entry::new("lowest wind speed", start_ink(GREY)));
    Sheet {
        name: PLACE,
        title: Some(title.to_owned()).filter(|t| !t.is_empty()),
        panels: vec![panel],
        columns: 1,
        axes: (600.0, 380.0),
        legend: vec![models, kinds],
    }
    .draw()
}

fn at(point: &ModePoint) -> (f64, f64) {
    (point.eigenvalue.re, point.eigenvalue.im)
}

fn start_ink(colour: &'static str) -> Ink {
    Ink::Dots {
        colour,
        shape: Shape::Circle,
        radius: 4.0,
        hollow: true,
    }
}

fn mark_speeds(panel: &mut Panel, points: &[ModePoint], colour: &'static str, written: bool) {
    let (Some(first), Some(last)) = (points.first(), points.len().checked_sub(1)) else {
        return;
    };
    let step = last.div_ceil(INTERVALS).max(1);
    let marked: Vec<&ModePoint> = points.iter().skip(step).step_by(step).collect();
    if !marked.is_empty() {
        let dots = marked.iter().map(|p| at(p)).collect();
        panel.add("wind speeds", dots, Ink::dots(colour, Shape::Circle));
    }
    panel.add("lowest wind speed", vec![at(first)], start_ink(colour));
    if written {
        for point in std::iter::once(&first).chain(&marked) {
            panel.notes.push(Note {
                at: at(point),
                text: format!("{} m/s", (point.speed_m_s * 100.0).round() / 100.0),
                colour,
            });
        }
    }
}
