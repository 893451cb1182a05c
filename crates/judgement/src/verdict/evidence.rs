//! Everything that is known before a verdict: answers of searches, limits of tests, failures, findings.

use super::critical_speed::CriticalSpeed;
use crate::flutter::{
    FlutterCurves, FlutterSearch, ModePoint, MovedOnset, Onset, OnsetInterval, StableRange,
    TestedFrom, UnwantedGrowth,
};
use crate::plausibility::Finding;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use serde::{Deserialize, Serialize};

/// The wind speed below which nothing critical may begin: the criterion of a code.
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_judgement::*; }
/// use aerodeck::verdict::{Evidence, RequiredSpeed, Verdict};
///
/// // nothing was looked at
/// let required = Some(RequiredSpeed { speed_m_s: 60.0 });
/// assert!(Verdict::judge(&Evidence { required, ..Evidence::default() }).refuses());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RequiredSpeed {
    /// Wind speed, m/s.
    pub speed_m_s: f64,
}

impl RequiredSpeed {
    /// A search reaches this much beyond what is required: an onset above it may have an interval that reaches below, up to half of
    /// itself where it counts as determined.
    const BEYOND: f64 = 2.0;

    /// The wind speed that a search has to reach, m/s.
    pub fn searched_to_m_s(self) -> f64 {
        Self::BEYOND * self.speed_m_s
    }

    /// The highest speed that a search to this one, m/s, can show to be met where it finds nothing.
    pub(super) fn of_search(searched_to_m_s: f64) -> f64 {
        searched_to_m_s / Self::BEYOND
    }
}

/// What the searches, fits and checks of one structure have found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Evidence {
    /// The wind speed below which nothing critical may begin.
    pub required: Option<RequiredSpeed>,
    /// The searches for flutter. The first gives the answer, the others read the same data in other ways.
    pub flutter: Vec<FlutterReading>,
    /// Where the first of these searches ended, m/s; `None` where it went as far as its data.
    pub searched_to_m_s: Option<f64>,
    /// Static divergence, by each of the forces.
    pub divergence: Vec<Divergence>,
    /// Galloping by quasi-steady theory, where static coefficients are given and it was found.
    pub galloping: Option<CriticalSpeed>,
    /// Growth of the first of the readings below its onset, where nothing was tested; `None` where nobody looked.
    pub growth: Option<UnwantedGrowth>,
    /// Stages that failed.
    pub failures: Vec<StageFailure>,
    /// What constraints on the fit did to the onset.
    pub constraints: Option<MovedOnset>,
    /// Parts of the structure whose forces rest on no test, beside others that were tested.
    pub untested: Option<UntestedParts>,
    /// Modes of a bridge that are left out.
    pub modes_left_out: Option<ModesLeftOut>,
    /// Number of mean wind speeds of the tests; `None` where it is not known or there are no tests.
    pub test_speeds: Option<usize>,
    /// Input that does not look right.
    pub implausible: Vec<Finding>,
    /// Rotation in the mean wind.
    pub mean_rotation: Option<MeanRotation>,
    /// Largest rotation of the tests, deg; `None` where it is not known.
    pub tested_rotation_deg: Option<f64>,
    /// What else a reader must know; changes no outcome.
    pub remarks: Vec<String>,
}

/// A search for flutter with forces that rest on something.
#[derive(Debug, Clone, PartialEq)]
pub struct FlutterReading {
    /// Whose forces, as part of a sentence: `the model “Laguerre”`, `the table`.
    pub forces: String,
    /// What the search found.
    pub search: FlutterSearch,
    /// What the forces rest on.
    pub basis: ForceBasis,
}

/// What forces rest on.
#[derive(Debug, Clone, PartialEq)]
pub enum ForceBasis {
    /// Tests.
    Tested {
        /// Reduced frequencies of the tests.
        range: Box<ReducedFrequencyRange>,
        /// The wind speeds at which every mode stays among them.
        reach: Box<Reach>,
    },
    /// A closed formula that holds at every reduced frequency.
    Exact,
    /// Coefficients that are stated, of a theory that was not tested here.
    Stated,
}

impl ForceBasis {
    /// Tests in `range`, among which every mode is at the wind speeds of `reach`.
    pub fn tested(range: ReducedFrequencyRange, reach: Reach) -> Self {
        Self::Tested {
            range: Box::new(range),
            reach: Box::new(reach),
        }
    }
}

impl FlutterReading {
    /// The onset, where the search found one.
    pub(super) fn onset(&self) -> Option<&Onset> {
        self.search.onset()
    }

    /// Where growth is known, m/s.
    pub(super) fn best_m_s(&self) -> Option<f64> {
        self.search.critical_speed_m_s()
    }

    /// Ends of the interval or the spread of the onset, m/s.
    pub(super) fn ends_m_s(&self) -> Option<(f64, f64)> {
        self.onset()?.interval.ends()
    }

    /// What the interval leaves open, m/s, also where that is too much for a result: then no more than half or twice the onset, as an
    /// interval that holds everything would excuse everything.
    pub(super) fn range_m_s(&self) -> Option<(f64, f64)> {
        let onset = self.onset()?;
        let best = onset.at.speed_m_s;
        match onset.interval {
            OnsetInterval::Undetermined { error, .. } => Some((
                error.low_m_s.max(0.5 * best),
                error.high_m_s.min(2.0 * best),
            )),
            ref other => other.ends(),
        }
    }

    /// Whether the onset has an interval that is a statement of probability, or needs none.
    pub(super) fn interval_is_known(&self) -> bool {
        let known = |o: &Onset| matches!(o.interval, OnsetInterval::Known(_));
        self.basis == ForceBasis::Exact || self.onset().is_none_or(known)
    }

    /// Whether data reach the growth that was found.
    pub(super) fn extrapolated(&self) -> bool {
        let inside = match &self.search {
            FlutterSearch::Onset(onset) => onset.in_tested_range,
            FlutterSearch::UnstableAtOrBelow(start) => start.in_tested_range,
            FlutterSearch::StableUpTo(_) => None,
        };
        inside == Some(false)
    }

    /// The last mode that comes among the tests as the wind rises; `None` where all are from the beginning, or nothing was tested.
    pub(super) fn tested_from(&self) -> Option<&TestedFrom> {
        match &self.basis {
            ForceBasis::Tested { reach, .. } => reach.tested_from.as_ref(),
            ForceBasis::Exact | ForceBasis::Stated => None,
        }
    }

    /// Lowest and highest speed between which every mode was looked at and its forces rest on something, m/s.
    pub(super) fn judged_m_s(&self) -> (f64, f64) {
        let searched = match &self.search {
            FlutterSearch::Onset(onset) => (0.0, onset.at.speed_m_s),
            FlutterSearch::UnstableAtOrBelow(start) => (start.at.speed_m_s, start.at.speed_m_s),
            FlutterSearch::StableUpTo(range) => (range.from_m_s, range.to_m_s),
        };
        match &self.basis {
            ForceBasis::Tested { reach, .. } => {
                (searched.0.max(reach.from_m_s), searched.1.min(reach.to_m_s))
            }
            ForceBasis::Exact | ForceBasis::Stated => searched,
        }
    }
}

/// Static divergence by some forces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Divergence {
    /// Whose forces: a force model, or, in evidence, part of a sentence.
    #[serde(rename = "model")]
    pub forces: String,
    /// Speed, m/s; `None` where there is none.
    pub speed_m_s: Option<f64>,
    /// The speed that is left when what was assumed about steady flow is as wrong as on a flat plate, m/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lower_m_s: Option<f64>,
    /// What was assumed about steady flow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub assumed: Option<String>,
    /// Whether the forces were measured in steady flow on a deck at rest.
    #[serde(skip)]
    pub measured: bool,
}

impl Divergence {
    /// Divergence without assumptions.
    pub fn at(forces: &str, speed_m_s: Option<f64>) -> Self {
        Self {
            forces: forces.to_owned(),
            speed_m_s,
            lower_m_s: None,
            assumed: None,
            measured: false,
        }
    }
}

/// A part of the girder that was not tested.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UntestedPart {
    /// Which, in words.
    pub part: String,
    /// What its forces are made from, in words.
    pub forces: String,
    /// Its part of what the wind does to all modes, 0 to 1.
    pub share: f64,
}

/// All of them, and what the onset by the models is with other forces there; `None` where there is none in the range searched.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UntestedParts {
    /// The parts.
    pub parts: Vec<UntestedPart>,
    /// With the forces as they are, m/s.
    pub as_it_is_m_s: Option<f64>,
    /// The tested section with the largest share.
    pub tested: String,
    /// With its forces on these parts as well, m/s.
    pub as_tested_m_s: Option<f64>,
    /// With no forces on them, m/s.
    pub in_still_air_m_s: Option<f64>,
}

/// Modes of the file that are left out, and what the onset by the models is with and without; `None` where there is none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModesLeftOut {
    /// Their numbers.
    pub modes: Vec<usize>,
    /// Without them, m/s.
    pub as_it_is_m_s: Option<f64>,
    /// With them, m/s.
    pub with_all_m_s: Option<f64>,
}

/// A stage that failed; what does not need it went on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StageFailure {
    /// Which stage, in words.
    pub stage: String,
    /// Why.
    pub reason: String,
    /// Whether the answer would be the same without the failure.
    #[serde(skip)]
    pub beside_answer: bool,
}

impl StageFailure {
    /// A stage and why it failed, which may bear on the answer.
    pub fn new(stage: impl Into<String>, reason: impl ToString) -> Self {
        Self {
            stage: stage.into(),
            reason: reason.to_string(),
            beside_answer: false,
        }
    }

    /// The failure in words.
    pub fn explain(&self) -> String {
        format!("FAILED {}: {}", self.stage, self.reason)
    }
}

/// Rotation in the mean wind, and at the tests.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeanRotation {
    /// The critical wind speed, or else the required one, m/s.
    pub speed_m_s: f64,
    /// Greatest, there, or farthest from that of the tests, deg; nose-up positive.
    pub rotation_deg: f64,
    /// That of the tests, deg; 0 where it is not stated.
    pub tested_deg: Option<f64>,
}

/// How far tests reach as the wind rises.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Lowest speed at which every mode lies among the tests, or above them where the forces damp every such motion, m/s.
    pub from_m_s: f64,
    /// The last mode that comes among the tests as the wind rises; `None` where all are from the beginning.
    pub tested_from: Option<TestedFrom>,
    /// Highest, m/s.
    pub to_m_s: f64,
    /// Why nothing is known outside.
    pub why: Option<String>,
    /// Lowest reduced frequency of any mode over the wind speed, in rising order of the speed: m/s, `K`.
    pub(super) lowest: Vec<(f64, f64)>,
}

impl Reach {
    /// Tests that reach every speed.
    pub fn everywhere() -> Self {
        Self {
            from_m_s: 0.0,
            tested_from: None,
            to_m_s: f64::INFINITY,
            why: None,
            lowest: Vec::new(),
        }
    }

    /// Tests of a table, beyond which nothing is searched.
    pub fn of_table(tested_from: Option<TestedFrom>) -> Self {
        Self {
            tested_from,
            ..Self::everywhere()
        }
    }

    /// Tests of which it is not known at which speeds modes are among them.
    pub fn nowhere() -> Self {
        Self {
            to_m_s: 0.0,
            ..Self::everywhere()
        }
    }

    /// The speeds that a search of a structure of this width could `judge`; its modes are in `curves`.
    pub fn new(
        judged: StableRange,
        tested_from: Option<TestedFrom>,
        curves: &FlutterCurves,
        width_m: f64,
    ) -> Self {
        let mut all: Vec<&ModePoint> = curves.branches.iter().flat_map(|b| &b.points).collect();
        all.sort_by(|a, b| a.speed_m_s.total_cmp(&b.speed_m_s));
        let mut lowest: Vec<(f64, f64)> = Vec::new();
        for point in all {
            let k = ReducedFrequency::from_hertz(point.frequency_hz, width_m, point.speed_m_s)
                .full_width();
            if lowest.last().is_none_or(|(_, least)| k < *least) {
                lowest.push((point.speed_m_s, k));
            }
        }
        Self {
            from_m_s: judged.from_m_s,
            tested_from,
            to_m_s: judged.to_m_s,
            why: judged.not_judged,
            lowest,
        }
    }

    /// The reduced frequencies below `tested` that modes come to at speeds up to this one; `None` where there are none.
    pub fn missing_up_to(
        &self,
        speed_m_s: f64,
        tested: ReducedFrequencyRange,
    ) -> Option<ReducedFrequencyRange> {
        let within = self.lowest.iter().take_while(|(v, _)| *v <= speed_m_s);
        let (_, least) = within.last()?;
        let min = ReducedFrequency::from_full_width(*least);
        (min < tested.min).then(|| ReducedFrequencyRange::between(min, tested.min))
    }
}
