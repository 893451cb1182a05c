//! Answers that exclude each other.

use super::critical::Phenomenon;
use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::{DivergenceReading, Evidence, FlutterReading};
use super::words::{found, speed};

/// Divergence by one reading of the tests over that by another from which on they contradict each other: between the fitted models and
/// the tables of the embedded decks it is 1.05 at most.
const APART: f64 = 1.25;

pub(super) fn contradiction(first: &FlutterReading, second: &FlutterReading) -> Doubt {
    let kind = DoubtKind::Contradiction {
        phenomenon: Phenomenon::Flutter,
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

/// Two readings of steady flow.
pub(super) struct DivergenceContradiction<'a> {
    /// The one that makes it up.
    pub doubted: &'a DivergenceReading,
    /// The one that has it much later, or measured it.
    pub other: &'a DivergenceReading,
}

/// Static divergence that another reading has much later or not at all: forces of steady flow, which no test of a moving deck has, are
/// then what the form of a model makes of them. Coefficients that were measured at rest are believed.
pub(super) fn of_divergence(evidence: &Evidence) -> Option<DivergenceContradiction<'_>> {
    let at = |d: &DivergenceReading| d.speed_m_s.unwrap_or(f64::INFINITY);
    let readings = || evidence.divergence.iter();
    let first = readings().min_by(|a, b| at(a).total_cmp(&at(b)))?;
    let least = |d: &DivergenceReading| d.lower_m_s.unwrap_or(at(d)).min(at(d));
    let second = readings().find(|d| least(d) > APART * at(first))?;
    let (doubted, other) = if first.measured {
        (second, first)
    } else {
        (first, second)
    };
    Some(DivergenceContradiction { doubted, other })
}

impl DivergenceContradiction<'_> {
    /// The doubt of it, where a speed is asked for above the lower of the two.
    pub(super) fn doubt(&self, asked_m_s: f64) -> Option<Doubt> {
        let (doubted, other) = (self.doubted, self.other);
        let of = |d: &DivergenceReading| d.speed_m_s.map_or("none".to_owned(), speed);
        let least = doubted
            .speed_m_s
            .into_iter()
            .chain(other.speed_m_s)
            .reduce(f64::min)?;
        if least > asked_m_s {
            return None;
        }
        let kind = DoubtKind::Contradiction {
            phenomenon: Phenomenon::Divergence,
            first: doubted.forces.clone(),
            first_m_s: doubted.speed_m_s,
            second: other.forces.clone(),
            second_m_s: other.speed_m_s,
        };
        let text = format!(
            "Contradiction: static divergence at {} by {}, {} by {}",
            of(doubted),
            doubted.forces,
            of(other),
            other.forces
        );
        let doubt = Doubt::new(Severity::Severe, kind, text);
        Some(doubt.settled_by("static coefficients, or tests at lower K"))
    }
}
