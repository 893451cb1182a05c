//! The lowest wind speed at which something critical begins.

use super::critical_speed::{CriticalSpeed, Phenomenon};
use super::evidence::{Evidence, FlutterReading};
use crate::flutter::FlutterSearch;
use serde::{Deserialize, Serialize};

/// Readings closer than this, relatively, are one answer: what ways of interpolating one table differ by at worst.
pub(super) const ONE_ANSWER: f64 = 0.01;

/// Everything critical that was found, and how far was looked.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Critical {
    /// What begins first by its lower end; `None` where nothing was found.
    pub governs: Option<CriticalSpeed>,
    /// The others, in rising order.
    pub others: Vec<CriticalSpeed>,
    /// Lowest speed from which on every mode lies among the tests or below them, m/s: the tests judge from here on.
    pub judged_from_m_s: f64,
    /// Highest, m/s; beyond, nothing is known.
    pub judged_to_m_s: f64,
}

impl Critical {
    pub(super) fn find(evidence: &Evidence) -> Self {
        let mut all = flutter(&evidence.flutter);
        all.extend(evidence.divergence.iter().filter_map(|d| {
            Some(CriticalSpeed {
                phenomenon: Phenomenon::Divergence,
                forces: d.forces.clone(),
                best_m_s: d.speed_m_s?,
                lower_m_s: d.lower_m_s,
                extrapolated: false,
            })
        }));
        all.extend(evidence.galloping.clone());
        all.extend(growth(evidence));
        all.sort_by(|a, b| a.least_m_s().total_cmp(&b.least_m_s()));
        let first = evidence.flutter.first();
        let judged = first.map(FlutterReading::judged_m_s);
        let (from_m_s, judged_to_m_s) = judged.unwrap_or_default();
        let tested_from = first.and_then(FlutterReading::tested_from);
        let judged_from_m_s = tested_from.map_or(from_m_s, |t| from_m_s.max(t.speed_m_s));
        let mut all = all.into_iter();
        Self {
            governs: all.next(),
            others: all.collect(),
            judged_from_m_s,
            judged_to_m_s,
        }
    }

    /// Everything, in rising order of the lower ends.
    pub fn all(&self) -> impl Iterator<Item = &CriticalSpeed> {
        self.governs.iter().chain(&self.others)
    }

    /// The lower end of what governs, m/s.
    pub fn least_m_s(&self) -> Option<f64> {
        self.governs.as_ref().map(CriticalSpeed::least_m_s)
    }
}

/// The first reading with the lower end of all that agree with it, then those that contradict it.
fn flutter(readings: &[FlutterReading]) -> Vec<CriticalSpeed> {
    let Some((first, others)) = readings.split_first() else {
        return Vec::new();
    };
    let speed = |reading: &FlutterReading, lower_m_s| {
        Some(CriticalSpeed {
            phenomenon: Phenomenon::Flutter,
            forces: reading.forces.clone(),
            best_m_s: reading.best_m_s()?,
            lower_m_s,
            extrapolated: reading.extrapolated(),
        })
    };
    let lower = |reading: &FlutterReading| match reading.search {
        // nobody knows where what grows there begins
        FlutterSearch::UnstableAtOrBelow(_) => Some(0.0),
        _ => reading.ends_m_s().map(|(low, _)| low),
    };
    let (against, agreeing): (Vec<&FlutterReading>, Vec<_>) =
        others.iter().partition(|o| contradict(first, o));
    let of_others = agreeing.into_iter().filter_map(|o| {
        // the spread between ways of reading is no lower end of another answer
        let end = lower(o).filter(|_| o.interval_is_known());
        end.or(o.best_m_s())
    });
    let least = lower(first).into_iter().chain(of_others).reduce(f64::min);
    let mut all: Vec<CriticalSpeed> = speed(first, least).into_iter().collect();
    all.extend(against.into_iter().filter_map(|o| speed(o, lower(o))));
    all
}

/// Whether two readings of the same data differ by more than their intervals, or one finds what the other excludes.
pub(super) fn contradict(a: &FlutterReading, b: &FlutterReading) -> bool {
    let begins_below = |r: &FlutterReading| matches!(r.search, FlutterSearch::UnstableAtOrBelow(_));
    match (a.best_m_s(), b.best_m_s()) {
        // neither knows where it begins
        (Some(_), Some(_)) if begins_below(a) && begins_below(b) => false,
        (Some(x), Some(y)) => {
            let ends = |r: &FlutterReading, v: f64| r.range_m_s().unwrap_or((v, v));
            let ((a_low, a_high), (b_low, b_high)) = (ends(a, x), ends(b, y));
            let apart = (a_low - b_high).max(b_low - a_high);
            apart > ONE_ANSWER * x.min(y)
        }
        (Some(x), None) => excludes(b, x, a.ends_m_s()),
        (None, Some(y)) => excludes(a, y, b.ends_m_s()),
        (None, None) => false,
    }
}

/// Whether a reading without growth was judged well beyond the growth of another.
fn excludes(stable: &FlutterReading, best_m_s: f64, ends: Option<(f64, f64)>) -> bool {
    let (from, to) = stable.judged_m_s();
    let (low, high) = ends.unwrap_or((best_m_s, best_m_s));
    high * (1.0 + ONE_ANSWER) < to && low > from
}

/// Growth that was found by the scan below the answer.
fn growth(evidence: &Evidence) -> Option<CriticalSpeed> {
    let bands = evidence.growth.as_ref()?.bands.iter();
    Some(CriticalSpeed {
        phenomenon: Phenomenon::Growth,
        forces: evidence.flutter.first()?.forces.clone(),
        best_m_s: bands.map(|b| b.from_m_s).reduce(f64::min)?,
        lower_m_s: None,
        extrapolated: true,
    })
}
