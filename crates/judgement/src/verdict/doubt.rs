//! What limits trust in a verdict: a kind with its numbers, a sentence, how much it weighs, and what would settle it.

use super::critical_speed::Phenomenon;
use serde::{Deserialize, Serialize};

/// How much a doubt weighs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// To be known; changes no outcome.
    Minor,
    /// With it nothing is met.
    Severe,
}

impl Severity {
    /// Severe, or to be known.
    pub(super) fn severe_if(grave: bool) -> Self {
        if grave { Self::Severe } else { Self::Minor }
    }
}

/// One reason to doubt.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Doubt {
    /// How much it weighs.
    pub severity: Severity,
    /// A sentence without its full stop.
    pub text: String,
    /// What would settle it, as part of a sentence; `None` where nothing is missing.
    pub settled_by: Option<String>,
    /// The kind, with its numbers.
    #[serde(flatten)]
    pub kind: DoubtKind,
}

/// Reasons to doubt.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum DoubtKind {
    /// The reduced frequency of the onset was not tested.
    OutsideTestedRange {
        /// `K` at the onset.
        k: f64,
        /// Lowest `K` of the tests.
        tested_from_k: f64,
        /// Highest.
        tested_to_k: f64,
    },
    /// The onset lies between tests that are far apart in `K`.
    GapInTests {
        /// `K` at the onset.
        k: f64,
        /// Lower end of the gap.
        gap_from_k: f64,
        /// Upper end.
        gap_to_k: f64,
    },
    /// Above this speed a mode is not judged by data.
    NotJudgedAbove {
        /// Wind speed, m/s.
        speed_m_s: f64,
        /// The speed up to which it is asked for, m/s.
        asked_m_s: f64,
    },
    /// Below this speed a mode is not judged by data.
    NotJudgedBelow {
        /// Wind speed, m/s.
        speed_m_s: f64,
    },
    /// Nothing was searched.
    NotSearched,
    /// Nobody knows how far the data leave the onset open.
    IntervalUnknown {
        /// Why.
        reason: String,
    },
    /// The interval contains zero or is wider than the speed: the data do not determine the onset.
    IntervalUndetermined {
        /// Lower end, m/s.
        low_m_s: f64,
        /// Upper end, m/s.
        high_m_s: f64,
    },
    /// Tests at one mean wind speed do not show how results scatter between speeds.
    OneTestSpeed,
    /// A stage failed.
    StageFailed {
        /// Which.
        stage: String,
        /// Why.
        reason: String,
    },
    /// A motion grows below the onset by extrapolation.
    GrowthBelowOnset {
        /// Lowest speed with growth, m/s.
        from_m_s: f64,
        /// Highest, m/s.
        to_m_s: f64,
        /// Where it grows fastest: `K` there.
        k: f64,
    },
    /// Constraints moved the onset.
    ConstraintsMovedOnset {
        /// By the data alone, m/s; `None` without onset.
        without_m_s: Option<f64>,
        /// Under the constraints, m/s.
        with_m_s: Option<f64>,
    },
    /// Two readings of the same data differ by more than their intervals.
    Contradiction {
        /// What begins.
        phenomenon: Phenomenon,
        /// The one.
        first: String,
        /// Its speed, m/s; `None` without growth.
        first_m_s: Option<f64>,
        /// The other.
        second: String,
        /// Its speed, m/s.
        second_m_s: Option<f64>,
    },
    /// Input that does not look right.
    ImplausibleInput {
        /// Key, mode, run or column.
        place: String,
        /// The number there; `None` where several are meant.
        value: Option<f64>,
    },
    /// The forces are those of a theory that was not tested.
    Untested,
    /// Modes of a bridge are left out that may bear on the onset.
    ModesLeftOut,
    /// The structure turns in the mean wind beyond what was tested.
    MeanRotation {
        /// At the critical speed, deg.
        at_onset_deg: f64,
        /// At the tests, deg.
        tested_deg: f64,
    },
    /// Larger motions than those of the tests are not covered.
    Amplitude {
        /// Largest rotation of the tests, deg.
        tested_rotation_deg: f64,
    },
    /// Steady flow was not tested, divergence rests on an assumption.
    AssumedSteadyFlow,
    /// Something else to be known.
    Remark,
}

impl Doubt {
    /// A doubt of some weight; `text` without its full stop.
    pub(super) fn new(severity: Severity, kind: DoubtKind, text: impl Into<String>) -> Self {
        let mut text: String = text.into();
        while text.ends_with('.') {
            text.pop();
        }
        Self {
            severity,
            text,
            settled_by: None,
            kind,
        }
    }

    /// The same with what would settle it.
    pub(super) fn settled_by(mut self, what: impl Into<String>) -> Self {
        self.settled_by = Some(what.into());
        self
    }
}
