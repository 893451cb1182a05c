//! Modes of a bridge, their frequencies and damping over wind speed, and the motion at flutter.

use super::flutter_figures::root_locus;
use super::vocabulary::{
    Axis, COLOURS, Drawing, Entry, Figure, GREY, Ink, PALE_GREY, Panel, Shape, dash, outcome_colour,
};
use crate::bridge::Bridge;
use crate::error::Result;
use crate::flutter::{ModeBranch, ModePoint};
use crate::study::bridge::BridgeMotion;
use crate::study::bridge::{BridgeFlutter, NAMED_SHARE};
use crate::verdict::Verdict;

/// The motions of a shape, as the legends name them; rotations count with half the width.
const MOTIONS: [&str; 3] = [
    "vertical (up)",
    "lateral (downwind)",
    "rotation (nose-up) · B/2",
];
/// Modes that get a colour of their own.
const COLOURED: usize = COLOURS.len();

fn motion_ink(i: usize) -> Ink {
    Ink::line(COLOURS[i], dash(i))
}

fn motion_legend() -> Vec<Entry> {
    let entry = |i: usize| Entry::new(MOTIONS[i], motion_ink(i));
    (0..3).map(entry).collect()
}

/// Vertical, lateral and torsional displacement of each mode along the girder, the largest of each mode being 1.
///
/// # Errors
/// [`crate::Error::Input`] for shapes that cannot be drawn.
pub(crate) fn modes_figure(bridge: &Bridge, title: &str) -> Result<Figure> {
    let half_width = 0.5 * bridge.width_m();
    let scale = [1.0, 1.0, half_width];
    let mut panels = Vec::with_capacity(bridge.modes.len());
    let columns = bridge.modes.len().min(3);
    for mode in &bridge.modes {
        let shape = mode.shape.iter();
        let values = shape.flat_map(|s| (0..3).map(|i| (s[i] * scale[i]).abs()));
        let greatest = values.fold(f64::MIN_POSITIVE, f64::max);
        let mut panel = Panel::new(Axis::new("x (m)").tight(), Axis::new(""));
        panel.title = Some(format!("mode {}: {:.4} Hz", mode.number, mode.frequency_hz));
        panel.y.range = Some((-1.1, 1.1));
        panel.level = Some(0.0);
        for i in 0..3 {
            let nodes = bridge.nodes.iter().zip(&mode.shape);
            let points = nodes.map(|(n, s)| (n.along_m, s[i] * scale[i] / greatest));
            panel.add(MOTIONS[i], points.collect(), motion_ink(i));
        }
        panels.push(panel);
    }
    let (name, legend) = ("modes of the bridge", vec![motion_legend()]);
    let drawing = Drawing::grid(name, title, panels, columns, [300.0, 110.0], legend);
    drawing.over_one_abscissa().draw()
}

fn line(branch: &ModeBranch, place: impl Fn(&ModePoint) -> (f64, f64)) -> Vec<(f64, f64)> {
    branch.points.iter().map(place).collect()
}

/// The modes that are drawn with their inks, those with the largest shares of the energy in colour and on top, and what the legend says
/// of them; the line of the mode that flutters is the widest.
fn drawn(of: &BridgeFlutter) -> (Vec<(&ModeBranch, Ink)>, Vec<Entry>) {
    let onset = of.onset().map(|o| o.branch.as_str());
    let (shown, shares) = (of.shown_modes(onset), of.shares());
    let place = |name: &str| shown.iter().take(COLOURED).position(|s| s == name);
    let takes_part = |name: &str| {
        let mut named = shares.iter().filter(|m| m.energy_share >= NAMED_SHARE);
        shares.is_empty() || named.any(|m| format!("mode {}", m.mode) == name)
    };
    let ink = |i: usize, name: &str| {
        let width = if onset == Some(name) { 3.2 } else { 1.6 };
        Ink::stroke(COLOURS[i], dash(i), width)
    };
    let wanted =
        |b: &&ModeBranch| !b.points.is_empty() && (place(&b.name).is_some() || takes_part(&b.name));
    let branches = of.curves.branches.iter().filter(wanted);
    let mut all: Vec<_> = branches.map(|b| (place(&b.name), b)).collect();
    all.sort_by_key(|(place, _)| *place);
    let entry = |(place, b): &(Option<usize>, &ModeBranch)| {
        let flutters = onset.filter(|o| *o == b.name).map_or("", |_| " (flutters)");
        let words = format!("{}{flutters}", b.name);
        Some(Entry::new(words, ink((*place)?, &b.name)))
    };
    let mut legend: Vec<Entry> = all.iter().filter_map(entry).collect();
    let pale = Ink::solid(PALE_GREY, 1.0);
    if all.iter().any(|(place, _)| place.is_none()) {
        legend.push(Entry::new("other modes that take part", pale));
    }
    let all = all.into_iter();
    let all = all.map(|(place, b)| (b, place.map_or(pale, |i| ink(i, &b.name))));
    (all.collect(), legend)
}

/// Speeds around the onset in the lowest panel, over the onset.
const CLOSE: (f64, f64) = (0.8, 1.15);

/// Frequencies and damping ratios of the modes over wind speed, and the damping around the onset; onset and required speed are
/// marked.
///
/// # Errors
/// [`crate::Error::Input`] for curves that cannot be drawn.
pub(crate) fn bridge_curves_figure(
    of: &BridgeFlutter,
    verdict: &Verdict,
    title: &str,
) -> Result<Figure> {
    let speed = || Axis::new("Wind speed V (m/s)").tight();
    let mut frequency = Panel::new(speed(), Axis::new("Frequency f (Hz)").zero_based());
    let mut damping = Panel::new(speed(), Axis::new("Damping ratio ζ (%)"));
    damping.y.within = Some((-5.0, 15.0));
    let (modes, legend) = drawn(of);
    let mut close = None;
    if let Some(onset) = of.onset() {
        let at = onset.at.speed_m_s;
        let window = [CLOSE.0 * at, CLOSE.1 * at];
        let mut panel = Panel::new(speed(), Axis::new("ζ (%) at the onset"));
        panel.x.range = Some((window[0], window[1]));
        panel.y.range = Some(of_crossing(&modes, &onset.branch, window));
        close = Some(panel);
    }
    for (mode, ink) in modes {
        let name = &mode.name;
        frequency.add(name, line(mode, |p| (p.speed_m_s, p.frequency_hz)), ink);
        for panel in std::iter::once(&mut damping).chain(&mut close) {
            let percent = line(mode, |p| (p.speed_m_s, 100.0 * p.damping_ratio));
            panel.add(name, percent, ink);
        }
    }
    let mut stated = Vec::new();
    let highest = frequency.series.iter().flat_map(|s| &s.points);
    let highest = highest.map(|p| p.1).fold(0.0, f64::max);
    if let (Some(at), Some(outcome)) = (verdict.against, &verdict.outcome) {
        let at = at.speed_m_s;
        let ink = Ink::solid(outcome_colour(outcome), 1.6);
        frequency.add("required", vec![(at, 0.0), (at, highest)], ink);
        for panel in std::iter::once(&mut damping).chain(&mut close) {
            panel.add("required", vec![(at, -5.0), (at, 15.0)], ink);
        }
        let words = format!("required {at} m/s: {}", outcome.words());
        stated.push(Entry::new(words, ink));
    }
    if let Some(onset) = of.onset() {
        let (speed_m_s, frequency_hz) = (onset.at.speed_m_s, onset.at.frequency_hz);
        let ink = Ink::dots(GREY, Shape::Circle);
        frequency.add("onset", vec![(speed_m_s, frequency_hz)], ink);
        for panel in std::iter::once(&mut damping).chain(&mut close) {
            panel.add("onset", vec![(speed_m_s, 0.0)], ink);
        }
        let words = format!("onset {speed_m_s:.3} m/s, {frequency_hz:.4} Hz");
        stated.push(Entry::new(words, ink));
    }
    let mut panels = vec![frequency, damping];
    panels.extend(close);
    for panel in panels.iter_mut().skip(1) {
        panel.level = Some(0.0);
    }
    let (name, legend) = ("V-f and V-ζ diagram of the bridge", vec![legend, stated]);
    Drawing::grid(name, title, panels, 1, [640.0, 220.0], legend).draw()
}

/// Damping ratios, per cent, of the mode that flutters in a window of speeds, with the zero line.
fn of_crossing(modes: &[(&ModeBranch, Ink)], flutters: &str, window: [f64; 2]) -> (f64, f64) {
    let own = modes.iter().filter(|(branch, _)| branch.name == flutters);
    let points = own.flat_map(|(branch, _)| &branch.points);
    let inside = points.filter(|p| (window[0]..=window[1]).contains(&p.speed_m_s));
    let (low, high) = inside
        .map(|p| 100.0 * p.damping_ratio)
        .fold((-0.1, 0.1), |(low, high), z| (z.min(low), z.max(high)));
    (low - 0.1 * (high - low), high + 0.1 * (high - low))
}

/// The eigenvalues of the modes as the wind rises, coloured as the curves over wind speed are: growth rate (1/s) against frequency
/// (Hz). Right of the zero line motions grow.
///
/// # Errors
/// [`crate::Error::Input`] for curves that cannot be drawn.
pub(crate) fn bridge_roots_figure(of: &BridgeFlutter, title: &str) -> Result<Figure> {
    let (modes, legend) = drawn(of);
    root_locus(modes, title, legend)
}

/// The motion at flutter along the girder: real and imaginary part, a quarter of a period apart.
///
/// # Errors
/// [`crate::Error::Input`] for a motion that cannot be drawn.
pub(crate) fn flutter_motion_figure(
    motion: &BridgeMotion,
    half_width_m: f64,
    title: &str,
) -> Result<Figure> {
    let scale = [1.0, 1.0, half_width_m];
    let panels = (0..2).map(|part| {
        let label = ["t = 0", "t = T/4"][part];
        let along = Axis::new("Along the girder x (m)").tight();
        let mut panel = Panel::new(along, Axis::new(label));
        panel.y.range = Some((-1.1, 1.1));
        panel.level = Some(0.0);
        for i in 0..3 {
            // Re(z e^{iωt}) a quarter of a period later is −Im z
            let sign = if part == 0 { 1.0 } else { -1.0 };
            let nodes = motion.nodes.iter();
            let points = nodes.map(|n| (n.along_m, sign * n.motion[i][part] * scale[i]));
            panel.add(MOTIONS[i], points.collect(), motion_ink(i));
        }
        panel
    });
    let (panels, legend) = (panels.collect(), vec![motion_legend()]);
    Drawing::stacked("motion at flutter", title, panels, 150.0, legend)
}
