//! Parts that the pages of a section and of a bridge share.

use crate::cli::text::interval;
use crate::flutter::{ModeBranch, Onset, OnsetInterval};
use crate::report::PageFigure;

/// The ends of an interval that is known.
pub(super) fn known(interval: &OnsetInterval) -> Option<(f64, f64)> {
    match interval {
        OnsetInterval::Known {
            low_m_s, high_m_s, ..
        } => Some((*low_m_s, *high_m_s)),
        _ => None,
    }
}

/// The onset in words, line by line.
pub(super) fn card(onset: &Onset) -> Vec<(String, String)> {
    let interval = match &onset.interval {
        OnsetInterval::Known {
            low_m_s,
            high_m_s,
            standard_error_m_s,
            degrees_of_freedom,
            parts,
        } => format!(
            // a tenth, since the width of the interval hangs on it where there are few
            "{low_m_s:.2} to {high_m_s:.2} m/s (standard error {standard_error_m_s:.2} m/s: {}; {degrees_of_freedom:.1} degrees of freedom)",
            parts.explain(),
        ),
        OnsetInterval::None { reason } | OnsetInterval::Undetermined { reason, .. } => {
            reason.clone()
        }
        OnsetInterval::Spread {
            low_m_s,
            high_m_s,
            of,
        } => {
            format!("{low_m_s:.2} to {high_m_s:.2} m/s: {of}")
        }
    };
    [
        ("onset speed V", format!("{:.2} m/s", onset.at.speed_m_s)),
        ("95 % interval", interval),
        ("frequency f", format!("{:.4} Hz", onset.at.frequency_hz)),
        (
            "reduced velocity V/(fB)",
            format!("{:.3}", onset.at.reduced_velocity.v_star()),
        ),
        (
            "motion",
            format!(
                "{}; {}",
                ModeBranch::in_words(&onset.branch),
                onset.mode_in_words()
            ),
        ),
        ("tested range", tested(onset.in_tested_range).to_owned()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

fn tested(inside: Option<bool>) -> &'static str {
    match inside {
        Some(true) => "inside",
        Some(false) => "OUTSIDE",
        None => "exact",
    }
}

/// The onset as a row of the table of onsets.
pub(super) fn row(onset: &Onset) -> Vec<String> {
    vec![
        onset.at.model.clone(),
        onset.at.method.name().to_owned(),
        format!("{:.3}", onset.at.speed_m_s),
        interval(&onset.interval),
        format!("{:.4}", onset.at.frequency_hz),
        format!("{:.3}", onset.at.reduced_velocity.v_star()),
        onset.branch.clone(),
        tested(onset.in_tested_range).to_owned(),
    ]
}

/// A search without an onset as a row of that table, with what it found instead.
pub(super) fn sentence_row(model: &str, method: &str, answer: String) -> Vec<String> {
    vec![model.to_owned(), method.to_owned(), answer]
}

/// Takes the first figure of derivatives, which the summary shows.
pub(super) fn first_derivatives(figures: &mut Vec<PageFigure>) -> Option<PageFigure> {
    let at = figures
        .iter()
        .position(|f| f.title.starts_with("Derivatives"));
    at.map(|at| figures.remove(at))
}

/// Without the digits that a product left behind.
pub(super) fn round(x: f64) -> f64 {
    (1e9 * x).round() / 1e9
}

/// The figure in a file, without what only a file of its own needs.
pub(super) fn of_svg(text: &str, title: &str, caption: &'static str) -> Option<PageFigure> {
    let svg = text[text.find("<svg")?..].to_owned();
    Some(PageFigure {
        title: title.to_owned(),
        caption,
        svg,
    })
}
