//! Onset and curves of a trained model in another section, text in and text out: what a page of a report asks of the
//! library while somebody moves its sliders.
#![deny(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::undocumented_unsafe_blocks))]

#[cfg(target_arch = "wasm32")]
#[allow(unsafe_code)]
mod interface;

use aerodeck_core::aeroelastic::CoupledSection;
use aerodeck_core::error::{Error, Result};
use aerodeck_core::flutter::{
    FlutterCurves, FlutterSearch, ModePoint, OnsetSearch, curve_speeds_m_s, divergence_with_forces,
    find_onset, shown_m_s, trace_modes, unwanted_growth_below,
};
use aerodeck_core::section::SectionModel;
use aerodeck_core::trained_model::TrainedModel;
use serde::{Deserialize, Serialize};

/// What is asked.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    /// Text of `model.json`.
    model: String,
    /// The section to couple the model with, instead of the one that stands in the file.
    section: SectionModel,
    /// Lowest wind speed of the curves, m/s.
    speed_min_m_s: f64,
    /// Highest wind speed of curves and search, m/s.
    speed_max_m_s: f64,
    /// Number of wind speeds.
    speeds: usize,
}

/// What is answered.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct FlutterAnswer {
    /// Where the section flutters, or up to where it does not.
    search: FlutterSearch,
    /// The same in words.
    words: String,
    /// Growth outside the tests or static divergence, whichever comes first and before flutter, in words.
    first: Option<String>,
    /// Static divergence of the model, m/s.
    divergence_m_s: Option<f64>,
    /// Frequency and damping over wind speed.
    modes: Vec<ModeCurve>,
    /// Why the curves end before the highest speed, where they do.
    ended: Option<String>,
}

/// A mode over wind speed, one number per speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct ModeCurve {
    /// Degree of freedom the mode moves in still air.
    name: String,
    /// m/s.
    speed_m_s: Vec<f64>,
    /// Hz.
    frequency_hz: Vec<f64>,
    /// Of critical damping.
    damping_ratio: Vec<f64>,
}

/// Answers a request in JSON, with the numbers that `aerodeck flutter` has for a study of this section: an object with
/// `search`, `words`, `first`, `divergence_m_s`, `modes` and `ended`, or one with `error` alone.
///
/// ```
/// let answer = aerodeck_live::answer("{}");
/// assert!(answer.starts_with(r#"{"error":"#), "{answer}");
/// ```
pub fn answer(request: &str) -> String {
    let said = answer_of(request).and_then(|a| serde_json::to_string(&a).map_err(json_error));
    said.unwrap_or_else(|e| serde_json::json!({ "error": e.to_string() }).to_string())
}

fn answer_of(request: &str) -> Result<FlutterAnswer> {
    let request: Request = serde_json::from_str(request).map_err(json_error)?;
    let trained = TrainedModel::from_json(&request.model)?;
    let structure = request.section.structure()?;
    let section = CoupledSection::with_model(&structure, &trained.model)?;
    let search = OnsetSearch::new(request.speed_max_m_s, request.speeds);
    let tested = Some(trained.tested_range);
    let found = find_onset(&trained.name, &section, &search, tested)?;
    let (low, high) = (request.speed_min_m_s, request.speed_max_m_s);
    // a model without forces at rest has no divergence
    let divergence_m_s = divergence_with_forces(&structure, &trained.model)
        .ok()
        .flatten();
    // as on the page, a scan that fails takes no answer with it
    let growth = unwanted_growth_below(Some(&found), &section, &search, tested).ok();
    let limit = (found.critical()).map_or(search.speed_max_m_s, |at| at.speed_m_s);
    let bands = growth.iter().flat_map(|growth| &growth.bands);
    let bands = bands.map(|band| band.from_m_s);
    let grows = bands.map(|speed| ("growth outside the tests", speed));
    let diverges = divergence_m_s.map(|speed| ("static divergence", speed));
    let before = grows.chain(diverges.filter(|(_, speed)| *speed < limit));
    let first = before.min_by(|a, b| a.1.total_cmp(&b.1));
    let speeds = curve_speeds_m_s(low, high, request.speeds);
    let curves = trace_modes(&trained.name, &section, &speeds)?;
    Ok(FlutterAnswer {
        words: found.explain(),
        first: first.map(|(what, speed)| format!("{what} at {} m/s", shown_m_s(speed))),
        divergence_m_s,
        search: found,
        modes: modes(&curves),
        ended: curves.ended,
    })
}

fn modes(curves: &FlutterCurves) -> Vec<ModeCurve> {
    let curve = |branch: &aerodeck_core::flutter::ModeBranch| {
        let all = |value: fn(&ModePoint) -> f64| branch.points.iter().map(value).collect();
        ModeCurve {
            name: branch.name.clone(),
            speed_m_s: all(|p| p.speed_m_s),
            frequency_hz: all(|p| p.frequency_hz),
            damping_ratio: all(|p| p.damping_ratio),
        }
    };
    curves.branches.iter().map(curve).collect()
}

fn json_error(error: serde_json::Error) -> Error {
    Error::input(
        "request",
        "model, section and wind speeds",
        error.to_string(),
    )
}

#[cfg(test)]
mod tests;
