//! What evidence amounts to, before it is put in words.

use super::critical::Critical;
use super::doubt::Doubt;
use super::doubts;
use super::evidence::{Evidence, FlutterReading, RequiredSpeed};
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

/// The highest requirement, to a tenth of a metre per second, that this evidence meets, and would meet after a search for it.
fn suggestion(evidence: &Evidence, critical: &Critical) -> Option<f64> {
    let found = evidence.flutter.first().and_then(FlutterReading::best_m_s);
    let searched = evidence.searched_to_m_s.filter(|_| found.is_none());
    let least = critical
        .least_m_s()
        .into_iter()
        .chain(searched.map(RequiredSpeed::of_search))
        .fold(critical.judged_to_m_s, f64::min);
    let met = |speed_m_s: &f64| {
        let required = Evidence {
            required: Some(RequiredSpeed {
                speed_m_s: *speed_m_s,
            }),
            ..evidence.clone()
        };
        let is_speed = speed_m_s.is_finite() && *speed_m_s > 0.0;
        is_speed && Judgement::new(&required).outcome == Some(Outcome::Met)
    };
    // half of an onset whose interval is not known
    [least, RequiredSpeed::of_search(least)]
        .map(|speed_m_s| (10.0 * speed_m_s).floor() / 10.0)
        .into_iter()
        .find(met)
}
