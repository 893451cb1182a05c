//! The eigenvalues of all modes as the wind speed rises: growth rate (1/s) against frequency (Hz). Right of the zero line motions
//! grow.

use super::axis::Axis;
use super::drawing::Drawing;
use super::figure::Figure;
use super::flutter_figures::branch_names;
use super::legend::Entry;
use super::panel::Panel;
use super::series::index_of;
use super::style::{BLACK, Ink, branch_width, colour, dash};
use crate::error::Result;
use crate::flutter::{FlutterCurves, ModeBranch};

const PLACE: &str = "root locus";

/// The figure of branches, each with an ink of its own.
pub(super) fn root_locus<'a>(
    branches: impl IntoIterator<Item = (&'a ModeBranch, Ink)>,
    title: &str,
    legend: Vec<Entry>,
) -> Result<Figure> {
    let mut panel = Panel::new(
        Axis::new("Growth rate (1/s)"),
        Axis::new("Frequency (Hz)").zero_based(),
    );
    panel.uprights.push((0.0, BLACK));
    for (branch, ink) in branches {
        let points = branch.points.iter();
        let places = points.map(|p| (p.eigenvalue.re, p.frequency_hz));
        panel.add(&branch.name, places.collect(), ink);
    }
    Drawing::stacked(PLACE, title, vec![panel], 260.0, vec![legend])
}

/// That of a section: a colour per model, a width per branch.
pub(crate) fn root_locus_figure(curves: &[FlutterCurves], title: &str) -> Result<Figure> {
    let branches = branch_names(curves)?;
    let mut drawn = Vec::new();
    let mut models = Vec::new();
    for (i, model) in curves.iter().enumerate() {
        let colour = colour(PLACE, i)?;
        models.push(Entry::new(&model.model, Ink::line(colour, dash(i))));
        for branch in model.branches.iter().filter(|b| !b.points.is_empty()) {
            let width = branch_width(index_of(&branches, &branch.name));
            drawn.push((branch, Ink::stroke(colour, dash(i), width)));
        }
    }
    root_locus(drawn, title, models)
}
