//! What a search for flutter answers: an onset, growth from the lowest speed that could be judged, or none.

use super::critical_point::CriticalPoint;
use super::judged::{RangePassages, StableRange};
use super::mode_words::mode_in_words;
use super::onset::{Onset, OnsetInterval};
use crate::units::ReducedFrequencyRange;
use serde::{Deserialize, Serialize};

/// Speeds closer than this, relatively, are one finding by two ways.
const SAME_SPEED: f64 = 1e-3;

/// Answer of a search.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::RationalModel;
/// use aerodeck::aeroelastic::CoupledSection;
/// use aerodeck::flutter::{FlutterSearch, OnsetSearch, find_onset};
/// use aerodeck::section::SectionModel;
///
/// let structure = SectionModel::iabse_1_1a().structure()?;
/// let section = CoupledSection::with_model(&structure, &RationalModel::jones_flat_plate())?;
/// let search = OnsetSearch { speed_max_m_s: 40.0, speeds: 80 };
/// match find_onset("plate", &section, &search, None)? {
///     FlutterSearch::StableUpTo(range) => assert_eq!(range.to_m_s, 40.0),
///     found => panic!("{}", found.explain()), // it flutters near 77 m/s
/// }
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FlutterSearch {
    /// The section flutters from this speed on.
    Onset(Box<Onset>),
    /// The section grows already at the lowest speed that could be judged: the onset lies there or below.
    UnstableAtOrBelow(Box<UnstableStart>),
    /// No flutter between these speeds.
    StableUpTo(StableRange),
}

/// Growth at the lowest speed at which a mode could be judged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UnstableStart {
    /// The lowest speed that could be judged, at or below which the onset is, and the growing motion there.
    #[serde(flatten)]
    pub at: CriticalPoint,
    /// Real part of the eigenvalue, 1/s.
    pub growth_rate_per_s: f64,
    /// Branch that grows.
    pub branch: String,
    /// Whether `K` lies in the range in which the model was tested; `None` when there is no such range.
    pub in_tested_range: Option<bool>,
    /// Why nothing is known below.
    pub reason: String,
    /// What a reader must know before using the number.
    pub warnings: Vec<String>,
    /// The first onset above that, where all modes that grew are damped again.
    pub onset_above: Option<Box<Onset>>,
    /// The speed below that onset from which on they are, m/s: up to it the section grows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damped_from_m_s: Option<f64>,
}

impl FlutterSearch {
    /// The answer of forces that hold at every reduced frequency: no test and no scatter bears on it.
    #[must_use]
    pub fn of_exact_forces(mut self) -> Self {
        if let Self::Onset(onset) = &mut self {
            onset.in_tested_range = None;
            onset.interval = OnsetInterval::none("the forces are exact");
        }
        self
    }

    /// The onset, if it was found; `None` also where the section grows from the lowest speed on.
    pub fn onset(&self) -> Option<&Onset> {
        match self {
            Self::Onset(onset) => Some(onset),
            Self::UnstableAtOrBelow(_) | Self::StableUpTo(_) => None,
        }
    }

    /// Where the section is known to grow: the onset lies there, or there or below.
    pub fn critical(&self) -> Option<&CriticalPoint> {
        match self {
            Self::Onset(onset) => Some(&onset.at),
            Self::UnstableAtOrBelow(start) => Some(&start.at),
            Self::StableUpTo(_) => None,
        }
    }

    /// Its speed, m/s.
    pub fn critical_speed_m_s(&self) -> Option<f64> {
        self.critical().map(|at| at.speed_m_s)
    }

    /// What comes first of onset, `divergence_m_s` and the end of what was judged, m/s; `limit_m_s`, up to which was searched, where
    /// nothing does.
    pub fn first_limit_m_s(&self, divergence_m_s: Option<f64>, limit_m_s: f64) -> f64 {
        let own = match self {
            Self::StableUpTo(range) => Some(range.to_m_s).filter(|to| *to > 0.0),
            growing => growing.critical_speed_m_s(),
        };
        let both = own.into_iter().chain(divergence_m_s);
        both.fold(limit_m_s, f64::min)
    }

    /// The answer in words.
    pub fn explain(&self) -> String {
        match self {
            Self::Onset(o) => format!("onset at {:.3} m/s", o.at.speed_m_s),
            Self::UnstableAtOrBelow(start) => start.explain(),
            Self::StableUpTo(range) => range.explain(),
        }
    }
}

impl UnstableStart {
    /// Growth of a motion; nothing about ranges yet.
    pub(super) fn new(
        at: CriticalPoint,
        growth_rate_per_s: f64,
        branch: String,
        reason: String,
    ) -> Self {
        Self {
            at,
            growth_rate_per_s,
            branch,
            in_tested_range: None,
            reason,
            warnings: Vec::new(),
            onset_above: None,
            damped_from_m_s: None,
        }
    }

    /// The answer in words.
    pub fn explain(&self) -> String {
        format!(
            "unstable at and below {:.3} m/s, the lowest speed that could be judged: {}, {:.4} Hz, K {:.4}, \
             growth {:+.4} 1/s ({})",
            self.at.speed_m_s,
            mode_in_words(&self.branch),
            self.at.frequency_hz,
            self.at.reduced_frequency.full_width(),
            self.growth_rate_per_s,
            self.reason
        ) + &self.above()
    }

    /// What comes above, in words.
    fn above(&self) -> String {
        self.onset_above.as_ref().map_or_else(String::new, |o| {
            let from = self.damped_from_m_s.unwrap_or(self.at.speed_m_s);
            format!(
                "; damped again only from {from:.3} m/s on, then onset at {:.3} m/s: {}, {:.4} Hz, K {:.4}",
                o.at.speed_m_s,
                mode_in_words(&o.branch),
                o.at.frequency_hz,
                o.at.reduced_frequency.full_width()
            )
        })
    }
}

/// Everything that a search came across.
#[derive(Debug)]
pub(super) struct Findings {
    /// Speeds at which a mode loses its damping.
    pub(super) crossings: Vec<Onset>,
    /// Modes that grow where they could be judged first.
    pub(super) starts: Vec<UnstableStart>,
    /// Speeds, m/s, at which a mode that grew is damped again, and its branch.
    pub(super) recoveries: Vec<(f64, String)>,
    /// The speeds that were looked at.
    pub(super) looked_at: StableRange,
    /// Highest speed to which modes could be followed, m/s.
    pub(super) followed_to_m_s: f64,
    /// Where modes come into what can be judged, and where they leave it.
    pub(super) reach: RangePassages,
    /// What a reader of an onset must know.
    pub(super) warnings: Vec<String>,
}

/// Picks the answer: the lowest crossing between the lowest and the highest tested `K`, be it in a gap, or growth where a mode
/// enters them if that is lower; crossings below are named as suspicious. Without either, the lowest outside, with a warning.
pub(super) fn choose(mut found: Findings, tested: Option<ReducedFrequencyRange>) -> FlutterSearch {
    let by_speed = |a: &CriticalPoint, b: &CriticalPoint| a.speed_m_s.total_cmp(&b.speed_m_s);
    found.crossings.sort_by(|a, b| by_speed(&a.at, &b.at));
    found.starts.sort_by(|a, b| by_speed(&a.at, &b.at));
    for onset in &mut found.crossings {
        let k = onset.at.reduced_frequency;
        onset.in_tested_range = tested.map(|range| range.contains(k));
        onset.gap = tested.and_then(|range| range.gap_at(k));
    }
    let spanned = |at: &CriticalPoint| tested.is_none_or(|r| r.spans(at.reduced_frequency));
    let (crossings, starts) = (&found.crossings, &found.starts);
    let onset = crossings.iter().position(|o| spanned(&o.at));
    let entered = |s: &UnstableStart| s.in_tested_range == Some(true) || spanned(&s.at);
    let start = starts.iter().position(entered);
    // what lies outside all that was tested is an answer only where there is none inside
    let any = [crossings.is_empty(), starts.is_empty()].map(|none| (!none).then_some(0));
    let (onset, start) = match (onset, start) {
        (None, None) => any.into(),
        trusted => trusted,
    };
    match (onset, start) {
        (Some(o), Some(s)) if starts[s].at.speed_m_s <= crossings[o].at.speed_m_s => {
            found.start(s, tested)
        }
        (Some(o), _) => found.onset(o, tested),
        (None, Some(s)) => found.start(s, tested),
        (None, None) => FlutterSearch::StableUpTo(found.reach.judged(found.looked_at)),
    }
}

impl Findings {
    /// Nothing yet between these speeds.
    pub(super) fn between(looked_at: StableRange) -> Self {
        Self {
            crossings: Vec::new(),
            starts: Vec::new(),
            recoveries: Vec::new(),
            looked_at,
            followed_to_m_s: 0.0,
            reach: RangePassages::default(),
            warnings: Vec::new(),
        }
    }

    /// Whether nothing grows.
    pub(super) fn is_empty(&self) -> bool {
        self.crossings.is_empty() && self.starts.is_empty()
    }

    /// Whether an onset or growth at this speed is among them.
    pub(super) fn knows(&self, speed_m_s: f64) -> bool {
        let same = |v: f64| (v / speed_m_s - 1.0).abs() < SAME_SPEED;
        self.crossings.iter().any(|o| same(o.at.speed_m_s))
            || self.starts.iter().any(|s| same(s.at.speed_m_s))
    }

    fn onset(mut self, chosen: usize, tested: Option<ReducedFrequencyRange>) -> FlutterSearch {
        let mut onset = self.crossings.swap_remove(chosen);
        let verdict = "probably spurious, a sign of over-fitting";
        let (spurious, warnings) = self.below(onset.at.speed_m_s, tested, verdict);
        onset.spurious_speeds_m_s.extend(spurious);
        onset.warnings.extend(warnings);
        onset.warnings.append(&mut self.warnings);
        let v_star = onset.at.reduced_velocity.v_star();
        if let Some(gap) = onset.gap {
            onset.warnings.push(format!(
                "K {:.3} of this onset lies {}: what the forces are there is the model's guess",
                onset.at.reduced_frequency.full_width(),
                gap.explain()
            ));
        } else if onset.in_tested_range == Some(false) {
            onset.warnings.push(format!(
                "V* {v_star:.2} at this onset lies outside the tested range: the model is extrapolating, the onset may be \
                 spurious"
            ));
        }
        FlutterSearch::Onset(Box::new(onset))
    }

    fn start(mut self, chosen: usize, tested: Option<ReducedFrequencyRange>) -> FlutterSearch {
        let above = self.onset_above(self.starts[chosen].at.speed_m_s);
        let mut start = self.starts.swap_remove(chosen);
        let below = |speed: &f64| above.as_ref().is_some_and(|o| *speed < o.at.speed_m_s);
        let recoveries = self.recoveries.iter().map(|r| r.0).filter(below);
        start.damped_from_m_s = recoveries.reduce(f64::max);
        start.onset_above = above;
        let (_, warnings) = self.below(start.at.speed_m_s, tested, "an extrapolation");
        start.warnings.extend(warnings);
        start.warnings.append(&mut self.warnings);
        FlutterSearch::UnstableAtOrBelow(Box::new(start))
    }

    /// The first crossing above a speed at which nothing else grows.
    fn onset_above(&self, speed_m_s: f64) -> Option<Box<Onset>> {
        let began = |at: &CriticalPoint, speed: f64| at.speed_m_s < speed;
        let clear = |onset: &&Onset| {
            let speed = onset.at.speed_m_s;
            let starts = self.starts.iter().filter(|s| began(&s.at, speed));
            let crossings = self.crossings.iter().filter(|o| began(&o.at, speed));
            let starts = starts.map(|s| (&s.branch, s.at.speed_m_s));
            let crossings = crossings.map(|o| (&o.branch, o.at.speed_m_s));
            let mut grown: Vec<_> = starts.chain(crossings).collect();
            // each growth ends with a recovery of its own
            grown.retain(|(branch, from)| {
                let ends = |(at, of): &(f64, String)| of == *branch && (*from..speed).contains(at);
                !self.recoveries.iter().any(ends)
            });
            speed > speed_m_s && grown.is_empty()
        };
        self.crossings.iter().find(clear).cloned().map(Box::new)
    }

    /// Growth below a speed, all of it outside the tested range: what is said of that at higher `K` than was tested is
    /// `verdict`.
    fn below(
        &self,
        speed_m_s: f64,
        tested: Option<ReducedFrequencyRange>,
        verdict: &str,
    ) -> (Vec<f64>, Vec<String>) {
        let crossings = self.crossings.iter();
        let crossings = crossings.map(|o| (&o.at, &o.branch, "loses damping"));
        let starts = self.starts.iter().map(|s| (&s.at, &s.branch, "grows"));
        let mut below: Vec<_> = crossings.chain(starts).collect();
        below.retain(|(at, ..)| at.speed_m_s < speed_m_s);
        below.sort_by(|a, b| a.0.speed_m_s.total_cmp(&b.0.speed_m_s));
        let warning = |(at, branch, what): &(&CriticalPoint, &String, &str)| {
            let slower = tested.is_some_and(|range| at.reduced_frequency < range.min);
            // slow motion is no place where a fit makes up growth: the deck may do it
            let verdict = match slower {
                true => {
                    "an extrapolation below the lowest tested K, which only tests there can confirm or refute"
                }
                false => verdict,
            };
            format!(
                "the model also {what} at {:.3} m/s (V* {:.2}, {}), outside the tested range: {verdict}",
                at.speed_m_s,
                at.reduced_velocity.v_star(),
                mode_in_words(branch)
            )
        };
        (
            below.iter().map(|b| b.0.speed_m_s).collect(),
            below.iter().map(warning).collect(),
        )
    }
}
