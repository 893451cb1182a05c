//! Frequencies and damping ratios over wind speed, with the onsets; eigenvalues as the wind speed rises.

use super::axis::significant;
use super::style::pale;
use super::vocabulary::{
    Axis, BLACK, Drawing, Entry, Figure, GREY, Ink, Note, PALE_GREY, Panel, Shape, branch_width,
    colour, dash, distinct, index_of, outcome_colour,
};
use crate::error::{Error, Result};
use crate::flutter::{FlutterCurves, ModeBranch, ModePoint, Onset, OnsetMethod};
use crate::verdict::{Outcome, Verdict};
use std::ops::Range;

/// Frequencies (Hz) and damping ratios (per cent of critical) of all modes over wind speed (m/s).
///
/// A colour and a line style per model, a line width per branch, so that print without colours tells them apart; onsets with the
/// bars of their intervals are marked on both panels and stated in the legend. An onset is
/// drawn in the colour of the curves of the same model, hollow when it lies outside the tested range; crossings
/// suspected to be spurious are crosses on the zero line. Where the reduced frequency of a mode lies outside the tested
/// range its curves are pale. The wind speed that `verdict` is against is a full upright line, with the outcome in words.
///
/// # Errors
/// [`Error::Input`] for no curves or non-finite ones, and for more models than colours.
pub fn vf_vg_figure(
    curves: &[FlutterCurves],
    onsets: &[Onset],
    title: &str,
    verdict: Option<&Verdict>,
) -> Result<Figure> {
    let mut diagram = VfVg::new(branch_names(curves)?);
    for (i, model) in curves.iter().enumerate() {
        diagram.draw_curves(model, i)?;
    }
    for onset in onsets {
        diagram.mark_onset(onset, colour_of(&onset.at.model, curves)?);
    }
    if let Some((required, outcome)) = verdict.and_then(|v| v.against.zip(v.outcome.as_ref())) {
        diagram.draw_required(required.speed_m_s, outcome);
    }
    diagram.spread_bars();
    diagram.explain_kinds(onsets);
    diagram.draw(title)
}

/// The panels of the diagrams, one below the other, and the groups of their legend.
struct VfVg {
    /// Names of the branches, which set the widths of lines.
    branches: Vec<String>,
    frequency: Panel,
    damping: Panel,
    /// Damping near zero.
    close: Panel,
    /// Whether some curve is pale.
    untested: bool,
    models: Vec<Entry>,
    kinds: Vec<Entry>,
    stated: Vec<Entry>,
}

impl VfVg {
    fn new(branches: Vec<String>) -> Self {
        let speed = |label: &str| Axis::new(label).tight();
        let damping = Axis {
            within: Some(DAMPING_WINDOW_PERCENT),
            ..Axis::new("Damping ratio ζ (%)")
        };
        let close = Axis {
            range: Some(NEAR_ZERO_PERCENT),
            ..Axis::new("ζ near zero (%)")
        };
        let about_zero = |x, y| Panel {
            level: Some(0.0),
            ..Panel::new(x, y)
        };
        Self {
            branches,
            frequency: Panel::new(speed(""), Axis::new("Frequency f (Hz)").zero_based()),
            damping: about_zero(speed(""), damping),
            close: about_zero(speed("Wind speed V (m/s)"), close),
            untested: false,
            models: Vec::new(),
            kinds: Vec::new(),
            stated: Vec::new(),
        }
    }

    fn panels(&mut self) -> [&mut Panel; 3] {
        [&mut self.frequency, &mut self.damping, &mut self.close]
    }

    /// All branches of the `i`-th model.
    fn draw_curves(&mut self, model: &FlutterCurves, i: usize) -> Result<()> {
        let colour = colour(PLACE, i)?;
        let entry = Entry::new(&model.model, Ink::line(colour, dash(i)));
        self.models.push(entry);
        for branch in &model.branches {
            let width = branch_width(index_of(&self.branches, &branch.name));
            let name = format!("{}, {}", model.model, ModeBranch::in_words(&branch.name));
            for (outside, run) in runs(&branch.points) {
                self.untested |= outside;
                let shade = if outside { pale(colour) } else { colour };
                let ink = Ink::stroke(shade, dash(i), width);
                let percent = points(run, |p| 100.0 * p.damping_ratio);
                for stretch in near_zero(&percent) {
                    self.close.add(&name, stretch, ink);
                }
                let hertz = points(run, |p| p.frequency_hz);
                self.frequency.add(&name, hertz, ink);
                self.damping.add(&name, percent, ink);
            }
        }
        Ok(())
    }

    /// An onset in all panels, with its interval, and in words.
    fn mark_onset(&mut self, onset: &Onset, colour: &'static str) {
        let (speed, hertz) = (onset.at.speed_m_s, onset.at.frequency_hz);
        for panel in self.panels() {
            panel.uprights.push((speed, colour));
        }
        self.draw_interval(onset, colour);
        let ink = onset_ink(onset, colour);
        let name = format!("onset of {}", onset.at.model);
        self.frequency.add(&name, vec![(speed, hertz)], ink);
        self.damping.add(&name, vec![(speed, 0.0)], ink);
        self.close.add("onset", vec![(speed, 0.0)], ink);
        self.note_onset(onset, colour);
        if !onset.spurious_speeds_m_s.is_empty() {
            let crosses = onset.spurious_speeds_m_s.iter();
            let crosses = crosses.map(|v| (*v, 0.0)).collect();
            let name = format!("spurious crossings of {}", onset.at.model);
            self.damping
                .add(name, crosses, Ink::dots(colour, Shape::Cross));
        }
        self.stated.push(Entry::new(statement(onset), ink));
    }

    /// The bar of the interval; the onset of the FMU has that of its model, which is drawn already.
    fn draw_interval(&mut self, onset: &Onset, colour: &'static str) {
        let stepped = onset.at.method == OnsetMethod::FmuStepping;
        if let Some((low_m_s, high_m_s)) = onset.interval.ends().filter(|_| !stepped) {
            let bar = vec![(low_m_s, 0.0), (high_m_s, 0.0)];
            self.close.add(BAR, bar, Ink::solid(colour, BAR_WIDTH));
        }
    }

    /// Puts the bars below the zero line, one under the other, the closer the more there are.
    fn spread_bars(&mut self) {
        let all = self.close.series.iter_mut().filter(|s| s.name == BAR);
        let bars: Vec<_> = all.collect();
        let gaps = bars.len().saturating_sub(1).max(1) as f64;
        let step = BAR_STEP_PERCENT.min((LAST_BAR_PERCENT - FIRST_BAR_PERCENT) / gaps);
        for (i, bar) in bars.into_iter().enumerate() {
            let level = -(FIRST_BAR_PERCENT + step * i as f64);
            bar.points.iter_mut().for_each(|point| point.1 = level);
        }
    }

    /// Frequency and speed beside the markers; the same number of the same model by another route says nothing new.
    fn note_onset(&mut self, onset: &Onset, colour: &'static str) {
        let (speed, hertz) = (onset.at.speed_m_s, onset.at.frequency_hz);
        let note = |y: f64, text: String| Note {
            at: (speed, y),
            text,
            colour,
        };
        let at_speed = note(0.0, format!("{} m/s", significant(speed)));
        let already_there = |n: &Note| n.text == at_speed.text && n.colour == colour;
        if !self.damping.notes.iter().any(already_there) {
            let at_frequency = note(hertz, format!("{} Hz", significant(hertz)));
            self.frequency.notes.push(at_frequency);
            self.damping.notes.push(at_speed);
        }
    }

    /// The upright line that the onset has to exceed, over the height of each panel.
    fn draw_required(&mut self, speed_m_s: f64, outcome: &Outcome) {
        let ink = Ink::solid(outcome_colour(outcome), 1.6);
        let drawn = self.frequency.series.iter().flat_map(|s| &s.points);
        let highest = drawn.map(|p| p.1).fold(0.0, f64::max);
        let heights = [(0.0, highest), DAMPING_WINDOW_PERCENT, NEAR_ZERO_PERCENT];
        for (panel, (from, to)) in self.panels().into_iter().zip(heights) {
            let line = vec![(speed_m_s, from), (speed_m_s, to)];
            panel.add("required", line, ink);
        }
        let (speed, words) = (significant(speed_m_s), outcome.words());
        let text = format!("required {speed} m/s: {words}");
        self.models.push(Entry::new(text, ink));
    }

    /// What widths, markers and pale lines stand for, as far as they are drawn.
    fn explain_kinds(&mut self, onsets: &[Onset]) {
        let mut add = |text: &str, ink| self.kinds.push(Entry::new(text, ink));
        for (i, name) in self.branches.iter().enumerate() {
            let ink = Ink::solid(GREY, branch_width(i));
            add(&ModeBranch::in_words(name), ink);
        }
        if onsets.iter().any(|o| !o.spurious_speeds_m_s.is_empty()) {
            let ink = Ink::dots(GREY, Shape::Cross);
            add("probably spurious crossing", ink);
        }
        if onsets.iter().any(|o| o.in_tested_range == Some(false)) {
            let ink = onset_marker(GREY, Shape::Circle, true);
            add("onset outside the tested range", ink);
        }
        if self.close.series.iter().any(|s| s.name == BAR) {
            add("interval of the onset", Ink::solid(GREY, BAR_WIDTH));
        }
        if self.untested {
            let ink = Ink::line(PALE_GREY, None);
            add("pale: K = ωB/V outside the tested range", ink);
        }
    }

    /// The panel near zero is left out when no curve comes there.
    fn draw(self, title: &str) -> Result<Figure> {
        let mut panels = vec![self.frequency, self.damping];
        panels.extend(Some(self.close).filter(|p| !p.series.is_empty()));
        let legend = vec![self.models, self.kinds, self.stated];
        Drawing::stacked(PLACE, title, panels, 210.0, legend)
    }
}

const PLACE: &str = "V-f and V-g diagram";
/// Beyond, the heavily damped heaving branch would hide the crossing.
const DAMPING_WINDOW_PERCENT: (f64, f64) = (-10.0, 20.0);
/// A growth of half a per cent below the onset is a finding, and a hair's breadth in the panel above.
const NEAR_ZERO_PERCENT: (f64, f64) = (-1.0, 1.0);

/// Name of the bars of intervals, and where they are drawn: below the zero line, one under the other.
const BAR: &str = "interval of the onset";
const FIRST_BAR_PERCENT: f64 = 0.25;
const LAST_BAR_PERCENT: f64 = 0.9;
const BAR_STEP_PERCENT: f64 = 0.15;
const BAR_WIDTH: f64 = 3.5;

/// The stretches of a line in the window around zero, with the points on either side that lead out of it.
fn near_zero(points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
    let inside = |p: &(f64, f64)| p.1.abs() <= 2.0 * NEAR_ZERO_PERCENT.1;
    let near = stretches(points, inside).filter(|(_, inside)| *inside);
    near.map(|(at, _)| joined(points, at).to_vec()).collect()
}

/// Stretches of points that are such or not, by their places.
fn stretches<T>(
    points: &[T],
    is_such: impl Fn(&T) -> bool + Copy,
) -> impl Iterator<Item = (Range<usize>, bool)> {
    let mut to = 0;
    let runs = points.chunk_by(move |a, b| is_such(a) == is_such(b));
    runs.map(move |run| {
        let from = to;
        to += run.len();
        (from..to, is_such(&run[0]))
    })
}

/// A stretch with the points on either side.
fn joined<T>(points: &[T], at: Range<usize>) -> &[T] {
    &points[at.start.saturating_sub(1)..points.len().min(at.end + 1)]
}

/// Names of the branches of all models, each once, in the order of their first appearance.
pub(super) fn branch_names(curves: &[FlutterCurves]) -> Result<Vec<String>> {
    let names = distinct(curves.iter().flat_map(|c| &c.branches).map(|b| &b.name));
    if names.is_empty() {
        return Err(Error::input("flutter curves", "at least one mode", "none"));
    }
    Ok(names)
}

/// Stretches of a branch outside and inside the tested range, those outside first and up to their neighbours inside.
fn runs(points: &[ModePoint]) -> Vec<(bool, &[ModePoint])> {
    if points.is_empty() {
        // to be refused by name
        return vec![(false, points)];
    }
    let outside = |p: &ModePoint| p.in_tested_range == Some(false);
    let run = |(at, outside): (Range<usize>, bool)| match outside {
        true => (true, joined(points, at)),
        false => (false, &points[at]),
    };
    let mut all: Vec<_> = stretches(points, outside).map(run).collect();
    all.sort_by_key(|(outside, _)| !outside);
    all
}

fn points(modes: &[ModePoint], value: impl Fn(&ModePoint) -> f64) -> Vec<(f64, f64)> {
    modes.iter().map(|p| (p.speed_m_s, value(p))).collect()
}

/// Colour of the curves of a model; grey when it has none.
fn colour_of(model: &str, curves: &[FlutterCurves]) -> Result<&'static str> {
    match curves.iter().position(|c| c.model == model) {
        Some(i) => colour(PLACE, i),
        None => Ok(GREY),
    }
}

fn onset_ink(onset: &Onset, colour: &'static str) -> Ink {
    let shape = match onset.at.method {
        OnsetMethod::Eigenvalues => Shape::Circle,
        OnsetMethod::Determinant => Shape::Diamond,
        OnsetMethod::FmuStepping => Shape::Square,
        OnsetMethod::PkIteration => Shape::Cross,
    };
    onset_marker(colour, shape, onset.in_tested_range == Some(false))
}

fn onset_marker(colour: &'static str, shape: Shape, hollow: bool) -> Ink {
    Ink {
        size: 4.5,
        hollow,
        ..Ink::dots(colour, shape)
    }
}

/// The onset in words, for the legend; numbers first, as the middle of a line that is too long is left out.
fn statement(onset: &Onset) -> String {
    let (at, branch) = (&onset.at, ModeBranch::in_words(&onset.branch));
    let [speed, hertz, v_star] =
        [at.speed_m_s, at.frequency_hz, at.reduced_velocity.v_star()].map(significant);
    let (model, method) = (&at.model, at.method.name());
    format!(
        "Onset V = {speed} m/s, f = {hertz} Hz, V/(fB) = {v_star}: {model}, {branch} ({method})"
    )
}

const ROOTS: &str = "root locus";

/// Growth rate (1/s) against frequency (Hz) of the eigenvalues of `branches`, each with an ink of its own, as the wind speed rises: right of the
/// zero line motions grow.
pub(super) fn root_locus<'a>(
    branches: impl IntoIterator<Item = (&'a ModeBranch, Ink)>,
    title: &str,
    legend: Vec<Entry>,
) -> Result<Figure> {
    let frequency = Axis::new("Frequency (Hz)").zero_based();
    let mut panel = Panel::new(Axis::new("Growth rate (1/s)"), frequency);
    panel.uprights.push((0.0, BLACK));
    for (branch, ink) in branches {
        let points = branch.points.iter();
        let places = points.map(|p| (p.eigenvalue.re, p.frequency_hz));
        panel.add(&branch.name, places.collect(), ink);
    }
    Drawing::stacked(ROOTS, title, vec![panel], 260.0, vec![legend])
}

/// That of a section: a colour per model, a width per branch.
pub(crate) fn root_locus_figure(curves: &[FlutterCurves], title: &str) -> Result<Figure> {
    let branches = branch_names(curves)?;
    let mut drawn = Vec::new();
    let mut models = Vec::new();
    for (i, model) in curves.iter().enumerate() {
        let colour = colour(ROOTS, i)?;
        models.push(Entry::new(&model.model, Ink::line(colour, dash(i))));
        for branch in model.branches.iter().filter(|b| !b.points.is_empty()) {
            let width = branch_width(index_of(&branches, &branch.name));
            drawn.push((branch, Ink::stroke(colour, dash(i), width)));
        }
    }
    root_locus(drawn, title, models)
}
