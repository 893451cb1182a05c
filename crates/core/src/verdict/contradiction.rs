//! Answers that exclude each other.

use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::{DivergenceReading, Evidence, FlutterReading};
use super::words::{found, speed};

/// Divergence by one reading of the tests over that by another from which on they contradict each other: between the fitted models and
/// the tables of the embedded decks it is 1.05 at most.
const APART: f64 = 1.25;

pub(super) fn contradiction(first: &FlutterReading, second: &FlutterReading) -> Doubt {
    let kind = DoubtKind::Contradiction {
        first: first.forces.clone(),
        first_m_s: first.best_m_s(),
        second: second.forces.clone(),
        second_m_s: second.best_m_s(),
    };
    let text = format!(
        "Contradiction: {} by {}, {} by {}",
        found(first),
        first.forces,
        found(second),
        second.forces
    );
    let mut doubt = Doubt::new(Severity::Severe, kind, text);
    let at = [first, second].map(|r| {
        r.search
            .critical()
            .map(|at| at.reduced_frequency.full_width())
    });
    let ks: Vec<String> = at.iter().flatten().map(|k| format!("{k:.2}")).collect();
    if !ks.is_empty() {
        doubt = doubt.settled_by(format!(
            "tests near K {}, where the two differ",
            ks.join(" and ")
        ));
    }
    doubt
}

/// Static divergence that is asked for, where another reading has it much later or not at all: forces of steady flow, which
/// no test of a moving deck has, are then what the form of a model makes of them.
pub(super) fn of_divergence(evidence: &Evidence, asked_m_s: f64) -> Option<Doubt> {
    let at = |d: &DivergenceReading| d.speed_m_s.unwrap_or(f64::INFINITY);
    let readings = || evidence.divergence.iter();
    let first = readings().min_by(|a, b| at(a).total_cmp(&at(b)))?;
    let least = |d: &DivergenceReading| d.lower_m_s.unwrap_or(at(d)).min(at(d));
    let second = readings().find(|d| least(d) > APART * at(first))?;
    if at(first) > asked_m_s {
        return None;
    }
    let kind = DoubtKind::Contradiction {
        first: first.forces.clone(),
        first_m_s: first.speed_m_s,
        second: second.forces.clone(),
        second_m_s: second.speed_m_s,
    };
    let other = second.speed_m_s.map_or("none".to_owned(), speed);
    let text = format!(
        "Contradiction: static divergence at {} by {}, {other} by {}",
        speed(at(first)),
        first.forces,
        second.forces
    );
    let doubt = Doubt::new(Severity::Severe, kind, text);
    Some(doubt.settled_by("static coefficients, or tests at lower K"))
}
