//! The doubts that a bridge leaves which is not whole: parts in whose forces no test stands behind, modes that are left out.

use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::{FlutterReading, ModesLeftOut, UntestedPart, UntestedParts};
use super::words::speed;
use crate::error::counted;

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
    let own = parts.as_it_is_m_s;
    let bears = |other: Option<f64>| bears(own, other, first, &clears);
    let share: f64 = parts.parts.iter().map(|p| p.share).sum();
    let grave = share >= BEARS || bears(parts.as_tested_m_s) || bears(parts.in_still_air_m_s);
    let severity = Severity::severe_if(grave);
    let part = |p: &UntestedPart| {
        format!(
            "{} ({:.0} % of what the wind does to the modes) are {}",
            p.part,
            100.0 * p.share,
            p.forces
        )
    };
    let named: Vec<String> = parts.parts.iter().map(part).collect();
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

/// The doubt that modes leave which are left out.
pub(super) fn left_out(
    modes: &ModesLeftOut,
    first: &FlutterReading,
    clears: impl Fn(f64) -> bool,
) -> Doubt {
    let severity = Severity::severe_if(bears(
        modes.as_it_is_m_s,
        modes.with_all_m_s,
        first,
        &clears,
    ));
    let text = format!(
        "{} of the file are left out; the onset by the models is {}, with all of them {}",
        counted(modes.modes.len(), "mode"),
        at(modes.as_it_is_m_s),
        at(modes.with_all_m_s)
    );
    Doubt::new(severity, DoubtKind::ModesLeftOut, text).settled_by("all modes of the file")
}

fn at(speed_m_s: Option<f64>) -> String {
    speed_m_s.map_or("nowhere".to_owned(), |v| format!("at {}", speed(v)))
}

/// Whether another onset than that of the model, by other forces or modes, is so far away that the answer could be another.
fn bears(
    own: Option<f64>,
    other: Option<f64>,
    first: &FlutterReading,
    clears: &impl Fn(f64) -> bool,
) -> bool {
    match (own, other) {
        (None, None) => false,
        (None, Some(other)) => !clears(other),
        (Some(_), None) => true,
        (Some(own), Some(other)) => {
            let (low, high) = first.ends_m_s().unwrap_or((own, own));
            let moved = (other - own).abs();
            // a 95 % interval is four standard errors wide
            let allowed = (MOVES_AT_MOST * own).max(0.25 * (high - low));
            moved > allowed && !clears(low - moved)
        }
    }
}
