//! Modes of a bridge, their frequencies and damping over wind speed, and the motion at flutter.

use super::axis::Axis;
use super::drawing::Drawing;
use super::figure::Figure;
use super::legend::Entry;
use super::panel::Panel;
use super::root_locus::RootLocus;
use super::style::{COLOURS, GREY, Ink, PALE_GREY, Shape, dash};
use crate::bridge::Bridge;
use crate::error::Result;
use crate::flutter::{BridgeMotion, CriticalPoint, FlutterCurves, ModeBranch, ModePoint};

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
    (0..3)
        .map(|i| Entry::new(MOTIONS[i], motion_ink(i)))
        .collect()
}

/// Vertical, lateral and torsional displacement of each mode along the girder, the largest of each mode being 1.
///
/// # Errors
/// [`crate::Error::Input`] for shapes that cannot be drawn.
pub(crate) fn modes_figure(bridge: &Bridge, title: &str) -> Result<Figure> {
    let half_width = 0.5 * bridge.width_m();
    let scale = [1.0, 1.0, half_width];
    let mut panels = Vec::with_capacity(bridge.modes.len());
    for mode in &bridge.modes {
        let values = mode
            .shape
            .iter()
            .flat_map(|s| (0..3).map(|i| (s[i] * scale[i]).abs()));
        let greatest = values.fold(f64::MIN_POSITIVE, f64::max);
        let mut panel = Panel::new(Axis::new("").tight(), Axis::new(""));
        panel.title = Some(format!("mode {}: {:.4} Hz", mode.number, mode.frequency_hz));
        panel.y.range = Some((-1.1, 1.1));
        panel.level = Some(0.0);
        for i in 0..3 {
            let nodes = bridge.nodes.iter().zip(&mode.shape);
            let points = nodes
                .map(|(n, s)| (n.along_m, s[i] * scale[i] / greatest))
                .collect();
            panel.add(MOTIONS[i], points, motion_ink(i));
        }
        panels.push(panel);
    }
    Drawing {
        name: "modes of the bridge",
        title: Some(title.to_owned()),
        panels,
        columns: bridge.modes.len().min(3),
        axes: (300.0, 110.0),
        legend: vec![motion_legend()],
    }
    .draw()
}

/// A mode as it is drawn.
struct Drawn<'a> {
    branch: &'a ModeBranch,
    ink: Ink,
}

impl Drawn<'_> {
    fn line(&self, place: impl Fn(&ModePoint) -> (f64, f64)) -> Vec<(f64, f64)> {
        self.branch.points.iter().map(place).collect()
    }
}

/// The modes with their inks and what the legend says of them: those of `shown`, by name of the branch, in colour and on top, the
/// others grey.
fn drawn<'a>(curves: &'a FlutterCurves, shown: &[String]) -> (Vec<Drawn<'a>>, Vec<Entry>) {
    let place = |name: &str| shown.iter().take(COLOURED).position(|s| s == name);
    let others = Ink::stroke(PALE_GREY, None, 1.0);
    let ink = |i: usize| Ink::line(COLOURS[i], dash(i));
    let branches = curves.branches.iter().filter(|b| !b.points.is_empty());
    let mut all: Vec<_> = branches.map(|b| (place(&b.name), b)).collect();
    all.sort_by_key(|(place, _)| *place);
    let legend = all
        .iter()
        .filter_map(|(place, b)| Some(Entry::new(&b.name, ink((*place)?))));
    let legend = legend.collect();
    let all = all.into_iter().map(|(place, branch)| Drawn {
        branch,
        ink: place.map_or(others, ink),
    });
    (all.collect(), legend)
}

/// Frequencies and damping ratios of all modes over wind speed: those of `shown`, by name of the branch, in colour, the others
/// grey; the onset is marked.
///
/// # Errors
/// [`crate::Error::Input`] for curves that cannot be drawn.
pub(crate) fn bridge_curves_figure(
    curves: &FlutterCurves,
    shown: &[String],
    onset: Option<&CriticalPoint>,
    title: &str,
) -> Result<Figure> {
    let speed = || Axis::new("Wind speed V (m/s)").tight();
    let mut frequency = Panel::new(speed(), Axis::new("Frequency f (Hz)").zero_based());
    let mut damping = Panel::new(speed(), Axis::new("Damping ratio ζ (%)"));
    damping.level = Some(0.0);
    damping.y.within = Some((-5.0, 15.0));
    let (modes, legend) = drawn(curves, shown);
    for mode in modes {
        let name = &mode.branch.name;
        frequency.add(name, mode.line(|p| (p.speed_m_s, p.frequency_hz)), mode.ink);
        let percent = mode.line(|p| (p.speed_m_s, 100.0 * p.damping_ratio));
        damping.add(name, percent, mode.ink);
    }
    let mut stated = vec![other_modes()];
    if let Some(at) = onset {
        let ink = Ink::dots(GREY, Shape::Circle);
        frequency.add("onset", vec![(at.speed_m_s, at.frequency_hz)], ink);
        damping.add("onset", vec![(at.speed_m_s, 0.0)], ink);
        let words = format!("onset {:.3} m/s, {:.4} Hz", at.speed_m_s, at.frequency_hz);
        stated.push(Entry::new(words, ink));
    }
    Drawing {
        name: "V-f and V-ζ diagram of the bridge",
        title: Some(title.to_owned()),
        panels: vec![frequency, damping],
        columns: 1,
        axes: (640.0, 250.0),
        legend: vec![legend, stated],
    }
    .draw()
}

fn other_modes() -> Entry {
    Entry::new("other modes", Ink::line(PALE_GREY, None))
}

/// The eigenvalues of all modes as the wind rises, coloured as the curves over wind speed are: growth rate (1/s) against frequency
/// (Hz). Right of the zero line motions grow.
///
/// # Errors
/// [`crate::Error::Input`] for curves that cannot be drawn.
pub(crate) fn bridge_roots_figure(
    curves: &FlutterCurves,
    shown: &[String],
    title: &str,
) -> Result<Figure> {
    let mut roots = RootLocus::new();
    let (modes, legend) = drawn(curves, shown);
    for mode in modes {
        roots.add(mode.branch, mode.ink);
    }
    roots.draw(title, vec![legend, vec![other_modes()]])
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
        let label = ["now", "a quarter of a period later"][part];
        let mut panel = Panel::new(
            Axis::new(if part == 1 {
                "Along the girder (m)"
            } else {
                ""
            })
            .tight(),
            Axis::new(label),
        );
        panel.y.range = Some((-1.1, 1.1));
        panel.level = Some(0.0);
        for i in 0..3 {
            // Re(z e^{iωt}) a quarter of a period later is −Im z
            let sign = if part == 0 { 1.0 } else { -1.0 };
            let points = motion
                .nodes
                .iter()
                .map(|n| (n.along_m, sign * n.motion[i][part] * scale[i]));
            panel.add(MOTIONS[i], points.collect(), motion_ink(i));
        }
        panel
    });
    Drawing {
        name: "motion at flutter",
        title: Some(title.to_owned()),
        panels: panels.collect(),
        columns: 1,
        axes: (640.0, 150.0),
        legend: vec![motion_legend()],
    }
    .draw()
}
