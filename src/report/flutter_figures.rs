//! Frequencies and damping ratios over wind speed, with the onsets.

use super::axis::{Axis, significant};
use super::figure::Figure;
use super::legend::Entry;
use super::panel::{Note, Panel};
use super::series::index_of;
use super::sheet::Sheet;
use super::style::{BLACK, GREY, Ink, PALE_GREY, Shape, branch_width, colour, dash, pale};
use crate::error::{Error, Result};
use crate::flutter::{FlutterCurves, ModePoint, Onset, OnsetInterval, OnsetMethod};

/// What may be added to the V-f and V-g diagrams.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VfVgOptions {
    /// Line above the figure.
    pub title: Option<String>,
    /// Wind speeds between which the models rest on tests, m/s; outside, the panels are shaded.
    pub tested_speeds_m_s: Option<(f64, f64)>,
    /// Ends of the axis of the damping ratio, per cent; without them the data between −10 and 20, because beyond, the
    /// heavily damped heaving branch would hide the crossing.
    pub damping_range_percent: Option<(f64, f64)>,
    /// Wind speed that the onset has to exceed, m/s, as a full upright line.
    pub required_speed_m_s: Option<f64>,
}

/// Frequencies (Hz) and damping ratios (per cent of critical) of all modes over wind speed (m/s).
///
/// A colour and a line style a model, a line width a branch, so that print without colours tells them apart; onsets with the
/// bars of their intervals are marked on both panels and stated in the legend. An onset is
/// drawn in the colour of the curves of the same model, hollow when it lies outside the tested range; crossings
/// suspected to be spurious are crosses on the zero line. Where the reduced frequency of a mode lies outside the tested
/// range its curves are pale.
///
/// # Errors
/// [`Error::Input`] for no curves or non-finite ones, and for more models than colours.
pub fn vf_vg_figure(
    curves: &[FlutterCurves],
    onsets: &[Onset],
    options: &VfVgOptions,
) -> Result<Figure> {
    let branches = branch_names(curves)?;
    let speed = || Axis::new("Wind speed V (m/s)").tight();
    let mut upright = Vec::new();
    let mut frequency = Panel::new(
        Axis {
            label: String::new(),
            ..speed()
        },
        Axis::new("Frequency f (Hz)").zero_based(),
    );
    let mut damping = Panel::new(speed(), Axis::new("Damping ratio ζ (%)"));
    damping.level = Some(0.0);
    damping.y.within = Some(DAMPING_WINDOW_PERCENT);
    damping.y.range = options.damping_range_percent;
    let mut close = damping.clone();
    close.x.label = "Wind speed V (m/s)".to_owned();
    close.y = Axis::new("ζ near zero (%)");
    close.y.range = Some(NEAR_ZERO_PERCENT);
    damping.x.label = String::new();
    let mut models = Vec::new();
    let mut untested = false;
    for (i, model) in curves.iter().enumerate() {
        let colour = colour(PLACE, i)?;
        models.push(Entry::new(&model.model, Ink::line(colour, dash(i))));
        for branch in &model.branches {
            let width = branch_width(index_of(&branches, &branch.name));
            let name = format!("{}, {} branch", model.model, branch.name);
            for (outside, run) in runs(&branch.points) {
                untested |= outside;
                let shade = if outside { pale(colour) } else { colour };
                let ink = Ink::Line {
                    colour: shade,
                    dash: dash(i),
                    width,
                };
                frequency.add(&name, points(run, |p| p.frequency_hz), ink);
                let percent = points(run, |p| 100.0 * p.damping_ratio);
                for stretch in near_zero(&percent) {
                    close.add(&name, stretch, ink);
                }
                damping.add(&name, percent, ink);
            }
        }
    }
    let mut stated = Vec::new();
    for onset in onsets {
        let colour = colour_of(&onset.at.model, curves)?;
        upright.push((onset.at.speed_m_s, colour));
        mark_onset((&mut frequency, &mut damping, &mut close), onset, colour);
        stated.push(Entry::new(statement(onset), onset_ink(onset, colour)));
    }
    if let Some(required) = options.required_speed_m_s {
        let (low, high) = DAMPING_WINDOW_PERCENT;
        let highest = |p: &Panel| {
            let points = p.series.iter().flat_map(|s| &s.points);
            points.map(|p| p.1).fold(0.0, f64::max)
        };
        let to = highest(&frequency);
        for (panel, from, to) in [
            (&mut frequency, 0.0, to),
            (&mut damping, low, high),
            (&mut close, NEAR_ZERO_PERCENT.0, NEAR_ZERO_PERCENT.1),
        ] {
            panel.add("required", vec![(required, from), (required, to)], REQUIRED);
        }
        let text = format!("required onset above {} m/s", significant(required));
        models.push(Entry::new(text, REQUIRED));
    }
    frequency.uprights.clone_from(&upright);
    close.uprights.clone_from(&upright);
    damping.uprights = upright;
    let mut kinds: Vec<Entry> = branches
        .iter()
        .enumerate()
        .map(|(i, name)| {
            let ink = Ink::Line {
                colour: GREY,
                dash: None,
                width: branch_width(i),
            };
            Entry::new(format!("{name} branch"), ink)
        })
        .collect();
    if onsets.iter().any(|o| !o.spurious_speeds_m_s.is_empty()) {
        kinds.push(Entry::new(
            "probably spurious crossing",
            Ink::dots(GREY, Shape::Cross),
        ));
    }
    if onsets.iter().any(|o| o.in_tested_range == Some(false)) {
        kinds.push(Entry::new(
            "onset outside the tested range",
            Ink::Dots {
                colour: GREY,
                shape: Shape::Circle,
                radius: 4.5,
                hollow: true,
            },
        ));
    }
    if close.series.iter().any(|s| s.name == BAR) {
        let ink = Ink::Line {
            colour: GREY,
            dash: None,
            width: 3.5,
        };
        kinds.push(Entry::new("interval of the onset", ink));
    }
    if untested {
        kinds.push(Entry::new(
            "pale: K = ωB/V outside the tested range",
            Ink::line(PALE_GREY, None),
        ));
    }
    if let Some(tested) = options.tested_speeds_m_s {
        shade_untested(&mut [&mut frequency, &mut damping, &mut close], tested)?;
        kinds.push(Entry::new("wind speed outside the tests", Ink::Shade));
    }
    Sheet {
        name: PLACE,
        title: options.title.clone(),
        panels: if close.series.is_empty() {
            vec![frequency, damping]
        } else {
            vec![frequency, damping, close]
        },
        columns: 1,
        axes: (640.0, 210.0),
        legend: vec![models, kinds, stated],
    }
    .draw()
}

const PLACE: &str = "V-f and V-g diagram";
const REQUIRED: Ink = Ink::Line {
    colour: BLACK,
    dash: None,
    width: 1.6,
};
const DAMPING_WINDOW_PERCENT: (f64, f64) = (-10.0, 20.0);
/// A growth of half a per cent below the onset is a finding, and a hair's breadth in the panel above.
const NEAR_ZERO_PERCENT: (f64, f64) = (-1.0, 1.0);

/// Name of the bars of intervals, and where they are drawn: below the zero line, one under the other.
const BAR: &str = "interval of the onset";
const FIRST_BAR_PERCENT: f64 = 0.25;
const BAR_STEP_PERCENT: f64 = 0.15;

/// The stretches of a line in the window around zero, with the points on either side that lead out of it.
fn near_zero(points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
    let inside = |y: f64| y.abs() <= 2.0 * NEAR_ZERO_PERCENT.1;
    let mut all = Vec::new();
    let mut from = 0;
    for run in points.chunk_by(|a, b| inside(a.1) == inside(b.1)) {
        let to = from + run.len();
        if inside(run[0].1) {
            all.push(points[from.saturating_sub(1)..points.len().min(to + 1)].to_vec());
        }
        from = to;
    }
    all
}

/// Names of the branches of all models, each once, in the order of their first appearance.
pub(super) fn branch_names(curves: &[FlutterCurves]) -> Result<Vec<String>> {
    let mut names: Vec<String> = Vec::new();
    for branch in curves.iter().flat_map(|c| &c.branches) {
        if !names.contains(&branch.name) {
            names.push(branch.name.clone());
        }
    }
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
    let (mut pale, mut full) = (Vec::new(), Vec::new());
    let mut from = 0;
    for run in points.chunk_by(|a, b| outside(a) == outside(b)) {
        let to = from + run.len();
        if outside(&run[0]) {
            let joined = from.saturating_sub(1)..points.len().min(to + 1);
            pale.push((true, &points[joined]));
        } else {
            full.push((false, run));
        }
        from = to;
    }
    pale.extend(full);
    pale
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
    Ink::Dots {
        colour,
        shape: match onset.at.method {
            OnsetMethod::Eigenvalues => Shape::Circle,
            OnsetMethod::Determinant => Shape::Diamond,
            OnsetMethod::FmuStepping => Shape::Square,
            OnsetMethod::PkIteration => Shape::Cross,
        },
        radius: 4.5,
        hollow: onset.in_tested_range == Some(false),
    }
}

fn mark_onset(
    (frequency, damping, close): (&mut Panel, &mut Panel, &mut Panel),
    onset: &Onset,
    colour: &'static str,
) {
    let again = onset.at.method == OnsetMethod::FmuStepping;
    let bar = match onset.interval {
        // that of the model, which is drawn already
        _ if again => vec![],
        OnsetInterval::Known {
            low_m_s, high_m_s, ..
        }
        | OnsetInterval::Spread {
            low_m_s, high_m_s, ..
        } => {
            let bars = close.series.iter().filter(|s| s.name == BAR).count();
            let level =
                -(FIRST_BAR_PERCENT + BAR_STEP_PERCENT * bars as f64).min(-NEAR_ZERO_PERCENT.0);
            vec![(low_m_s, level), (high_m_s, level)]
        }
        OnsetInterval::Undetermined { .. } | OnsetInterval::None { .. } => vec![],
    };
    if !bar.is_empty() {
        let ink = Ink::Line {
            colour,
            dash: None,
            width: 3.5,
        };
        close.add(BAR, bar, ink);
    }
    let marker = onset_ink(onset, colour);
    close.add("onset", vec![(onset.at.speed_m_s, 0.0)], marker);
    let name = format!("onset of {}", onset.at.model);
    let at_frequency = (onset.at.speed_m_s, onset.at.frequency_hz);
    let at_zero = (onset.at.speed_m_s, 0.0);
    frequency.add(&name, vec![at_frequency], onset_ink(onset, colour));
    damping.add(&name, vec![at_zero], onset_ink(onset, colour));
    let note = |panel: &mut Panel, at, text| panel.notes.push(Note { at, text, colour });
    let hertz = format!("{} Hz", significant(onset.at.frequency_hz));
    let speed = format!("{} m/s", significant(onset.at.speed_m_s));
    // the same number of the same model by another route says nothing new
    if !damping
        .notes
        .iter()
        .any(|n| n.text == speed && n.colour == colour)
    {
        note(frequency, at_frequency, hertz);
        note(damping, at_zero, speed);
    }
    if !onset.spurious_speeds_m_s.is_empty() {
        let crosses = onset.spurious_speeds_m_s.iter().map(|v| (*v, 0.0));
        damping.add(
            format!("spurious crossings of {}", onset.at.model),
            crosses.collect(),
            Ink::dots(colour, Shape::Cross),
        );
    }
}

/// The onset in words, for the legend.
fn statement(onset: &Onset) -> String {
    format!(
        "Onset {}: V = {} m/s, f = {} Hz, V/(fB) = {}, {} branch ({})",
        onset.at.model,
        significant(onset.at.speed_m_s),
        significant(onset.at.frequency_hz),
        significant(onset.at.reduced_velocity.v_star()),
        onset.branch,
        onset.at.method.name(),
    )
}

/// The eigenvalues of all modes as the wind speed rises: growth rate (1/s) against frequency (Hz). Right of the zero line
/// motions grow.
pub(crate) fn root_locus_figure(curves: &[FlutterCurves], title: &str) -> Result<Figure> {
    let branches = branch_names(curves)?;
    let mut panel = Panel::new(
        Axis::new("Growth rate (1/s)"),
        Axis::new("Frequency (Hz)").zero_based(),
    );
    panel.uprights.push((0.0, BLACK));
    let mut models = Vec::new();
    for (i, model) in curves.iter().enumerate() {
        let colour = colour(PLACE, i)?;
        models.push(Entry::new(&model.model, Ink::line(colour, dash(i))));
        for branch in model.branches.iter().filter(|b| !b.points.is_empty()) {
            let ink = Ink::Line {
                colour,
                dash: dash(i),
                width: branch_width(index_of(&branches, &branch.name)),
            };
            let place = |p: &ModePoint| (p.eigenvalue.re, p.frequency_hz);
            panel.add(&branch.name, branch.points.iter().map(place).collect(), ink);
        }
    }
    Sheet {
        name: "root locus",
        title: Some(title.to_owned()),
        panels: vec![panel],
        columns: 1,
        axes: (640.0, 260.0),
        legend: vec![models],
    }
    .draw()
}

fn shade_untested(panels: &mut [&mut Panel], (low, high): (f64, f64)) -> Result<()> {
    if !(low.is_finite() && high.is_finite() && low < high) {
        return Err(Error::input(
            "tested wind speeds",
            "a lower and a higher one",
            format!("{low} to {high}"),
        ));
    }
    for panel in panels {
        panel.shaded = vec![(f64::MIN, low), (high, f64::MAX)];
    }
    Ok(())
}
