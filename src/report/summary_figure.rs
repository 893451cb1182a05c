//! Frequency and damping of the model that answers, small enough for the summary of a report.

use super::page_head::required_colour;
use super::study_page::{PageCurve, StudyPage};
use super::vocabulary::{
    Axis, BLACK, COLOURS, Drawing, Entry, Figure, Ink, PALE_GREY, Panel, dash,
};
use crate::error::Result;
use crate::flutter::ModeBranch;

/// Damping ratios that are shown, per cent.
const WINDOW: (f64, f64) = (-2.0, 5.0);

/// The curves of the answer side by side, with onset, interval and required speed; `None` where there are no curves.
///
/// # Errors
/// [`crate::Error::Input`] for curves that cannot be drawn.
pub(crate) fn summary_figure(of: &StudyPage) -> Result<Option<Figure>> {
    let speed = || Axis::new("Wind speed V (m/s)").tight();
    let mut frequency = Panel::new(speed(), Axis::new("Frequency f (Hz)").zero_based());
    let mut damping = Panel::new(speed(), Axis::new("Damping ratio ζ (%)"));
    damping.level = Some(0.0);
    damping.y.within = Some(WINDOW);
    let mut modes = Vec::new();
    let own = of.curves.iter().filter(|c| c.own);
    for (curve, colour) in own.zip(COLOURS) {
        let ink = Ink::line(colour, dash(modes.len()));
        let points = |values: &[Option<f64>]| -> Vec<(f64, f64)> {
            let both = of.speeds.iter().zip(values);
            both.filter_map(|(v, y)| Some((*v, (*y)?))).collect()
        };
        frequency.add(&curve.label, points(&curve.frequency), ink);
        damping.add(&curve.label, points(&curve.damping), ink);
        modes.push(Entry::new(mode_of(curve), ink));
    }
    if modes.is_empty() {
        return Ok(None);
    }
    let marks = marks(of, [&mut frequency, &mut damping]);
    let (panels, legend) = (vec![frequency, damping], vec![modes, marks]);
    let drawing = Drawing::grid("summary", "", panels, 2, [300.0, 210.0], legend);
    drawing.draw().map(Some)
}

fn mode_of(curve: &PageCurve) -> String {
    ModeBranch::in_words(curve.label.rsplit(", ").next().unwrap_or_default())
}

/// Draws what stands at a speed into both panels.
fn marks(of: &StudyPage, panels: [&mut Panel; 2]) -> Vec<Entry> {
    let mut marks = Vec::new();
    let required = Ink::solid(required_colour(&of.verdict), 1.6);
    for (i, panel) in panels.into_iter().enumerate() {
        let mut mark = |text: String, ink| {
            if i == 0 {
                marks.push(Entry::new(text, ink));
            }
        };
        if let Some(at) = of.onset {
            panel.uprights.push((at, BLACK));
            let ink = Ink::stroke(BLACK, Some("3 3"), 0.9);
            mark(format!("onset {at:.2} m/s"), ink);
        }
        if let Some((low, high)) = of.interval {
            panel.shaded.push((low, high));
            let ink = Ink::solid(PALE_GREY, 6.0);
            mark("its 95 % interval".to_owned(), ink);
        }
        if let Some(at) = of.verdict.against.map(|r| r.speed_m_s) {
            let points = panel.series.iter().flat_map(|s| &s.points);
            let highest = points.map(|p| p.1).fold(0.0, f64::max);
            panel.add(
                "required",
                vec![(at, [0.0, WINDOW.0][i]), (at, highest)],
                required,
            );
            mark(format!("required {at} m/s"), required);
        }
    }
    marks
}
