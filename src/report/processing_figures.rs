//! The stages of processing of one run, one below the other: the whole run, and a few periods of it.

use super::vocabulary::{Axis, BLACK, Drawing, Entry, Figure, Ink, Panel, Series, colour};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::wind_tunnel::processing::{RunReport, SectionSignals, StageLevels};
use std::ops::Range;

const PLACE: &str = "processing of a run";
/// Periods in the right column.
const PERIODS: f64 = 3.0;

/// Force on the whole model in `dof` after every stage, the motion below; left the whole run with what was replaced shaded, right
/// a few periods around the first replaced stretch, or in the middle of the run.
///
/// # Errors
/// [`Error::Input`] for a run without stages or numbers that are not finite.
pub(crate) fn processing_figure(run: &RunReport, stages: &[SectionSignals]) -> Result<Figure> {
    let Some(last) = stages.last() else {
        return Err(Error::input(PLACE, "stages", "none"));
    };
    let (dof, driven) = (run.dof, run.dof as usize);
    let rate = last.sampling_hz;
    let points = |x: &[f64]| -> Vec<(f64, f64)> {
        let samples = x.iter().enumerate();
        samples.map(|(k, v)| (k as f64 / rate, *v)).collect()
    };
    let whole = 0.0..last.force[driven].len() as f64 / rate;
    let windows = [whole.clone(), close_up(run, whole)];
    let replaced = run.replaced.iter();
    let shaded = replaced.map(|r| (r.start_s, r.start_s + r.samples as f64 / rate));
    let shaded: Vec<(f64, f64)> = shaded.collect();
    let force_ink = Ink::stroke(colour(PLACE, 0)?, None, 1.1);
    let motion_ink = Ink::stroke(colour(PLACE, 1)?, None, 1.1);
    let mut panels = Vec::with_capacity(2 * stages.len() + 2);
    for (levels, signals) in run.levels.iter().zip(stages) {
        let signal = Series {
            name: levels.stage.clone(),
            points: points(&signals.force[driven]),
            ink: force_ink,
        };
        let axes = [Axis::new(""), Axis::new(force_label(dof))];
        let [mut left, right] = pair(&windows, &shaded, axes, signal);
        left.title = Some(stage_title(levels, dof));
        panels.extend([left, right]);
    }
    let motion_name = format!("{} motion", dof.name());
    let unit = if dof == Dof::Torsion { "rad" } else { "m" };
    let label = format!("{} ({unit})", dof.symbol());
    let signal = Series {
        name: "motion".into(),
        points: points(&last.motion[driven]),
        ink: motion_ink,
    };
    let axes = [Axis::new("t (s)"), Axis::new(label)];
    let [mut left, right] = pair(&windows, &[], axes, signal);
    left.title = Some(motion_name.clone());
    let starts = run.segments.iter().map(|s| s.segment.start_s);
    left.uprights = starts.map(|t| (t, BLACK)).collect();
    panels.extend([left, right]);
    let force_name = format!("{} on the model", dof.force_name());
    let legend = vec![
        Entry::new(&force_name, force_ink),
        Entry::new(motion_name, motion_ink),
    ];
    Drawing {
        name: PLACE,
        title: Some(format!("{}: {force_name}, stage by stage", run.run)),
        panels,
        columns: 2,
        axes: [400.0, 84.0],
        legend: vec![legend],
    }
    .draw()
}

/// One signal over the whole run, and close up; axes of time and of the signal.
fn pair(
    windows: &[Range<f64>; 2],
    shaded: &[(f64, f64)],
    [time, y]: [Axis; 2],
    signal: Series,
) -> [Panel; 2] {
    let [whole, close] = windows;
    let part = |range: &Range<f64>, y: Axis| {
        let mut panel = Panel::new(time.clone(), y);
        panel.x.range = Some((range.start, range.end));
        panel.level = Some(0.0);
        panel.shaded = shaded.to_vec();
        panel
    };
    let mut right = part(close, Axis::new(""));
    let inside = |p: &&(f64, f64)| close.start <= p.0 && p.0 <= close.end;
    let points = signal.points.iter().filter(inside).copied().collect();
    right.add(&signal.name, points, signal.ink);
    let mut left = part(whole, y);
    left.series.push(signal);
    [left, right]
}

/// The stage with what is left of the force after it.
fn stage_title(levels: &StageLevels, dof: Dof) -> String {
    let (peak, rms) = (levels.peak[dof as usize], levels.rms[dof as usize]);
    let unit = force_unit(dof);
    format!("{}: peak {peak:.4}, RMS {rms:.4} {unit}", levels.stage)
}

fn force_unit(dof: Dof) -> &'static str {
    if dof == Dof::Torsion { "N·m" } else { "N" }
}

fn force_label(dof: Dof) -> String {
    let symbol = match dof {
        Dof::Vertical => "F_y",
        Dof::Lateral => "F_x",
        Dof::Torsion => "M",
    };
    format!("{symbol} ({})", force_unit(dof))
}

/// A few periods around what was replaced, or of the test point in the middle.
fn close_up(run: &RunReport, whole: Range<f64>) -> Range<f64> {
    let rate = run.sampling_hz;
    let first = run.replaced.first();
    let first = first.map(|r| r.start_s + 0.5 * r.samples as f64 / rate);
    let mut segments = run.segments.iter().map(|s| &s.segment);
    let segment = match first {
        Some(t) => segments.find(|s| s.start_s <= t && t <= s.end_s),
        None => segments.nth(run.segments.len() / 2),
    };
    let middle = match segment {
        Some(s) => 0.5 * (s.start_s + s.end_s),
        None => 0.5 * (whole.start + whole.end),
    };
    let centre = first.unwrap_or(middle);
    let half = segment.map_or(1.0, |s| 0.5 * PERIODS / s.frequency_hz);
    (centre - half).max(whole.start)..(centre + half).min(whole.end)
}
