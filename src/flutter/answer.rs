//! What a search for flutter answers: an onset, growth from the lowest speed that could be judged, or none.

use super::critical_point::{CriticalPoint, OnsetMethod};
use super::onset::Onset;
use crate::section::Structure;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::Complex;
use serde::Serialize;
use std::f64::consts::TAU;

/// Speeds closer than this, relatively, are one finding by two ways.
const SAME_SPEED: f64 = 1e-3;

/// Answer of a search.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize)]
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
}

/// Speeds between which every mode was looked at and none grows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StableRange {
    /// Lowest speed at which all modes could be judged, m/s; 0 from still air.
    pub from_m_s: f64,
    /// Highest speed at which all modes could be judged, m/s.
    pub to_m_s: f64,
    /// Why nothing is known outside, where a speed that was asked for is.
    pub not_judged: Option<String>,
}

impl StableRange {
    /// Every speed from still air to this one, m/s.
    pub fn up_to(to_m_s: f64) -> Self {
        Self {
            from_m_s: 0.0,
            to_m_s,
            not_judged: None,
        }
    }
}

/// Where modes come into the range of reduced frequencies that can be judged, and where they leave it.
#[derive(Debug, Default)]
pub(super) struct RangePassages {
    /// Speed, m/s, and branch.
    pub(super) entries: Vec<(f64, String)>,
    /// The same at the other end.
    pub(super) exits: Vec<(f64, String)>,
}

impl RangePassages {
    /// The speeds up to `highest_m_s` at which every mode was judged.
    pub(super) fn judged(&self, highest_m_s: f64) -> StableRange {
        let last = self.entries.iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let first = self.exits.iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let first = first.filter(|(speed, _)| *speed < highest_m_s);
        let mut why: Vec<String> = last
            .iter()
            .map(|(speed, branch)| {
                format!("the {branch} branch can be judged from {speed:.3} m/s on")
            })
            .collect();
        why.extend(first.iter().map(|(speed, branch)| {
            format!("the {branch} branch can be judged up to {speed:.3} m/s")
        }));
        StableRange {
            from_m_s: last.map_or(0.0, |l| l.0),
            to_m_s: first.map_or(highest_m_s, |f| f.0),
            not_judged: (!why.is_empty()).then(|| why.join(", ")),
        }
    }
}

/// Why nothing is known below the speed at which a mode comes to the end `limit` of the range that can be judged.
pub(super) fn entry_reason(limit: ReducedFrequency) -> String {
    format!(
        "there its motion enters the range that can be judged, which ends at K {:.4}",
        limit.full_width()
    )
}

impl FlutterSearch {
    /// The onset, if it was found; `None` also where the section grows from the lowest speed on.
    pub fn onset(&self) -> Option<&Onset> {
        match self {
            Self::Onset(onset) => Some(onset),
            Self::UnstableAtOrBelow(_) | Self::StableUpTo(_) => None,
        }
    }

    /// Where the section is known to grow: the onset lies there, or there or below.
    pub(crate) fn critical(&self) -> Option<&CriticalPoint> {
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
    /// Growth at a speed (m/s) with the eigenvalue `lambda` (rad/s); nothing about ranges yet.
    pub(super) fn new(
        model: &str,
        method: OnsetMethod,
        structure: &Structure,
        (speed_m_s, lambda): (f64, Complex<f64>),
        branch: String,
        reason: String,
    ) -> Self {
        let k = ReducedFrequency::from_circular(lambda.im, structure.width_m, speed_m_s);
        Self {
            at: CriticalPoint::new(model, method, speed_m_s, lambda.im / TAU, k),
            growth_rate_per_s: lambda.re,
            branch,
            in_tested_range: None,
            reason,
            warnings: Vec::new(),
            onset_above: None,
        }
    }

    /// The answer in words.
    pub(crate) fn explain(&self) -> String {
        format!(
            "unstable at and below {:.3} m/s, the lowest speed that could be judged: {} branch, {:.4} Hz, K {:.4}, \
             growth {:+.4} 1/s ({})",
            self.at.speed_m_s,
            self.branch,
            self.at.frequency_hz,
            self.at.reduced_frequency.full_width(),
            self.growth_rate_per_s,
            self.reason
        ) + &self.above()
    }

    /// What comes above, in words.
    fn above(&self) -> String {
        self.onset_above.as_ref().map_or_else(String::new, |o| {
            format!(
                "; damped again above that, then onset at {:.3} m/s: {} branch, {:.4} Hz, K {:.4}",
                o.at.speed_m_s,
                o.branch,
                o.at.frequency_hz,
                o.at.reduced_frequency.full_width()
            )
        })
    }
}

impl StableRange {
    /// The answer in words.
    pub(crate) fn explain(&self) -> String {
        if self.from_m_s > self.to_m_s {
            let why = self
                .not_judged
                .as_deref()
                .unwrap_or("no speed was looked at");
            return format!("not judged: {why}");
        }
        let mut text = format!("no flutter up to {:.3} m/s", self.to_m_s);
        if self.from_m_s > 0.0 {
            text.push_str(&format!(", judged from {:.3} m/s", self.from_m_s));
        }
        if let Some(why) = &self.not_judged {
            text.push_str(&format!(" ({why})"));
        }
        text
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
    /// The speeds that were judged.
    pub(super) judged: StableRange,
    /// What a reader of an onset must know.
    pub(super) warnings: Vec<String>,
}

/// Picks the answer: the lowest crossing inside the tested range, or growth where a mode enters it if that is lower;
/// crossings below are named as suspicious. Without either, the lowest outside, with a warning.
pub(super) fn choose(mut found: Findings, tested: Option<ReducedFrequencyRange>) -> FlutterSearch {
    found
        .crossings
        .sort_by(|a, b| a.at.speed_m_s.total_cmp(&b.at.speed_m_s));
    found
        .starts
        .sort_by(|a, b| a.at.speed_m_s.total_cmp(&b.at.speed_m_s));
    let inside = |k: ReducedFrequency| tested.map(|range| range.contains(k));
    for onset in &mut found.crossings {
        onset.in_tested_range = inside(onset.at.reduced_frequency);
    }
    let (crossings, starts) = (&found.crossings, &found.starts);
    let onset = crossings
        .iter()
        .position(|o| o.in_tested_range != Some(false));
    let start = starts.iter().position(|s| s.in_tested_range != Some(false));
    // what lies outside the tested range is an answer only where there is none inside
    let (onset, start) = match (onset, start) {
        (None, None) => (
            (!crossings.is_empty()).then_some(0),
            (!starts.is_empty()).then_some(0),
        ),
        trusted => trusted,
    };
    match (onset, start) {
        (Some(o), Some(s)) if starts[s].at.speed_m_s <= crossings[o].at.speed_m_s => found.start(s),
        (Some(o), _) => found.onset(o),
        (None, Some(s)) => found.start(s),
        (None, None) => FlutterSearch::StableUpTo(found.judged),
    }
}

impl Findings {
    /// Nothing yet.
    pub(super) fn judged(judged: StableRange) -> Self {
        Self {
            crossings: Vec::new(),
            starts: Vec::new(),
            recoveries: Vec::new(),
            judged,
            warnings: Vec::new(),
        }
    }

    /// Whether an onset or growth at this speed is among them.
    pub(super) fn knows(&self, speed_m_s: f64) -> bool {
        let same = |v: f64| (v / speed_m_s - 1.0).abs() < SAME_SPEED;
        self.crossings.iter().any(|o| same(o.at.speed_m_s))
            || self.starts.iter().any(|s| same(s.at.speed_m_s))
    }

    fn onset(mut self, chosen: usize) -> FlutterSearch {
        let mut onset = self.crossings.swap_remove(chosen);
        let (spurious, warnings) = self.below(
            onset.at.speed_m_s,
            "probably spurious, a sign of over-fitting",
        );
        onset.spurious_speeds_m_s.extend(spurious);
        onset.warnings.extend(warnings);
        onset.warnings.append(&mut self.warnings);
        if onset.in_tested_range == Some(false) {
            onset.warnings.push(format!(
                "V* {:.2} at this onset lies outside the tested range: the model is extrapolating, the onset may be \
                 spurious",
                onset.at.reduced_velocity.v_star()
            ));
        }
        FlutterSearch::Onset(Box::new(onset))
    }

    fn start(mut self, chosen: usize) -> FlutterSearch {
        let above = self.onset_above(self.starts[chosen].at.speed_m_s);
        let mut start = self.starts.swap_remove(chosen);
        start.onset_above = above;
        let (_, warnings) = self.below(start.at.speed_m_s, "an extrapolation");
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
            let grown = starts
                .map(|s| (&s.branch, s.at.speed_m_s))
                .chain(crossings.map(|o| (&o.branch, o.at.speed_m_s)));
            let mut grown = grown.collect::<Vec<_>>();
            // each growth ends with a recovery of its own
            grown.retain(|(branch, from)| {
                let ends = |(at, of): &(f64, String)| of == *branch && (*from..speed).contains(at);
                !self.recoveries.iter().any(ends)
            });
            speed > speed_m_s && grown.is_empty()
        };
        self.crossings.iter().find(clear).cloned().map(Box::new)
    }

    /// Growth below a speed, all of it outside the tested range.
    fn below(&self, speed_m_s: f64, verdict: &str) -> (Vec<f64>, Vec<String>) {
        let crossings = self
            .crossings
            .iter()
            .map(|o| (&o.at, &o.branch, "loses damping"));
        let starts = self.starts.iter().map(|s| (&s.at, &s.branch, "grows"));
        let mut below: Vec<_> = crossings
            .chain(starts)
            .filter(|(at, ..)| at.speed_m_s < speed_m_s)
            .collect();
        below.sort_by(|a, b| a.0.speed_m_s.total_cmp(&b.0.speed_m_s));
        let warning = |(at, branch, what): &(&CriticalPoint, &String, &str)| {
            format!(
                "the model also {what} at {:.3} m/s (V* {:.2}, {branch} branch), outside the tested range: {verdict}",
                at.speed_m_s,
                at.reduced_velocity.v_star()
            )
        };
        (
            below.iter().map(|b| b.0.speed_m_s).collect(),
            below.iter().map(warning).collect(),
        )
    }
}
