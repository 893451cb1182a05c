//! The onset card of a bridge, in words.

use crate::cli::headline;
use crate::cli::text::{figures, of_onsets};
use crate::cli::vocabulary::{BridgeStudy, FlutterSearch, Verdict, counted, speed_or};
use crate::flutter::{ModeBranch, OnsetInterval};
use crate::study::bridge::{BridgeAnswer, BridgeFlutter, NAMED_SHARE};
use std::fmt::Write as _;

/// Modes with less of the kinetic energy are not named where nobody asked for more.
const NAMED_IN_SHORT: f64 = 0.05;
/// What a reader may ask for beside the answer.
pub(super) const MORE: &str = "onset cards, fewer modes";

/// The answer, and what stands beside it; the whole [`card`] with `verbose`, and on the page.
pub(super) fn text(
    study: &BridgeStudy,
    results: &BridgeFlutter,
    verdict: &Verdict,
    verbose: bool,
) -> String {
    if verbose {
        return card(study, results, verdict);
    }
    let mut text = headline::short(&study.file.name, verdict);
    let bridge = &study.by_model;
    let nodes = counted(bridge.nodes.len(), "node");
    let modes = counted(bridge.modes.len(), "mode");
    let _ = writeln!(text, "Bridge    {nodes}, {modes}\n");
    let mut table = of_onsets("Flutter onset by");
    for answer in &results.answers {
        let forces = std::iter::once(answer.forces.clone());
        match &answer.search {
            FlutterSearch::Onset(o) => table.row(forces.chain(figures(o))),
            other => table.sentence(forces, &other.explain()),
        }
    }
    text.push_str(&table.text());
    let motion = results.answers.iter().rev().find_map(|a| a.motion.as_ref());
    let modes = motion.map_or(&[][..], |m| &m.modes).iter();
    let named = modes.filter(|m| m.energy_share >= NAMED_IN_SHORT);
    let named = named.map(|m| format!("{} ({:.0} %)", m.mode, 100.0 * m.energy_share));
    let named: Vec<String> = named.collect();
    if !named.is_empty() {
        let named = named.join(", ");
        let _ = writeln!(text, "Modes     of the flutter, by kinetic energy: {named}");
    }
    let sentences = beside_the_onset(results).into_iter();
    text.extend(sentences.map(|sentence| format!("{sentence}\n")));
    text
}

/// The card.
fn card(study: &BridgeStudy, results: &BridgeFlutter, verdict: &Verdict) -> String {
    let bridge = &study.by_model;
    let mut text = headline::text(&study.file.name, verdict, &[]);
    let (nodes, modes) = (
        counted(bridge.nodes.len(), "node"),
        counted(bridge.modes.len(), "mode"),
    );
    let (groups, width) = (counted(bridge.groups.len(), "group"), bridge.width_m());
    text += &format!("Bridge    {nodes}, {modes}, {groups} of strips; K refers to B = {width} m\n");
    text.extend(results.answers.iter().map(one));
    if !results.left_out.is_empty() {
        text.push_str("Onset with fewer modes (by share of the kinetic energy at the onset)\n");
    }
    let full = results.answers.last();
    let full = full.and_then(|a| a.search.critical_speed_m_s());
    for left in &results.left_out {
        let onset = speed_or("no flutter", left.onset_m_s);
        let change = |(v, full): (f64, f64)| format!(" ({:+.2} %)", 100.0 * (v / full - 1.0));
        let change = left.onset_m_s.zip(full).map(change).unwrap_or_default();
        let (modes, percent) = (left.modes.len(), 100.0 * left.below_share);
        text += &format!("  {modes:>3} modes from {percent:>7.3} % on: {onset}{change}\n");
    }
    let sentences = beside_the_onset(results).into_iter();
    text.extend(sentences.map(|sentence| format!("{sentence}\n")));
    text
}

/// Divergence, and rotation in the mean wind where it was computed.
pub(super) fn beside_the_onset(results: &BridgeFlutter) -> Vec<String> {
    let rotation = results.mean_rotation.map(|mean| {
        format!(
            "Greatest mean rotation at {:.2} m/s: {:.3}° (nose-up positive)",
            mean.speed_m_s, mean.rotation_deg
        )
    });
    let divergence =
        |of: &str, speed| format!("Divergence of the {of}: {}", speed_or("none", speed));
    let mut all = vec![divergence("model", results.divergence_m_s)];
    let of_tables = results.table_divergence.as_ref();
    all.extend(of_tables.map(|d| divergence("tables", d.speed_m_s)));
    all.extend(rotation);
    all.extend(table_against_model(results));
    all
}

/// How far the answer by the models is from that by the tables.
fn table_against_model(results: &BridgeFlutter) -> Option<String> {
    let [table, model] = &results.answers[..] else {
        return None;
    };
    let speed = |a: &BridgeAnswer| a.search.critical_speed_m_s();
    let (table, model) = (speed(table)?, speed(model)?);
    let change = 100.0 * (model / table - 1.0);
    Some(format!(
        "Table against model: {table:.3} and {model:.3} m/s ({change:+.2} %)"
    ))
}

fn interval(of: &OnsetInterval) -> String {
    match of {
        OnsetInterval::Known(error) => format!(
            "95 % interval {:.3} to {:.3} m/s by the scatter of the tests and the form of the models (standard error {:.3} m/s)",
            error.low_m_s, error.high_m_s, error.standard_error_m_s
        ),
        OnsetInterval::Spread {
            low_m_s,
            high_m_s,
            of,
        } => format!("between {low_m_s:.3} and {high_m_s:.3} m/s: {of}"),
        OnsetInterval::Undetermined { reason, .. } => reason.clone(),
        OnsetInterval::None { reason } => format!("no interval: {reason}"),
    }
}

fn one(answer: &BridgeAnswer) -> String {
    let mut text = format!("Onset card: {}\n", answer.forces);
    match &answer.search {
        FlutterSearch::Onset(o) => {
            let tested = match o.in_tested_range {
                Some(true) => "inside the tested range",
                Some(false) => "OUTSIDE the tested range",
                None => "no tested range",
            };
            let (speed, hertz, method) = (o.at.speed_m_s, o.at.frequency_hz, o.at.method.name());
            let (v_star, branch) = (
                o.at.reduced_velocity.v_star(),
                ModeBranch::in_words(&o.branch),
            );
            let k = o.at.reduced_frequency.full_width();
            text += &format!("  V_F {speed:.3} m/s at {hertz:.4} Hz ({method}); ");
            text += &format!("V* = V/(fB) {v_star:.3}, K {k:.4}, {tested}; {branch}\n");
            let _ = writeln!(text, "  {}", interval(&o.interval));
            if let Some(slope) = o.damping_slope_s_m {
                let _ = writeln!(text, "  damping slope dζ/dV {slope:.5} s/m");
            }
            let warnings = o.warnings.iter();
            text.extend(warnings.map(|warning| format!("  warning: {warning}\n")));
        }
        other => {
            let _ = writeln!(text, "  {}", other.explain());
        }
    }
    let modes = answer.motion.iter().flat_map(|m| &m.modes);
    for m in modes.filter(|m| m.energy_share >= NAMED_SHARE) {
        let (mode, hertz, percent) = (m.mode, m.frequency_hz, 100.0 * m.energy_share);
        text +=
            &format!("    mode {mode:>3} ({hertz:.4} Hz) {percent:>5.1} % of the kinetic energy, ");
        text += &format!("phase {:>6.1}°\n", m.phase_deg);
    }
    text
}
