//! What evidence amounts to, before it is put in words.

use super::critical::{Critical, CriticalSpeed};
use super::doubt::Doubt;
use super::doubts;
use super::evidence::{Evidence, RequiredSpeed};
use super::outcome::Outcome;

/// A verdict without its sentences.
pub(super) struct Judgement {
    /// Whether the requirement is met; `None` where none is stated.
    pub outcome: Option<Outcome>,
    pub critical: Critical,
    /// The gravest first.
    pub doubts: Vec<Doubt>,
    /// The highest requirement that would be met, m/s, where none is stated.
    pub suggested_m_s: Option<f64>,
}

impl Judgement {
    pub(super) fn new(evidence: &Evidence) -> Self {
        let critical = Critical::find(evidence);
        let doubts = doubts::all(evidence, &critical);
        let required = evidence.required;
        Self {
            outcome: required.map(|r| Outcome::judge(r, &critical, &doubts)),
            suggested_m_s: match required {
                None => suggestion(evidence, &critical),
                Some(_) => None,
            },
            critical,
            doubts,
        }
    }
}

/// The highest requirement, to a tenth of a metre per second, that this evidence meets.
fn suggestion(evidence: &Evidence, critical: &Critical) -> Option<f64> {
    let least = critical
        .governs
        .as_ref()
        .map_or(f64::INFINITY, CriticalSpeed::least_m_s);
    let speed_m_s = (10.0 * least.min(critical.judged_to_m_s)).floor() / 10.0;
    if !(speed_m_s.is_finite() && speed_m_s > 0.0) {
        return None;
    }
    let required = Evidence {
        required: Some(RequiredSpeed { speed_m_s }),
        ..evidence.clone()
    };
    let met = Judgement::new(&required).outcome == Some(Outcome::Met);
    met.then_some(speed_m_s)
}
