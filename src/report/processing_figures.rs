//! The stages of processing of one run, one below the other: the whole run, and a few periods of it.

use super::axis::Axis;
use super::figure::Figure;
use super::legend::Entry;
use super::panel::Panel;
use super::sheet::Sheet;
use super::style::{BLACK, Ink, colour};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::wind_tunnel::processing::{RunReport, StageSignals};

const PLACE: &str = "processing of a run";
/// Periods in the right column.
const PERIODS: f64 = 3.0;

/// Force on the whole model in `dof` after every stage, the motion below; left the whole run with what was replaced shaded, right
/// a few periods around the first replaced stretch, or in the middle of the run.
///
/// # Errors
/// [`Error::Input`] for a run without stages or numbers that are not finite.
pub(crate) fn processing_figure(
    run: &RunReport,
    stages: &[StageSignals],
    dof: Dof,
) -> Result<Figure> {
    let Some(last) = stages.last() else {
        return Err(Error::input(PLACE, "stages", "none"));
    };
    let at = |d: Dof| Dof::THREE.iter().position(|x| *x == d).unwrap_or(0);
    let (force, motion) = (at(dof), at(run.dof));
    let rate = last.signals.sampling_hz;
    let count = last.signals.force[force].len();
    let points = |x: &[f64]| -> Vec<(f64, f64)> {
        x.iter()
            .enumerate()
            .map(|(k, v)| (k as f64 / rate, *v))
            .collect()
    };
    let whole = (0.0, count as f64 / rate);
    let close = close_up(run, whole);
    let shaded: Vec<(f64, f64)> = run
        .replaced
        .iter()
        .map(|r| (r.start_s, r.start_s + r.samples as f64 / rate))
        .collect();
    let unit = if dof == Dof::Torsion { "N·m" } else { "N" };
    let line = |i: usize| -> Result<Ink> {
        Ok(Ink::Line {
            colour: colour(PLACE, i)?,
            dash: None,
            width: 1.1,
        })
    };
    let mut panels = Vec::with_capacity(2 * stages.len() + 2);
    for stage in stages {
        let level = run.levels.iter().find(|l| l.stage == stage.stage);
        let samples = points(&stage.signals.force[force]);
        let mut left = panel("", force_name(dof, unit), whole, shaded.clone());
        left.title = Some(match level {
            Some(l) => format!(
                "{}: peak {:.4}, RMS {:.4} {unit}",
                stage.stage, l.peak[force], l.rms[force]
            ),
            None => stage.stage.clone(),
        });
        left.add(&stage.stage, samples.clone(), line(0)?);
        let mut right = panel("", String::new(), close, shaded.clone());
        right.add(&stage.stage, inside(&samples, close), line(0)?);
        panels.extend([left, right]);
    }
    let samples = points(&last.signals.motion[motion]);
    let unit = if run.dof == Dof::Torsion { "rad" } else { "m" };
    let label = format!("{} ({unit})", run.dof.symbol());
    let mut left = panel("t (s)", label, whole, Vec::new());
    left.title = Some(format!("{} motion", run.dof.name()));
    left.uprights = run
        .segments
        .iter()
        .map(|s| (s.segment.start_s, BLACK))
        .collect();
    left.add("motion", samples.clone(), line(1)?);
    let mut right = panel("t (s)", String::new(), close, Vec::new());
    right.add("motion", inside(&samples, close), line(1)?);
    panels.extend([left, right]);
    let legend = vec![
        Entry::new(force_of(dof), line(0)?),
        Entry::new(format!("{} motion", run.dof.name()), line(1)?),
    ];
    Sheet {
        name: PLACE,
        title: Some(format!("{}: {}, stage by stage", run.run, force_of(dof))),
        panels,
        columns: 2,
        axes: (400.0, 84.0),
        legend: vec![legend],
    }
    .draw()
}

fn panel(t: &str, label: String, range: (f64, f64), shaded: Vec<(f64, f64)>) -> Panel {
    let time = Axis {
        range: Some(range),
        ..Axis::new(t)
    };
    let mut panel = Panel::new(time, Axis::new(&label));
    panel.level = Some(0.0);
    panel.shaded = shaded
        .into_iter()
        .filter(|(a, b)| *b > range.0 && *a < range.1)
        .map(|(a, b)| (a.max(range.0), b.min(range.1)))
        .collect();
    panel
}

fn force_of(dof: Dof) -> &'static str {
    match dof {
        Dof::Vertical => "lift on the model",
        Dof::Lateral => "drag on the model",
        Dof::Torsion => "moment on the model",
    }
}

fn force_name(dof: Dof, unit: &str) -> String {
    let symbol = match dof {
        Dof::Vertical => "F_y",
        Dof::Lateral => "F_x",
        Dof::Torsion => "M",
    };
    format!("{symbol} ({unit})")
}

/// A few periods around what was replaced, or of the test point in the middle.
fn close_up(run: &RunReport, whole: (f64, f64)) -> (f64, f64) {
    let rate = run.sampling_hz;
    let first = run
        .replaced
        .first()
        .map(|r| r.start_s + 0.5 * r.samples as f64 / rate);
    let middle_of = |s: &crate::wind_tunnel::Segment| 0.5 * (s.start_s + s.end_s);
    let segment = match first {
        Some(t) => run
            .segments
            .iter()
            .find(|s| s.segment.start_s <= t && t <= s.segment.end_s),
        None => run.segments.get(run.segments.len() / 2),
    };
    let (centre, half) = match (first, segment) {
        (t, Some(s)) => (
            t.unwrap_or_else(|| middle_of(&s.segment)),
            0.5 * PERIODS / s.segment.frequency_hz,
        ),
        (Some(t), None) => (t, 1.0),
        (None, None) => (0.5 * (whole.0 + whole.1), 1.0),
    };
    ((centre - half).max(whole.0), (centre + half).min(whole.1))
}

fn inside(points: &[(f64, f64)], (from, to): (f64, f64)) -> Vec<(f64, f64)> {
    points
        .iter()
        .copied()
        .filter(|(t, _)| (from..=to).contains(t))
        .collect()
}
