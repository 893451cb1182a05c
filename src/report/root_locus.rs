//! The eigenvalues of all modes as the wind speed rises: growth rate (1/s) against frequency (Hz). Right of the zero line motions
//! grow.

use super::axis::Axis;
use super::drawing::{Drawing, titled};
use super::figure::Figure;
use super::flutter_figures::branch_names;
use super::legend::Entry;
use super::panel::Panel;
use super::series::index_of;
use super::style::{BLACK, Ink, branch_width, colour, dash};
use crate::error::Result;
use crate::flutter::{FlutterCurves, ModeBranch};

const PLACE: &str = "root locus";

/// The figure of a section or of a bridge in the making.
pub(super) struct RootLocus(Panel);

impl RootLocus {
    pub(super) fn new() -> Self {
        let mut panel = Panel::new(
            Axis::new("Growth rate (1/s)"),
            Axis::new("Frequency (Hz)").zero_based(),
        );
        panel.uprights.push((0.0, BLACK));
        Self(panel)
    }

    pub(super) fn add(&mut self, branch: &ModeBranch, ink: Ink) {
        let places = branch
            .points
            .iter()
            .map(|p| (p.eigenvalue.re, p.frequency_hz));
        self.0.add(&branch.name, places.collect(), ink);
    }

    pub(super) fn draw(self, title: &str, legend: Vec<Vec<Entry>>) -> Result<Figure> {
        Drawing {
            name: PLACE,
            title: titled(title),
            panels: vec![self.0],
            columns: 1,
            axes: (640.0, 260.0),
            legend,
        }
        .draw()
    }
}

/// That of a section: a colour per model, a width per branch.
pub(crate) fn root_locus_figure(curves: &[FlutterCurves], title: &str) -> Result<Figure> {
    let branches = branch_names(curves)?;
    let mut roots = RootLocus::new();
    let mut models = Vec::new();
    for (i, model) in curves.iter().enumerate() {
        let colour = colour(PLACE, i)?;
        models.push(Entry::new(&model.model, Ink::line(colour, dash(i))));
        for branch in model.branches.iter().filter(|b| !b.points.is_empty()) {
            let width = branch_width(index_of(&branches, &branch.name));
            roots.add(branch, Ink::stroke(colour, dash(i), width));
        }
    }
    roots.draw(title, vec![models])
}
