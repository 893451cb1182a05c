//! Whether a requirement is met.

use super::critical::Critical;
use super::critical_speed::{CriticalSpeed, Phenomenon};
use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::RequiredSpeed;
use serde::{Deserialize, Serialize};

/// Whether what is required is met.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum Outcome {
    /// Everything critical lies above, judged by data, without a severe doubt.
    Met,
    /// Something critical begins below.
    NotMet {
        /// Which of its numbers lies below.
        below: Below,
    },
    /// Data do not say.
    CannotBeJudged {
        /// What is missing, in sentences.
        missing: Vec<String>,
        /// What would settle it.
        settled_by: Vec<String>,
    },
}

/// Which number of a critical speed lies below the required speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Below {
    /// The best estimate.
    BestEstimate,
    /// Only the lower end.
    LowerEnd,
}

impl Outcome {
    pub(super) fn judge(required: RequiredSpeed, critical: &Critical, doubts: &[Doubt]) -> Self {
        if !(required.speed_m_s > 0.0 && required.speed_m_s.is_finite()) {
            return Self::CannotBeJudged {
                missing: vec![format!("{} m/s is no wind speed", required.speed_m_s)],
                settled_by: vec!["a positive required speed".to_owned()],
            };
        }
        let open = |d: &Doubt| matches!(d.kind, DoubtKind::IntervalUndetermined { .. });
        let undetermined = doubts.iter().any(open);
        // forces of steady flow that another reading does not find
        let contradicted = |c: &CriticalSpeed| {
            doubts.iter().any(|d| match &d.kind {
                DoubtKind::Contradiction {
                    phenomenon: Phenomenon::Divergence,
                    first,
                    second_m_s,
                    ..
                } => *first == c.forces && second_m_s.is_none_or(|v| v >= required.speed_m_s),
                _ => false,
            })
        };
        // growth that forces make up where nothing was tested, and an onset that the data do not determine, say neither
        let backed = |c: &&CriticalSpeed| match c.phenomenon {
            Phenomenon::Growth => false,
            Phenomenon::Flutter => !undetermined,
            Phenomenon::Divergence => !contradicted(c),
            Phenomenon::Galloping => true,
        };
        let least = |c: &CriticalSpeed| c.least_m_s() < required.speed_m_s;
        let best = |c: &CriticalSpeed| c.best_m_s < required.speed_m_s;
        let found = || critical.all().filter(backed);
        if found().any(best) {
            let below = Below::BestEstimate;
            return Self::NotMet { below };
        }
        if found().any(least) {
            let below = Below::LowerEnd;
            return Self::NotMet { below };
        }
        let severe = || doubts.iter().filter(|d| d.severity == Severity::Severe);
        let missing: Vec<String> = severe().map(|d| d.text.clone()).collect();
        if missing.is_empty() {
            return Self::Met;
        }
        let mut settled_by: Vec<String> = severe().filter_map(|d| d.settled_by.clone()).collect();
        settled_by.dedup();
        Self::CannotBeJudged {
            missing,
            settled_by,
        }
    }

    /// In capitals, as it stands before an answer.
    pub fn words(&self) -> &'static str {
        match self {
            Self::Met => "MET",
            Self::NotMet { .. } => "NOT MET",
            Self::CannotBeJudged { .. } => "CANNOT BE JUDGED",
        }
    }

    /// A sign for it; never without the words.
    pub fn sign(&self) -> &'static str {
        match self {
            Self::Met => "✓",
            Self::NotMet { .. } => "✗",
            Self::CannotBeJudged { .. } => "?",
        }
    }
}
