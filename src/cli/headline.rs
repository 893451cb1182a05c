//! What stands around the verdict of a study: the onset it is about, and how the other models compare.

use super::vocabulary::{FlutterStudy, OnsetMethod, Verdict, counted, speed_or};
use crate::flutter::Onset;
use crate::signal::extremes;
use crate::study::SteppedOnset;
use crate::verdict::{Doubt, Severity};
use std::fmt::Write as _;

/// The onset of the model `name` by eigenvalues, if the data determine it.
pub(super) fn own_onset<'a>(results: &'a FlutterStudy, name: &str) -> Option<&'a Onset> {
    let own = |o: &&Onset| o.at.model == name && o.at.method == OnsetMethod::Eigenvalues;
    results.onsets.iter().find(own)
}

/// [`text`] of a verdict where there is one.
pub(super) fn stated(name: &str, verdict: Option<&Verdict>) -> String {
    verdict.map_or(String::new(), |v| text(name, v, &[]))
}

/// The verdict in words: the first line, why, every severe doubt, and how many others there are.
pub(super) fn short(name: &str, verdict: &Verdict) -> String {
    let severe = |d: &&Doubt| d.severity == Severity::Severe;
    let mut said = verdict.clone();
    said.doubts.retain(|d| severe(&d));
    let text = text(name, &said, &[]);
    match verdict.doubts.len() - said.doubts.len() {
        0 => text,
        more => format!("{text}          {} on the page\n", counted(more, "note")),
    }
}

/// The verdict in words: the first line, why, and every doubt that is not said elsewhere.
pub(super) fn text(name: &str, verdict: &Verdict, elsewhere: &[String]) -> String {
    let mut text = format!("{name}: {}\n\n", verdict.headline);
    let _ = writeln!(text, "Verdict   {}", verdict.explanation);
    for doubt in &verdict.doubts {
        // what the explanation says already is not said again
        if elsewhere.contains(&doubt.text) || verdict.explanation.contains(&doubt.text) {
            continue;
        }
        let mark = match doubt.severity {
            Severity::Severe => "DOUBT",
            Severity::Minor => "note",
        };
        let _ = writeln!(text, "          {mark}: {}", doubt.text);
    }
    text
}

/// How the other models and routes compare with the answer.
pub(super) fn comparisons(
    results: &FlutterStudy,
    stepped: Option<&SteppedOnset>,
    name: &str,
) -> Vec<String> {
    let mut lines = Vec::new();
    let speeds = results.onsets.iter().filter(|o| o.at.model != name);
    let (low, high) = extremes(speeds.map(|o| o.at.speed_m_s));
    if low <= high {
        lines.push(format!(
            "Other models and routes: {low:.2} to {high:.2} m/s."
        ));
    }
    lines.extend(results.deviations.iter().map(|d| d.explain()));
    for d in &results.divergence {
        let speed = speed_or("none", d.speed_m_s);
        lines.push(format!("Divergence, {}: {speed}", d.forces));
    }
    lines.extend(stepped.map(SteppedOnset::explain));
    lines
}
