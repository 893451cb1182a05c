//! The table of all routes and the onset cards, in words.

use super::text::interval;
use super::vocabulary::{Dof, FlutterSearch, TextTable, speed_or};
use crate::flutter::{ModeBranch, ModeRatio, Onset, OnsetInterval};
use crate::study::{Route, RouteTable};
use crate::verdict::SanityLines;
use std::fmt::Write as _;

/// The table, the handbook lines, the cards and what was left out.
pub(crate) fn text(table: &RouteTable, speed_max_m_s: f64) -> String {
    let mut columns = TextTable::new(
        "Force model | route | >V_F m/s | >f Hz | >V/(fB) | >V/(ωB) | >|y|/B|θ| | >phase ° | >dζ/dV s/m | mode | >V_D m/s | kind; in tested range",
    );
    for route in &table.routes {
        add(&mut columns, route);
    }
    for failed in &table.failed {
        let method = failed.method.map_or("", |m| m.name());
        let head = [failed.model.clone(), method.to_owned()];
        columns.sentence(head, &format!("no answer: {}", failed.reason));
    }
    let mut text = columns.text();
    text.extend(table.sanity.iter().map(sanity));
    let left_out = table.left_out.iter();
    text.extend(left_out.map(|left_out| format!("left out: {left_out}\n")));
    text.push('\n');
    for route in cards(table) {
        text.push_str(&card(route, table.sanity.as_ref(), speed_max_m_s));
    }
    text
}

/// A row of the table.
fn add(table: &mut TextTable, route: &Route) {
    let divergence = route.divergence_m_s.map(|v| format!("{v:.3}"));
    let divergence = divergence.unwrap_or("none".to_owned());
    let name = [route.model.clone(), route.method.name().to_owned()];
    let mut without =
        |answer: &str| table.sentence(name.clone(), &format!("{answer}; divergence {divergence}"));
    let of_mode =
        |o: &Onset, words: fn(&ModeRatio) -> String| o.mode.as_ref().map_or("–".to_owned(), words);
    match &route.search {
        FlutterSearch::Onset(o) => match o.headline_m_s() {
            Err(reason) => without(reason),
            Ok(_) => table.row(
                name.into_iter().chain([
                    format!("{:.3}", o.at.speed_m_s),
                    format!("{:.4}", o.at.frequency_hz),
                    format!("{:.3}", o.at.reduced_velocity.v_star()),
                    format!("{:.3}", o.at.reduced_frequency.v_hat()),
                    of_mode(o, |m| format!("{:.4}", m.mode_ratio)),
                    of_mode(o, |m| format!("{:.1}", m.phase_deg)),
                    o.damping_slope_s_m
                        .map_or("unknown".to_owned(), |s| format!("{s:.5}")),
                    o.branch.to_string(),
                    divergence,
                    format!("{}; {}", kind(route), tested(o, route)),
                ]),
            ),
        },
        FlutterSearch::UnstableAtOrBelow(_) | FlutterSearch::StableUpTo(_) => {
            without(&route.search.explain());
        }
    }
}

fn kind(route: &Route) -> &'static str {
    route.mode.as_ref().map_or("", |m| m.kind.name())
}

fn tested(onset: &Onset, route: &Route) -> &'static str {
    match onset.in_tested_range {
        None if route.low_frequency_limit => "limit",
        Some(true) => "yes",
        Some(false) => "NO",
        None => "exact",
    }
}

fn sanity(lines: &SanityLines) -> String {
    format!(
        "sanity lines (flat plate, no damping): Selberg {:.3} m/s (3.72: {:.3}), Rocard {:.3} m/s\n",
        lines.selberg_m_s, lines.selberg_rounded_m_s, lines.rocard_m_s
    )
}

/// One card per force model: by eigenvalues where it has them, else by the determinant.
fn cards(table: &RouteTable) -> impl Iterator<Item = &Route> {
    let mut seen: Vec<&str> = Vec::new();
    table.routes.iter().filter(move |route| {
        let first = !seen.contains(&route.model.as_str());
        seen.push(&route.model);
        first
    })
}

fn card(route: &Route, sanity: Option<&SanityLines>, speed_max_m_s: f64) -> String {
    let mut text = format!("Onset card: {} ({})\n", route.model, route.method.name());
    match &route.search {
        FlutterSearch::Onset(onset) => match onset.headline_m_s() {
            Ok(_) => text.push_str(&found(onset, route)),
            Err(reason) => {
                let _ = writeln!(text, "  onset {reason}");
            }
        },
        FlutterSearch::UnstableAtOrBelow(_) | FlutterSearch::StableUpTo(_) => {
            let _ = writeln!(text, "  {}", route.search.explain());
        }
    }
    let none_below = format!("none below {speed_max_m_s:.3} m/s");
    let divergence = speed_or("none", route.divergence_m_s);
    let limit = speed_or(&none_below, route.quasi_steady_m_s);
    text += &format!("  divergence {divergence}; quasi-steady limit {limit}");
    let _ = match sanity {
        Some(lines) => writeln!(text, "; Selberg {:.3} m/s", lines.selberg_m_s),
        None => writeln!(text),
    };
    let warnings = route.warnings.iter();
    text.extend(warnings.map(|warning| format!("  warning: {warning}\n")));
    text
}

fn found(o: &Onset, route: &Route) -> String {
    let (speed, hertz, v_star) = (
        o.at.speed_m_s,
        o.at.frequency_hz,
        o.at.reduced_velocity.v_star(),
    );
    let (v_hat, k) = (
        o.at.reduced_frequency.v_hat(),
        o.at.reduced_frequency.full_width(),
    );
    let mut text = format!("  V_F {speed:.3} m/s at {hertz:.4} Hz; V* = V/(fB) {v_star:.3}, ");
    text += &format!("V̂ = V/(ωB) {v_hat:.3}, K {k:.4}");
    let _ = match &route.tested_range {
        Some(range) => {
            let (low, high, tested) = (range.max.v_hat(), range.min.v_hat(), tested(o, route));
            writeln!(text, " (tested V̂ {low:.2} to {high:.2}: {tested})")
        }
        None if route.low_frequency_limit => writeln!(text, " (a limit for K → 0)"),
        None => writeln!(text, " (exact at every K)"),
    };
    let _ = match &o.interval {
        OnsetInterval::Known(error) => {
            let ends = interval(&o.interval);
            writeln!(
                text,
                "  95 % interval {ends} m/s\n  {}",
                error.parts.explain()
            )
        }
        OnsetInterval::Spread { of, .. } => {
            let ends = interval(&o.interval);
            writeln!(text, "  {ends} m/s, no 95 % interval: {of}")
        }
        OnsetInterval::Undetermined { reason, .. } => writeln!(text, "  {reason}"),
        OnsetInterval::None { reason } => writeln!(text, "  no interval: {reason}"),
    };
    let slope = o.damping_slope_s_m.map(|s| format!("{s:.5} s/m"));
    let slope = slope.unwrap_or("unknown".to_owned());
    let (mode, branch) = (o.mode_in_words(), ModeBranch::in_words(&o.branch));
    let _ = writeln!(text, "  mode {mode}; damping slope dζ/dV {slope}");
    let _ = writeln!(text, "  {branch}: {}", kind(route));
    for p in route.mode.iter().flat_map(|m| &m.participation) {
        let name = match p.dof {
            Dof::Vertical => "H1*",
            Dof::Lateral => "P1*",
            Dof::Torsion => "A2*",
        };
        let alone = p.alone_m_s.map(|v| format!("onset at {v:.3} m/s"));
        let alone = alone.unwrap_or("no onset".to_owned());
        let (dof, percent, damping) = (p.dof.name(), 100.0 * p.energy_share, p.direct_damping);
        text += &format!("    {dof:<8} {percent:>5.1} % of the kinetic energy, ");
        text += &format!("{name} {damping:+.4}, alone: {alone}\n");
    }
    text
}

/// The onsets that the figure marks: one per force model, as on the cards.
pub(crate) fn marked(table: &RouteTable) -> Vec<Onset> {
    let onsets = cards(table).filter_map(|route| route.search.onset());
    let determined = onsets.filter(|o| o.headline_m_s().is_ok());
    determined.cloned().collect()
}
