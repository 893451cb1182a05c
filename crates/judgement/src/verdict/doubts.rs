//! The doubts that evidence leaves, and how much each weighs against what is required.

use super::below::not_judged_below;
use super::contradiction::{contradiction, of_divergence};
use super::critical::{Critical, contradict};
use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::{Evidence, FlutterReading, ForceBasis, RequiredSpeed};
use super::moved::constraints;
use super::untested::{left_out, untested};
use super::words::{k_range, speed};
use crate::flutter::{BetweenSpeeds, FlutterSearch, OnsetInterval};
use crate::plausibility;

/// Motions slower than this, as `K`, are no test of a moving deck: what acts on them are the forces of steady flow.
const STEADY_K: f64 = 0.01;

/// Mean rotation away from the tests from which it is to be known, and from which derivatives are others, deg: codes ask for tests
/// at 0 and ±3°, and beyond half of that step those of the next angle would be nearer.
const ROTATION_DEG: (f64, f64) = (1.0, 1.5);

/// All of them, the gravest first.
pub(super) fn all(evidence: &Evidence, critical: &Critical) -> Vec<Doubt> {
    let mut all = Vec::new();
    let weighed = Weighed { evidence, critical };
    match evidence.flutter.first() {
        Some(first) => weighed.of_answer(first, &mut all),
        None => all.push(Doubt::new(
            Severity::Severe,
            DoubtKind::NotSearched,
            "Flutter was not searched",
        )),
    }
    weighed.of_input(&mut all);
    // stable: those of one weight stay in the order in which they were found
    all.sort_by_key(|d| std::cmp::Reverse(d.severity));
    all
}

struct Weighed<'a> {
    evidence: &'a Evidence,
    critical: &'a Critical,
}

impl Weighed<'_> {
    /// The speed that has to be judged, m/s: what is required, else the lowest critical one.
    fn asked_m_s(&self) -> Option<f64> {
        let required = self.evidence.required.map(|r| r.speed_m_s);
        required.or(self.critical.least_m_s())
    }

    /// Whether a speed is known to lie above what is required.
    fn clears(&self, speed_m_s: f64) -> bool {
        self.evidence
            .required
            .is_some_and(|r| speed_m_s >= r.speed_m_s)
    }

    /// As far as every mode was tested nothing grows: that may be all that is asked for.
    fn unless_cleared(&self) -> Severity {
        Severity::severe_if(!self.clears(self.critical.judged_to_m_s))
    }

    fn of_answer(&self, first: &FlutterReading, all: &mut Vec<Doubt>) {
        all.extend(self.tests(first));
        all.extend(self.judged(first));
        all.extend(self.interval(first));
        all.extend(self.growth());
        all.extend(self.moved(first));
        let others = &self.evidence.flutter[1..];
        all.extend(
            others
                .iter()
                .filter(|o| contradict(first, o))
                .map(|o| contradiction(first, o)),
        );
        if first.basis == ForceBasis::Stated {
            let text = format!(
                "The forces are those of {}, which no test of this deck confirms",
                first.forces
            );
            all.push(
                Doubt::new(Severity::Severe, DoubtKind::Untested, text)
                    .settled_by("measured derivatives of this deck"),
            );
        }
        let parts = self.evidence.untested.as_ref();
        all.extend(parts.map(|parts| untested(parts, first, |v| self.clears(v))));
        let modes = self.evidence.modes_left_out.as_ref();
        all.extend(modes.map(|modes| left_out(modes, first, |v| self.clears(v))));
        let warnings = match &first.search {
            FlutterSearch::Onset(onset) => &onset.warnings[..],
            FlutterSearch::UnstableAtOrBelow(start) => &start.warnings[..],
            FlutterSearch::StableUpTo(_) => &[],
        };
        all.extend(warnings.iter().map(|w| remark(w)));
    }

    /// The onset at a reduced frequency that was not tested.
    fn tests(&self, first: &FlutterReading) -> Option<Doubt> {
        let ForceBasis::Tested { range, .. } = &first.basis else {
            return None;
        };
        let at = first.search.critical().filter(|_| first.extrapolated())?;
        let (k, tested) = (at.reduced_frequency, range);
        if let Some(gap) = first.onset().and_then(|o| o.gap) {
            let kind = DoubtKind::GapInTests {
                k: k.full_width(),
                gap_from_k: gap.from.full_width(),
                gap_to_k: gap.to.full_width(),
            };
            let text = format!(
                "The onset lies at K {:.3}, {}",
                k.full_width(),
                gap.explain()
            );
            let missing = k_range(gap.from, gap.to);
            let doubt = Doubt::new(self.unless_cleared(), kind, text);
            return Some(doubt.settled_by(format!("tests at K {missing}")));
        }
        let kind = DoubtKind::OutsideTestedRange {
            k: k.full_width(),
            tested_from_k: tested.min.full_width(),
            tested_to_k: tested.max.full_width(),
        };
        // in slower wind a motion above the tests is faster still: not one test is of it at any speed up to the onset
        let never = k > tested.max || !self.clears(self.critical.judged_to_m_s);
        let severity = Severity::severe_if(never);
        let text = format!(
            "The onset lies outside the tested range, at K {:.3} (tests: {}): {} extrapolated",
            k.full_width(),
            k_range(tested.min, tested.max),
            first.are()
        );
        let missing = match k < tested.min {
            true => k_range(k, tested.min),
            false => k_range(tested.max, k),
        };
        Some(Doubt::new(severity, kind, text).settled_by(format!("tests at K {missing}")))
    }

    /// Speeds that no test reaches.
    fn judged(&self, first: &FlutterReading) -> Vec<Doubt> {
        let mut found = Vec::new();
        let (from, to) = (self.critical.judged_from_m_s, self.critical.judged_to_m_s);
        let asked = self.asked_m_s().unwrap_or(to);
        // up to growth that was found there is nothing to be judged
        let needed = first.best_m_s().map_or(asked, |best| asked.min(best));
        if needed > to * (1.0 + 1e-9) {
            found.push(self.not_judged_above(first, to, asked));
        } else if let FlutterSearch::StableUpTo(range) = &first.search
            && let Some(why) = range.not_judged.as_ref().filter(|_| asked <= to)
        {
            found.push(remark(why));
        }
        if from > 0.0 && !matches!(first.search, FlutterSearch::UnstableAtOrBelow(_)) {
            let growth = self.evidence.growth.as_ref();
            let bands = growth.map_or(&[][..], |g| &g.bands);
            found.push(not_judged_below(first, from, bands));
        }
        found
    }

    fn not_judged_above(&self, first: &FlutterReading, to: f64, asked: f64) -> Doubt {
        let kind = DoubtKind::NotJudgedAbove {
            speed_m_s: to,
            asked_m_s: asked,
        };
        let (missing, of_tests) = match &first.basis {
            ForceBasis::Tested { range, reach } => {
                let binds = reach.to_m_s <= to;
                (
                    reach.missing_up_to(asked, *range),
                    reach.why.as_ref().filter(|_| binds),
                )
            }
            ForceBasis::Exact | ForceBasis::Stated => (None, None),
        };
        let of_search = match &first.search {
            FlutterSearch::StableUpTo(range) => range.not_judged.as_ref(),
            _ => None,
        };
        let why = of_tests
            .or(of_search)
            .map_or(String::new(), |w| format!(": {w}"));
        let text = format!("Nothing is judged by data above {}{why}", speed(to));
        let settled = match missing {
            Some(range) => format!("tests at K {}", k_range(range.min, range.max)),
            None => format!("tests, and a search, that reach {}", speed(asked)),
        };
        Doubt::new(Severity::Severe, kind, text).settled_by(settled)
    }

    fn interval(&self, first: &FlutterReading) -> Vec<Doubt> {
        let mut found = Vec::new();
        let Some(onset) = first.onset().filter(|_| first.basis != ForceBasis::Exact) else {
            return found;
        };
        let others = &self.evidence.flutter[1..];
        let of_another = |o: &FlutterReading| {
            o.onset().is_some() && o.interval_is_known() && !contradict(first, o)
        };
        match &onset.interval {
            OnsetInterval::Known { .. } => {}
            OnsetInterval::Undetermined {
                low_m_s,
                high_m_s,
                reason,
                ..
            } => {
                let kind = DoubtKind::IntervalUndetermined {
                    low_m_s: *low_m_s,
                    high_m_s: *high_m_s,
                };
                let text = format!("The onset is {reason}");
                found.push(
                    Doubt::new(Severity::Severe, kind, text)
                        .settled_by("more tests near the onset, which scatter less"),
                );
            }
            _ if others.iter().any(of_another) => {}
            OnsetInterval::Spread { of: reason, .. } | OnsetInterval::None { reason } => {
                let kind = DoubtKind::IntervalUnknown {
                    reason: reason.clone(),
                };
                let text = format!("No interval of the onset: {reason}");
                // no search for what is required has to look further
                let far = RequiredSpeed::of_search(onset.at.speed_m_s);
                found.push(
                    Doubt::new(Severity::severe_if(!self.clears(far)), kind, text)
                        .settled_by("tests whose scatter is known"),
                );
            }
        }
        // with the scatter that decks show between speeds in the interval, also of other forces, it is known after all
        let readings = self.evidence.flutter.iter();
        let mut parts = readings.filter_map(|r| r.onset()?.interval.parts());
        let prior = parts.any(|p| p.between_speeds == Some(BetweenSpeeds::Prior));
        if prior || self.evidence.test_speeds == Some(1) {
            let (severity, how) = match prior {
                true => (Severity::Minor, "is taken from other decks"),
                false => (Severity::Severe, "is not known"),
            };
            let text =
                format!("Tests at one mean wind speed: how results scatter between speeds {how}");
            found.push(
                Doubt::new(severity, DoubtKind::OneTestSpeed, text)
                    .settled_by("tests at a second mean wind speed"),
            );
        }
        found
    }

    fn growth(&self) -> Option<Doubt> {
        let growth = self.evidence.growth.as_ref()?;
        let bands = growth.bands.iter();
        let fastest = bands
            .clone()
            .max_by(|a, b| a.fastest_growth_per_s.total_cmp(&b.fastest_growth_per_s))?;
        let k = fastest.reduced_frequency.full_width();
        let kind = DoubtKind::GrowthBelowOnset {
            from_m_s: bands
                .clone()
                .map(|b| b.from_m_s)
                .fold(f64::INFINITY, f64::min),
            to_m_s: bands.map(|b| b.to_m_s).fold(0.0, f64::max),
            k,
        };
        let text = format!("The model {}", growth.explain());
        let settled = match k < STEADY_K {
            true => "static coefficients, or tests at lower K".to_owned(),
            false => format!("tests at K {k:.2}, or a fit that feeds no energy there"),
        };
        Some(Doubt::new(Severity::Severe, kind, text).settled_by(settled))
    }

    fn moved(&self, first: &FlutterReading) -> Option<Doubt> {
        let moved = self.evidence.constraints?;
        // the interval may be that of other forces
        let mut readings = self.evidence.flutter.iter();
        let with_ends = readings.find(|r| r.ends_m_s().is_some());
        constraints(moved, with_ends.unwrap_or(first), |v| self.clears(v))
    }

    fn of_input(&self, all: &mut Vec<Doubt>) {
        let evidence = self.evidence;
        all.extend(evidence.failures.iter().map(|f| {
            let severity = Severity::severe_if(f.bears_on_answer);
            let kind = DoubtKind::StageFailed {
                stage: f.stage.clone(),
                reason: f.reason.clone(),
            };
            let text = format!("FAILED {}: {}", f.stage, f.reason);
            Doubt::new(severity, kind, text).settled_by(format!("{} without a failure", f.stage))
        }));
        all.extend(evidence.implausible.iter().map(|finding| {
            let severity = match finding.severity {
                plausibility::FindingSeverity::Doubt => Severity::Severe,
                plausibility::FindingSeverity::Note => Severity::Minor,
            };
            let kind = DoubtKind::ImplausibleInput {
                place: finding.place.clone(),
                value: finding.value,
            };
            Doubt::new(severity, kind, finding.to_string())
                .settled_by(format!("{} confirmed or corrected", finding.place))
        }));
        all.extend(rotation(evidence));
        let contradicted = of_divergence(evidence).zip(self.asked_m_s());
        all.extend(contradicted.and_then(|(readings, asked)| readings.doubt(asked)));
        let assumed = evidence.divergence.iter().filter_map(|d| {
            let text = format!("Divergence of {}: {}", d.forces, d.assumed.as_ref()?);
            Some(Doubt::new(
                Severity::Minor,
                DoubtKind::AssumedSteadyFlow,
                text,
            ))
        });
        all.extend(assumed);
        all.extend(evidence.tested_rotation_deg.map(|tested_rotation_deg| {
            let kind = DoubtKind::Amplitude {
                tested_rotation_deg,
            };
            let text = format!(
                "Rotations beyond the {tested_rotation_deg:.2}° of the tests are not covered"
            );
            Doubt::new(Severity::Minor, kind, text)
        }));
        all.extend(evidence.remarks.iter().map(|text| remark(text)));
    }
}

fn remark(text: &str) -> Doubt {
    Doubt::new(Severity::Minor, DoubtKind::Remark, text)
}

fn rotation(evidence: &Evidence) -> Option<Doubt> {
    let mean = evidence.mean_rotation?;
    let tested_deg = mean.tested_deg.unwrap_or(0.0);
    let away = (mean.at_onset_deg - tested_deg).abs();
    let (known, others) = ROTATION_DEG;
    if away < known {
        return None;
    }
    let severity = Severity::severe_if(away > others);
    let kind = DoubtKind::MeanRotation {
        at_onset_deg: mean.at_onset_deg,
        tested_deg,
    };
    let assumed = match mean.tested_deg {
        Some(_) => "",
        None => ", assumed since no `angle_deg` of the tests is stated",
    };
    let text = format!(
        "The deck stands at {:.1}° in the mean wind of {}, the forces are those at {tested_deg:.1}°{assumed}",
        mean.at_onset_deg,
        speed(mean.speed_m_s)
    );
    let settled = format!("forces measured at {:.1}°", mean.at_onset_deg);
    Some(Doubt::new(severity, kind, text).settled_by(settled))
}
