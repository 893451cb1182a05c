//! What evidence amounts to.

use super::Verdict;
use super::critical::Critical;
use super::doubts;
use super::evidence::{Evidence, FlutterReading, RequiredSpeed};
use super::outcome::Outcome;
use super::sentences::{explanation, headline};

impl Verdict {
    /// What the evidence amounts to.
    pub fn judge(evidence: &Evidence) -> Self {
        let mut verdict = Self::unworded(evidence);
        verdict.headline = headline(&verdict, evidence);
        verdict.explanation = explanation(&verdict);
        verdict
    }

    /// The same without its sentences.
    fn unworded(evidence: &Evidence) -> Self {
        let (against, critical) = (evidence.required, Critical::find(evidence));
        let doubts = doubts::all(evidence, &critical);
        Self {
            outcome: against.map(|r| Outcome::judge(r, &critical, &doubts)),
            suggested_m_s: match against {
                None => suggestion(evidence, &critical),
                Some(_) => None,
            },
            against,
            critical,
            doubts,
            ..Self::default()
        }
    }
}

/// The highest requirement, to a tenth of a metre per second, that this evidence meets, and would meet after a search for it.
fn suggestion(evidence: &Evidence, critical: &Critical) -> Option<f64> {
    let found = evidence.flutter.first().and_then(FlutterReading::best_m_s);
    let searched = evidence.searched_to_m_s.filter(|_| found.is_none());
    let searched = searched.map(RequiredSpeed::of_search);
    let ends = critical.least_m_s().into_iter().chain(searched);
    let least = ends.fold(critical.judged_to_m_s, f64::min);
    let met = |&speed_m_s: &f64| {
        let required = Evidence {
            required: Some(RequiredSpeed { speed_m_s }),
            ..evidence.clone()
        };
        let is_speed = speed_m_s.is_finite() && speed_m_s > 0.0;
        is_speed && Verdict::unworded(&required).outcome == Some(Outcome::Met)
    };
    // half of an onset whose interval is not known
    let speeds = [least, RequiredSpeed::of_search(least)];
    let rounded = speeds.map(|speed_m_s| (10.0 * speed_m_s).floor() / 10.0);
    rounded.into_iter().find(met)
}
