//! One verdict from everything that is known: is the wind speed that is required below everything critical, judged by data?
//!
//! [`Evidence`] is what the searches, fits and checks of a section, a bridge or a wind file have found. [`Verdict::judge`] is the
//! only place that says what it amounts to; every page, line and colour follows it.
//!
//! ```
//! # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_judgement::*; }
//! use aerodeck::verdict::{Divergence, Evidence, RequiredSpeed, Verdict};
//!
//! let mut evidence = Evidence::default();
//! evidence.required = Some(RequiredSpeed { speed_m_s: 100.0 });
//! evidence.divergence.push(Divergence::at("the model", Some(79.9)));
//! let verdict = Verdict::judge(&evidence);
//! assert!(!verdict.is_met());
//! assert!(verdict.headline.starts_with("✗ NOT MET, required 100 m/s: static divergence at 79.9 m/s"));
//! ```

mod critical;
mod critical_speed;
mod doubt;
mod doubts;
mod evidence;
mod judging;
mod outcome;
mod reasons;
mod sanity;
mod searched;
mod sentences;
mod words;

#[cfg(test)]
mod tests;

pub use critical::Critical;
pub use critical_speed::{CriticalSpeed, Phenomenon};
pub use doubt::{Doubt, DoubtKind, Severity};
pub use evidence::{
    Divergence, Evidence, FlutterReading, ForceBasis, MeanRotation, ModesLeftOut, Reach,
    RequiredSpeed, StageFailure, UntestedPart, UntestedParts,
};
pub use outcome::{Below, Outcome};
pub use sanity::{SanityLines, sanity_lines};

use serde::{Deserialize, Serialize};

/// Safety of a structure in the wind, in one value: outcome, critical speed and every doubt.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Verdict {
    /// The answer in one line; begins with the outcome where a speed is required.
    pub headline: String,
    /// Why the outcome is what it is, or what it takes to have one; a sentence or two.
    pub explanation: String,
    /// Whether the requirement is met; `None` where none is stated.
    pub outcome: Option<Outcome>,
    /// What is required.
    pub against: Option<RequiredSpeed>,
    /// The lowest speed at which something critical begins, and everything that was weighed.
    pub critical: Critical,
    /// What limits trust in it, the gravest first.
    pub doubts: Vec<Doubt>,
    /// The highest requirement that would be met, m/s, where none is stated; `None` where doubts leave none.
    pub suggested_m_s: Option<f64>,
}

impl Verdict {
    /// Whether a speed is required and everything critical is known to lie above it.
    pub fn is_met(&self) -> bool {
        self.outcome == Some(Outcome::Met)
    }

    /// Whether a speed is required and the outcome is anything but met.
    pub fn refuses(&self) -> bool {
        self.outcome.as_ref().is_some_and(|o| *o != Outcome::Met)
    }

    /// The sentences of all doubts, the gravest first.
    pub fn warnings(&self) -> impl Iterator<Item = &str> {
        self.doubts.iter().map(|d| d.text.as_str())
    }
}
