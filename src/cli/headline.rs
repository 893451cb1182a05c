//! The answer of a study before its details: one line, what limits trust in it, how the other models compare.

use super::report::AnswerView;
use crate::flutter::{Onset, OnsetMethod};
use crate::study::{Deck, FlutterStudy, StageFailure, SteppedOnset, Study};

/// The onset of the model `name` by eigenvalues, if the data determine it.
pub(super) fn own_onset<'a>(results: &'a FlutterStudy, name: &str) -> Option<&'a Onset> {
    of_model(&results.onsets, name)
}

fn of_model<'a>(onsets: &'a [Onset], name: &str) -> Option<&'a Onset> {
    let own = |o: &&Onset| o.at.model == name && o.at.method == OnsetMethod::Eigenvalues;
    onsets.iter().find(own)
}

/// The answer of the exported model.
pub(super) fn answer(study: &Study, results: &FlutterStudy, name: &str) -> AnswerView {
    let own = own_onset(results, name);
    let open = of_model(&results.undetermined, name);
    let unstable = results.unstable.iter().find(|s| s.at.model == name);
    let stable = results.stable.iter().find(|s| s.model == name);
    let headline = match (own.or(open), unstable, stable) {
        (Some(onset), ..) => onset.headline(),
        (None, Some(start), _) => start.explain(),
        (None, None, Some(stable)) => stable.explain(),
        (None, None, None) => format!("no answer: {name} was not trained or not searched"),
    };
    let required = study.flutter.required_speed_m_s;
    let lowest = own.map(|o| o.interval.ends().map_or(o.at.speed_m_s, |(low, _)| low));
    // growth from the lowest speed on is below any requirement; a stable section is judged as far as it was searched
    let lowest = lowest.or(unstable.map(|_| 0.0)).or(stable
        .filter(|s| s.stable_from_m_s <= 0.0)
        .map(|s| s.stable_up_to_m_s));
    AnswerView {
        model: name.to_owned(),
        headline,
        speed_m_s: own.map(|o| o.at.speed_m_s),
        required_speed_m_s: required,
        required_speed_met: required
            .zip(lowest)
            .map(|(required, lowest)| lowest >= required),
    }
}

/// What limits trust in the answer of the exported model.
pub(super) fn limits(
    deck: &Deck,
    results: &FlutterStudy,
    name: &str,
    failed: &[StageFailure],
) -> Vec<String> {
    let mut limits = Vec::new();
    if let Some(onset) = own_onset(results, name).or(of_model(&results.undetermined, name)) {
        limits.extend(limits_of(onset, "the model is"));
    }
    let growth = results.growth.iter().filter(|g| g.model == name);
    let growth = growth.filter(|g| !g.growth.is_none());
    limits.extend(growth.map(|g| g.growth.explain()));
    limits.extend(deck.warnings());
    limits.extend(failed.iter().map(StageFailure::explain));
    limits
}

/// What limits trust in an onset; what is extrapolated beyond the tested range, with its verb.
pub(super) fn limits_of(onset: &Onset, extrapolated: &str) -> Vec<String> {
    let mut limits = Vec::new();
    if onset.in_tested_range == Some(false) {
        limits.push(format!(
            "The onset lies outside the tested range: {extrapolated} extrapolated."
        ));
    }
    let no_interval = onset.interval.reason();
    limits.extend(no_interval.map(|why| format!("No interval of the onset: {why}")));
    limits.extend(onset.warnings.iter().cloned());
    limits
}

/// How the other models and routes compare with the answer.
pub(super) fn comparisons(
    results: &FlutterStudy,
    stepped: Option<&SteppedOnset>,
    name: &str,
) -> Vec<String> {
    let mut lines = Vec::new();
    let speeds = results.onsets.iter().filter(|o| o.at.model != name);
    let (low, high) = speeds
        .map(|o| o.at.speed_m_s)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
    if low <= high {
        lines.push(format!(
            "Other models and routes: {low:.2} to {high:.2} m/s."
        ));
    }
    lines.extend(results.deviations.iter().map(|d| d.explain()));
    for d in &results.divergence {
        let speed = d
            .speed_m_s
            .map_or("none".to_owned(), |v| format!("{v:.3} m/s"));
        lines.push(format!("Divergence, {}: {speed}", d.model));
    }
    lines.extend(stepped.map(SteppedOnset::explain));
    lines
}
