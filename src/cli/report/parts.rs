//! Parts of the pages of a section and of a bridge.

use crate::cli::result_files::CURVES;
use crate::cli::text::interval;
use crate::cli::vocabulary::{Error, Figure, Result, Study};
use crate::flutter::{ModeBranch, Onset, OnsetInterval};
use crate::fmu::package::live_module;
use crate::report::{PageCurve, PageFigure};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde_json::json;
use std::collections::BTreeMap;

/// The ends of an interval that is known.
pub(super) fn known(interval: &OnsetInterval) -> Option<(f64, f64)> {
    match interval {
        OnsetInterval::Known(error) => Some((error.low_m_s, error.high_m_s)),
        _ => None,
    }
}

/// The onset in words, line by line.
pub(super) fn card(onset: &Onset) -> Vec<(&'static str, String)> {
    let interval = match &onset.interval {
        OnsetInterval::Known(error) => format!(
            // a tenth, since the width of the interval hangs on it where there are few
            "{:.2} to {:.2} m/s (standard error {:.2} m/s: {}; {:.1} degrees of freedom)",
            error.low_m_s,
            error.high_m_s,
            error.standard_error_m_s,
            error.parts.explain(),
            error.degrees_of_freedom,
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
    let v_star = format!("{:.3}", onset.at.reduced_velocity.v_star());
    let (branch, mode) = (ModeBranch::in_words(&onset.branch), onset.mode_in_words());
    vec![
        ("onset speed V", format!("{:.2} m/s", onset.at.speed_m_s)),
        ("95 % interval", interval),
        ("frequency f", format!("{:.4} Hz", onset.at.frequency_hz)),
        ("reduced velocity V/(fB)", v_star),
        ("motion", format!("{branch}; {mode}")),
        ("tested range", tested(onset.in_tested_range).to_owned()),
    ]
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
    let mut all = figures.iter();
    let at = all.position(|f| f.title.starts_with("Derivatives"));
    at.map(|at| figures.remove(at))
}

/// Without the digits that a product left behind.
pub(super) fn round(x: f64) -> f64 {
    (1e9 * x).round() / 1e9
}

/// A figure of a file with its words.
pub(super) fn of_svg(text: &str, title: &str, caption: &'static str) -> Option<PageFigure> {
    Figure::of_file(text).map(|figure| PageFigure {
        title: title.to_owned(),
        caption,
        figure,
    })
}

/// Wind speeds and curves of `curves.csv`; `own` is the model of the answer.
pub(super) fn curves_of(text: &str, own: &str) -> Result<(Vec<f64>, Vec<PageCurve>)> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let broken =
        |found: String| Error::input(CURVES, "curves as `aerodeck study` writes them", found);
    let point = |row: csv::Result<csv::StringRecord>| {
        let row = row.map_err(|e| broken(e.to_string()))?;
        let field = |i: usize| row.get(i).unwrap_or("");
        let number = |i: usize| {
            let found = |_| broken(format!("`{}`", field(i)));
            field(i).parse::<f64>().map_err(found)
        };
        let name = |i: usize| field(i).to_owned();
        Ok((name(0), name(1), number(2)?, number(3)?, number(4)?))
    };
    let points = reader.records().map(point).collect::<Result<Vec<_>>>()?;
    let mut speeds: Vec<f64> = points.iter().map(|p| p.2).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let (mut models, mut branches) = (Vec::<String>::new(), Vec::<String>::new());
    let place = |names: &mut Vec<String>, name: &String| {
        names.iter().position(|n| n == name).unwrap_or_else(|| {
            names.push(name.clone());
            names.len() - 1
        })
    };
    let mut curves: BTreeMap<(usize, usize), PageCurve> = BTreeMap::new();
    for (model, branch, speed, frequency, damping) in &points {
        let at = (place(&mut models, model), place(&mut branches, branch));
        let curve = curves.entry(at).or_insert_with(|| PageCurve {
            model: at.0,
            branch: at.1,
            own: model == own,
            label: format!("{model}, {branch}"),
            frequency: vec![None; speeds.len()],
            damping: vec![None; speeds.len()],
        });
        let i = speeds.partition_point(|v| v < speed);
        curve.frequency[i] = Some(*frequency);
        curve.damping[i] = Some(100.0 * damping);
    }
    Ok((speeds, curves.into_values().collect()))
}

/// The sliders for the exported model of a study: the request that is asked first, as `crate::live` takes it, and the module that
/// answers; `None` where there is no such model, or no module to ask.
pub(super) fn sliders(study: &Study, model: Option<Vec<u8>>) -> Result<Option<String>> {
    let (Some(model), Some(module)) = (model, live_module()?) else {
        return Ok(None);
    };
    let range = study.speeds();
    let sliders = json!({
        "module": BASE64_STANDARD.encode(module),
        "model": String::from_utf8_lossy(&model),
        "section": study.section,
        "speed_min_m_s": range.speed_min_m_s,
        "speed_max_m_s": range.speed_max_m_s,
        "speeds": range.speeds,
    });
    Ok(Some(sliders.to_string()))
}
