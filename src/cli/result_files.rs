//! What stands behind the answer of a study: measured derivatives beside the models, curves as numbers, the motion below, at
//! and above the onset.

use super::figures;
use super::simulate::{motion_panels, simulated};
use super::vocabulary::{
    DerivativePlot, Dof, Error, Figure, FlutterStudy, OutputDir, PlottedSeries, Result, Study,
    TrainedModel, Verdict, csv_cell, derivative_lines,
};
use crate::aerodynamics::Transfer;
use crate::aerodynamics::derivatives::{Derivative, DerivativeTable};
use crate::flutter::{CriticalPoint, FlutterCurves, Onset};
use crate::report::{derivatives_figure, root_locus_figure, scaled_history_figure, vf_vg_figure};
use crate::study::{Deck, TrainedWithReport};
use crate::uncertainty::DerivativeInterval;
use crate::units::{SAME_SPEED, group_of, near_groups};
use std::collections::BTreeMap;

/// Force models that can be told apart in one figure.
const MAX_CURVES: usize = 7;
/// Stem of the figure of frequencies and damping ratios.
pub(super) const FIGURE: &str = "flutter";
/// Stem of the figure of derivatives.
pub(super) const DERIVATIVES: &str = "derivatives";
/// Stem of the figure of the motion around the onset.
pub(super) const RESPONSE: &str = "response";
/// Stem of the figure of eigenvalues.
pub(super) const ROOTS: &str = "roots";
/// The curves as numbers.
pub(super) const CURVES: &str = "curves.csv";
/// Wind speeds over the onset at which the motion is shown.
const AROUND_ONSET: [f64; 3] = [0.95, 1.0, 1.05];
/// Periods and samples of a period that are shown.
const PERIODS: (f64, f64) = (30.0, 24.0);

/// The title of a figure of models, which says how many of them are drawn where these are not all.
fn title_of_first(title: &str, models: usize) -> String {
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
    figures::outdated(FIGURE, out);
    if curves.is_empty() {
        return Err(Error::Numerical("no modes to draw".into()));
    }
    let draw = || of_first_models(curves, onsets, &study.name, verdict);
    figures::write(FIGURE, out, draw)
}

/// The figure of the models that can be told apart in it.
pub(super) fn of_first_models(
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

/// Frequencies and damping ratios over wind speed, one row per point, as CSV.
pub(super) fn curves_csv(name: &str, curves: &[FlutterCurves]) -> String {
    let mut text = format!(
        "# {}: modes over wind speed\n# generator: aerodeck {}\n# units: speed_m_s in m/s; frequency_hz in Hz; \
         damping_ratio of critical damping, negative when the motion grows; growth_rate_per_s in 1/s\n\
         model,branch,speed_m_s,frequency_hz,damping_ratio,growth_rate_per_s,in_tested_range\n",
        name.replace('\n', " "),
        env!("CARGO_PKG_VERSION")
    );
    for curve in curves {
        for branch in &curve.branches {
            for p in &branch.points {
                let tested = p.in_tested_range;
                let tested = tested.map_or("", |t| if t { "yes" } else { "no" });
                let (model, branch) = (csv_cell(&curve.model), &branch.name);
                let (speed, hertz, damping) = (p.speed_m_s, p.frequency_hz, p.damping_ratio);
                let growth = p.eigenvalue.re;
                text += &format!("{model},{branch},{speed},{hertz},{damping},{growth},{tested}\n");
            }
        }
    }
    text
}

/// Writes the curves and draws the root locus.
pub(super) fn write_curves(
    study: &Study,
    curves: &[FlutterCurves],
    out: &mut OutputDir,
) -> Result<()> {
    out.write(CURVES, curves_csv(&study.name, curves))?;
    figures::outdated(ROOTS, out);
    if curves.is_empty() {
        return Ok(());
    }
    let drawn = &curves[..curves.len().min(MAX_CURVES)];
    let title = format!("{}: eigenvalues as the wind rises", study.name);
    let title = title_of_first(&title, curves.len());
    figures::write(ROOTS, out, || root_locus_figure(drawn, &title))
}

/// Lines of all derivatives by their names: `V̂` and value.
pub(super) type NamedLines = Vec<(String, BTreeMap<Derivative, Vec<(f64, f64)>>)>;

/// A derivative as it was measured, in the models that were fitted to it, and by the theory of the deck, with the intervals of one model.
pub(super) fn beside_models(
    d: Derivative,
    table: Option<&DerivativeTable>,
    dofs: &[Dof],
    fitted: &NamedLines,
    exact: &NamedLines,
    intervals: &[DerivativeInterval],
) -> DerivativePlot {
    let own = intervals.iter().filter(|i| i.derivative == d);
    let inside = dofs.contains(&d.force()) && dofs.contains(&d.motion());
    let table = table.filter(|_| inside);
    DerivativePlot {
        name: d.name().to_owned(),
        measured: table.map_or(vec![], |table| measured(table, d)),
        bars: own.map(|i| (1.0 / i.k, i.low, i.high)).collect(),
        fitted: lines_of(fitted, d),
        reference: lines_of(exact, d),
    }
}

/// A panel for each derivative that is measured or fitted, over `V̂`.
pub(super) fn over_v_hat(
    title: &str,
    bars_label: &str,
    one: impl FnMut(Derivative) -> DerivativePlot,
) -> Result<Figure> {
    let mut all: Vec<DerivativePlot> = Derivative::ALL.into_iter().map(one).collect();
    all.retain(|d| !(d.measured.is_empty() && d.fitted.is_empty()));
    derivatives_figure(title, "V̂ = V/(ωB)", bars_label, &all)
}

/// The lines of one derivative.
pub(super) fn lines_of(all: &NamedLines, d: Derivative) -> Vec<PlottedSeries> {
    let named = all.iter();
    named
        .filter_map(|(name, lines)| Some(PlottedSeries::new(name, lines.get(&d)?.clone())))
        .collect()
}

/// The models beside the derivatives they were fitted to, with the intervals of the exported one.
pub(super) fn write_derivatives(
    study: &Study,
    deck: &Deck,
    trained: &[TrainedWithReport],
    out: &mut OutputDir,
) -> Result<()> {
    let mut fitted = Vec::new();
    for one in trained.iter().take(MAX_CURVES).map(|t| &t.model) {
        let lines = derivative_lines(&one.model, one.tested_range.min.v_hat())?;
        fitted.push((one.name.clone(), lines));
    }
    let (exact, range) = deck.model()?;
    let exact = match (range, trained.first()) {
        (None, Some(first)) => {
            let v_hat = first.model.tested_range.min.v_hat();
            let lines = derivative_lines(exact.as_ref(), v_hat)?;
            vec![("exact".to_owned(), lines)]
        }
        _ => Vec::new(),
    };
    let exported = &study.exported()?.name;
    let known = trained.iter().find(|t| t.model.name == *exported);
    let known = known.and_then(|t| t.uncertainty.as_ref().ok());
    let title = format!("{}: measured derivatives and models", study.name);
    let title = title_of_first(&title, trained.len());
    let intervals = known.map_or(&[][..], |known| &known.derivatives);
    let (table, dofs) = (deck.table(), study.section.dofs());
    let one = |d| beside_models(d, table, &dofs, &fitted, &exact, intervals);
    let bars = format!("95 % interval of {exported}");
    figures::write(DERIVATIVES, out, || over_v_hat(&title, &bars, one))
}

/// The test points of a derivative, one series per mean speed.
fn measured(table: &DerivativeTable, d: Derivative) -> Vec<PlottedSeries> {
    let points = table.points(d);
    let groups = near_groups(points.iter().filter_map(|p| p.mean_speed_m_s), SAME_SPEED);
    let of_group = |g: &Vec<f64>| {
        let mean = g.iter().sum::<f64>() / g.len() as f64;
        PlottedSeries::new(format!("measured, {mean:.1} m/s"), Vec::new())
    };
    let mut series: Vec<PlottedSeries> = groups.iter().map(of_group).collect();
    if series.is_empty() {
        series.push(PlottedSeries::new("measured", Vec::new()));
    }
    for p in points {
        let group = p.mean_speed_m_s.map_or(0, |v| group_of(&groups, v));
        series[group].points.push((p.v_hat, p.value));
    }
    series.retain(|s| !s.points.is_empty());
    series
}

/// The released section of the exported model below, at and above its onset.
pub(super) fn write_response(
    model: &TrainedModel,
    onset: &CriticalPoint,
    out: &mut OutputDir,
) -> Result<()> {
    let (speed_m_s, frequency_hz) = (onset.speed_m_s, onset.frequency_hz);
    let step = 1.0 / (PERIODS.1 * frequency_hz);
    let mut runs = Vec::with_capacity(AROUND_ONSET.len());
    for factor in AROUND_ONSET {
        let speed = factor * speed_m_s;
        let percent = (100.0 * (factor - 1.0_f64)).round();
        let label = match percent == 0.0 {
            true => format!("{speed:.1} m/s, the onset"),
            false => format!("{speed:.1} m/s ({percent:+} %)"),
        };
        let mut rows = Vec::new();
        simulated(model, speed, PERIODS.0 / frequency_hz, step, &mut rows)?;
        runs.push((label, rows));
    }
    let runs = runs.iter().map(|(label, rows)| (&label[..], &rows[..]));
    let panels = motion_panels(model.model.dofs(), &runs.collect::<Vec<_>>());
    let title = format!("{}: released below, at and above the onset", model.name);
    let draw = || scaled_history_figure(&title, &panels, "Time t (s)", 2);
    figures::write(RESPONSE, out, draw)
}
