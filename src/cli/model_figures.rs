//! Figures in which force models are compared: as many of them as can be told apart.

use super::figures;
use super::output::OutputDir;
use crate::error::{Error, Result};
use crate::flutter::{FlutterCurves, Onset};
use crate::report::{Figure, vf_vg_figure};
use crate::study::{FlutterStudy, Study};
use crate::verdict::Verdict;

/// Force models that can be told apart in one figure.
pub(crate) const MAX_CURVES: usize = 7;
/// Stem of the figure of frequencies and damping ratios.
pub(crate) const FIGURE: &str = "flutter";

/// The title of a figure of models, which says how many of them are drawn where these are not all.
pub(crate) fn title_of_first(title: &str, models: usize) -> String {
    match models > MAX_CURVES {
        true => format!("{title} (the first {MAX_CURVES} of {models} models)"),
        false => title.to_owned(),
    }
}

/// The V-f and V-g figure as SVG and PNG.
pub(crate) fn flutter_figure(
    study: &Study,
    results: &FlutterStudy,
    verdict: Option<&Verdict>,
    out: &mut OutputDir,
) -> Result<()> {
    let (curves, onsets) = (&results.curves, &results.onsets);
    if curves.is_empty() {
        return Err(Error::Numerical("no modes to draw".into()));
    }
    figures::write(FIGURE, out, || {
        of_first_models(curves, onsets, &study.name, verdict)
    })
}

/// The same figure for all routes.
pub(crate) fn routes_figure(
    study: &Study,
    curves: &[FlutterCurves],
    onsets: &[Onset],
    out: &mut OutputDir,
) -> Result<()> {
    let title = format!("{}: all routes", study.name);
    figures::write("routes", out, || {
        of_first_models(curves, onsets, &title, None)
    })
}

/// The figure of the models that can be told apart in it.
fn of_first_models(
    curves: &[FlutterCurves],
    onsets: &[Onset],
    title: &str,
    verdict: Option<&Verdict>,
) -> Result<Figure> {
    let title = title_of_first(title, curves.len());
    let (curves, others) = curves.split_at(curves.len().min(MAX_CURVES));
    let drawn = |o: &&Onset| others.iter().all(|c| c.model != o.at.model);
    let onsets: Vec<Onset> = onsets.iter().filter(drawn).cloned().collect();
    vf_vg_figure(curves, &onsets, &title, verdict)
}
