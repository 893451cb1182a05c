//! The doubt that parts of a bridge leave in whose forces no test stands behind.

use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::{FlutterReading, UntestedPart, UntestedParts};
use super::words::speed;

/// Share of a bridge in the wind from which on forces without a test bear on its onset wherever they act: at mid-span 4 % of
/// Langenuen move it by 2.2 m/s, more than half a 95 % interval, at its ends by 0.1.
const BEARS: f64 = 0.05;
/// What other forces may move the onset by before it counts, relative to the onset.
const MOVES_AT_MOST: f64 = 0.01;

/// The doubt; `clears` tells whether a speed is known to lie above what is required.
pub(super) fn untested(
    parts: &UntestedParts,
    first: &FlutterReading,
    clears: impl Fn(f64) -> bool,
) -> Doubt {
    let (low, high) = first
        .ends_m_s()
        .or(parts.as_it_is_m_s.map(|v| (v, v)))
        .unwrap_or((0.0, 0.0));
    let bears = |other: Option<f64>| match (parts.as_it_is_m_s, other) {
        (None, None) => false,
        (None, Some(other)) => !clears(other),
        (Some(_), None) => true,
        (Some(own), Some(other)) => {
            let moved = (other - own).abs();
            // a 95 % interval is four standard errors wide
            let allowed = (MOVES_AT_MOST * own).max(0.25 * (high - low));
            moved > allowed && !clears(low - moved)
        }
    };
    let share: f64 = parts.parts.iter().map(|p| p.share).sum();
    let grave = share >= BEARS || bears(parts.as_tested_m_s) || bears(parts.in_still_air_m_s);
    let severity = match grave {
        true => Severity::Severe,
        false => Severity::Minor,
    };
    let part = |p: &UntestedPart| {
        format!(
            "{} ({:.0} % of what the wind does to the modes) are {}",
            p.part,
            100.0 * p.share,
            p.forces
        )
    };
    let named: Vec<String> = parts.parts.iter().map(part).collect();
    let at = |v: Option<f64>| v.map_or("nowhere".to_owned(), |v| format!("at {}", speed(v)));
    let text = format!(
        "The forces of {}, which no test of this deck confirms; the onset by the models is {}, with the forces of section {} there \
         {}, with none {}",
        named.join(", those of "),
        at(parts.as_it_is_m_s),
        parts.tested,
        at(parts.as_tested_m_s),
        at(parts.in_still_air_m_s)
    );
    let names: Vec<&str> = parts.parts.iter().map(|p| p.part.as_str()).collect();
    Doubt::new(severity, DoubtKind::Untested, text)
        .settled_by(format!("measured derivatives of {}", names.join(", ")))
}
