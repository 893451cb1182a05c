//! The doubts that evidence leaves, and how much each weighs against what is required.

use super::critical::{Critical, contradict};
use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::{Evidence, FlutterReading, ForceBasis, RequiredSpeed, StageFailure};
use super::reasons::{
    constraints, contradiction, doubted_divergence, left_out, not_judged_below, of_divergence,
    untested,
};
use super::words::{k_range, speed};
use crate::flutter::{BetweenSpeeds, FlutterSearch, OnsetInterval};
use crate::plausibility::FindingSeverity;

/// Motions slower than this, as `K`, are no test of a moving deck: what acts on them are the forces of steady flow.
const STEADY_K: f64 = 0.01;

/// Mean rotation away from the tests from which it is to be known, and from which derivatives are others, deg: codes ask for tests
/// at 0 and ±3°, and beyond half of that step those of the next angle would be nearer.
const ROTATION_DEG: (f64, f64) = (1.0, 1.5);

/// All of them, the gravest first.
pub(super) fn all(evidence: &Evidence, critical: &Critical) -> Vec<Doubt> {
    let mut all = match evidence.flutter.first() {
        Some(first) => evidence.of_answer(critical, first),
        None => {
            let kind = DoubtKind::NotSearched;
            vec![Doubt::new(
                Severity::Severe,
                kind,
                "Flutter was not searched",
            )]
        }
    };
    all.extend(evidence.of_input(critical));
    // stable: those of one weight stay in the order in which they were found
    all.sort_by_key(|d| std::cmp::Reverse(d.severity));
    all
}

impl Evidence {
    /// The speed that has to be judged, m/s: what is required, else the lowest critical one.
    fn asked_m_s(&self, critical: &Critical) -> Option<f64> {
        let required = self.required.map(|r| r.speed_m_s);
        required.or(critical.least_m_s())
    }

    /// Whether a speed is known to lie above what is required.
    pub(super) fn clears(&self, speed_m_s: f64) -> bool {
        self.required.is_some_and(|r| speed_m_s >= r.speed_m_s)
    }

    fn of_answer(&self, critical: &Critical, first: &FlutterReading) -> Vec<Doubt> {
        let mut all: Vec<Doubt> = self.tests(critical, first).into_iter().collect();
        all.extend(self.judged(critical, first));
        all.extend(self.interval(first));
        all.extend(self.growth_below());
        all.extend(self.moved(first));
        let against = self.flutter[1..].iter().filter(|o| contradict(first, o));
        all.extend(against.map(|o| contradiction(first, o)));
        if first.basis == ForceBasis::Stated {
            let text = format!(
                "The forces are those of {}, which no test of this deck confirms",
                first.forces
            );
            let doubt = Doubt::new(Severity::Severe, DoubtKind::Untested, text);
            all.push(doubt.settled_by("measured derivatives of this deck"));
        }
        let parts = self.untested.as_ref();
        all.extend(parts.map(|parts| untested(parts, first, self)));
        let modes = self.modes_left_out.as_ref();
        all.extend(modes.map(|modes| left_out(modes, first, self)));
        let warnings = match &first.search {
            FlutterSearch::Onset(onset) => &onset.warnings[..],
            FlutterSearch::UnstableAtOrBelow(start) => &start.warnings[..],
            FlutterSearch::StableUpTo(_) => &[],
        };
        all.extend(warnings.iter().map(|w| remark(w)));
        all
    }

    /// The onset at a reduced frequency that was not tested.
    fn tests(&self, critical: &Critical, first: &FlutterReading) -> Option<Doubt> {
        let ForceBasis::Tested { range: tested, .. } = &first.basis else {
            return None;
        };
        let at = first.search.critical().filter(|_| first.extrapolated())?;
        let k = at.reduced_frequency;
        // as far as every mode was tested nothing grows: that may be all that is asked for
        let cleared = self.clears(critical.judged_to_m_s);
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
            let doubt = Doubt::new(Severity::severe_if(!cleared), kind, text);
            return Some(doubt.settled_by(format!("tests at K {missing}")));
        }
        let kind = DoubtKind::OutsideTestedRange {
            k: k.full_width(),
            tested_from_k: tested.min.full_width(),
            tested_to_k: tested.max.full_width(),
        };
        // in slower wind a motion above the tests is faster still: not one test is of it at any speed up to the onset
        let severity = Severity::severe_if(k > tested.max || !cleared);
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
    fn judged(&self, critical: &Critical, first: &FlutterReading) -> Vec<Doubt> {
        let mut found = Vec::new();
        let (from, to) = (critical.judged_from_m_s, critical.judged_to_m_s);
        let asked = self.asked_m_s(critical).unwrap_or(to);
        // up to growth that was found there is nothing to be judged
        let needed = first.best_m_s().map_or(asked, |best| asked.min(best));
        if needed > to * (1.0 + 1e-9) {
            found.push(not_judged_above(first, to, asked));
        } else if let FlutterSearch::StableUpTo(range) = &first.search
            && let Some(why) = range.not_judged.as_ref().filter(|_| asked <= to)
        {
            found.push(remark(why));
        }
        if from > 0.0 && !matches!(first.search, FlutterSearch::UnstableAtOrBelow(_)) {
            let bands = self.growth.as_ref().map_or(&[][..], |g| &g.bands);
            found.push(not_judged_below(first, from, bands));
        }
        found
    }

    fn interval(&self, first: &FlutterReading) -> Vec<Doubt> {
        let mut found = Vec::new();
        let Some(onset) = first.onset().filter(|_| first.basis != ForceBasis::Exact) else {
            return found;
        };
        let others = &self.flutter[1..];
        let of_another = |o: &FlutterReading| {
            o.onset().is_some() && o.interval_is_known() && !contradict(first, o)
        };
        match &onset.interval {
            OnsetInterval::Known(_) => {}
            OnsetInterval::Undetermined { error, reason } => {
                let (low_m_s, high_m_s) = (error.low_m_s, error.high_m_s);
                let kind = DoubtKind::IntervalUndetermined { low_m_s, high_m_s };
                let doubt = Doubt::new(Severity::Severe, kind, format!("The onset is {reason}"));
                found.push(doubt.settled_by("more tests near the onset, which scatter less"));
            }
            _ if others.iter().any(of_another) => {}
            OnsetInterval::Spread { of: reason, .. } | OnsetInterval::None { reason } => {
                let text = format!("No interval of the onset: {reason}");
                let reason = reason.clone();
                let kind = DoubtKind::IntervalUnknown { reason };
                // no search for what is required has to look further
                let far = RequiredSpeed::of_search(onset.at.speed_m_s);
                let doubt = Doubt::new(Severity::severe_if(!self.clears(far)), kind, text);
                found.push(doubt.settled_by("tests whose scatter is known"));
            }
        }
        // with the scatter that decks show between speeds in the interval, also of other forces, it is known after all
        let readings = self.flutter.iter();
        let mut errors = readings.filter_map(|r| r.onset()?.interval.by_error());
        let prior = errors.any(|e| e.parts.between_speeds == Some(BetweenSpeeds::Prior));
        if prior || self.test_speeds == Some(1) {
            let how = match prior {
                true => "is taken from other decks",
                false => "is not known",
            };
            let text =
                format!("Tests at one mean wind speed: how results scatter between speeds {how}");
            let doubt = Doubt::new(Severity::severe_if(!prior), DoubtKind::OneTestSpeed, text);
            found.push(doubt.settled_by("tests at a second mean wind speed"));
        }
        found
    }

    fn growth_below(&self) -> Option<Doubt> {
        let growth = self.growth.as_ref()?;
        let bands = || growth.bands.iter();
        let fastest =
            bands().max_by(|a, b| a.fastest_growth_per_s.total_cmp(&b.fastest_growth_per_s))?;
        let k = fastest.reduced_frequency.full_width();
        let from = bands().map(|b| b.from_m_s);
        let kind = DoubtKind::GrowthBelowOnset {
            from_m_s: from.fold(f64::INFINITY, f64::min),
            to_m_s: bands().map(|b| b.to_m_s).fold(0.0, f64::max),
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
        let moved = self.constraints?;
        // the interval may be that of other forces
        let with_ends = self.flutter.iter().find(|r| r.ends_m_s().is_some());
        constraints(moved, with_ends.unwrap_or(first), self)
    }

    fn of_input(&self, critical: &Critical) -> Vec<Doubt> {
        let of_failure = |f: &StageFailure| {
            let severity = Severity::severe_if(!f.beside_answer);
            let kind = DoubtKind::StageFailed {
                stage: f.stage.clone(),
                reason: f.reason.clone(),
            };
            let settled = format!("{} without a failure", f.stage);
            Doubt::new(severity, kind, f.explain()).settled_by(settled)
        };
        let mut all: Vec<Doubt> = self.failures.iter().map(of_failure).collect();
        all.extend(self.implausible.iter().map(|finding| {
            let severity = Severity::severe_if(finding.severity == FindingSeverity::Doubt);
            let kind = DoubtKind::ImplausibleInput {
                place: finding.place.clone(),
                value: finding.value,
            };
            Doubt::new(severity, kind, finding.to_string())
                .settled_by(format!("{} confirmed or corrected", finding.place))
        }));
        all.extend(rotation(self));
        let contradicted = doubted_divergence(self).zip(self.asked_m_s(critical));
        all.extend(contradicted.and_then(|(readings, asked)| of_divergence(readings, asked)));
        all.extend(self.divergence.iter().filter_map(|d| {
            let text = format!("Divergence of {}: {}", d.forces, d.assumed.as_ref()?);
            let kind = DoubtKind::AssumedSteadyFlow;
            Some(Doubt::new(Severity::Minor, kind, text))
        }));
        all.extend(self.tested_rotation_deg.map(|tested_rotation_deg| {
            let kind = DoubtKind::Amplitude {
                tested_rotation_deg,
            };
            let text = format!(
                "Rotations beyond the {tested_rotation_deg:.2}° of the tests are not covered"
            );
            Doubt::new(Severity::Minor, kind, text)
        }));
        all.extend(self.remarks.iter().map(|text| remark(text)));
        all
    }
}

fn not_judged_above(first: &FlutterReading, to: f64, asked: f64) -> Doubt {
    let kind = DoubtKind::NotJudgedAbove {
        speed_m_s: to,
        asked_m_s: asked,
    };
    let (missing, of_tests) = match &first.basis {
        ForceBasis::Tested { range, reach } => (
            reach.missing_up_to(asked, **range),
            reach.why.as_ref().filter(|_| reach.to_m_s <= to),
        ),
        ForceBasis::Exact | ForceBasis::Stated => (None, None),
    };
    let of_search = match &first.search {
        FlutterSearch::StableUpTo(range) => range.not_judged.as_ref(),
        _ => None,
    };
    let why = of_tests.or(of_search).map(|w| format!(": {w}"));
    let why = why.unwrap_or_default();
    let text = format!("Nothing is judged by data above {}{why}", speed(to));
    let settled = match missing {
        Some(range) => format!("tests at K {}", k_range(range.min, range.max)),
        None => format!("tests, and a search, that reach {}", speed(asked)),
    };
    Doubt::new(Severity::Severe, kind, text).settled_by(settled)
}

fn remark(text: &str) -> Doubt {
    Doubt::new(Severity::Minor, DoubtKind::Remark, text)
}

fn rotation(evidence: &Evidence) -> Option<Doubt> {
    let mean = evidence.mean_rotation?;
    let tested_deg = mean.tested_deg.unwrap_or(0.0);
    let away = (mean.rotation_deg - tested_deg).abs();
    let (known, others) = ROTATION_DEG;
    if away < known {
        return None;
    }
    let kind = DoubtKind::MeanRotation {
        at_onset_deg: mean.rotation_deg,
        tested_deg,
    };
    let assumed = match mean.tested_deg {
        Some(_) => "",
        None => ", assumed since no `angle_deg` of the tests is stated",
    };
    let text = format!(
        "The deck stands at {:.1}° in the mean wind of {}, the forces are those at {tested_deg:.1}°{assumed}",
        mean.rotation_deg,
        speed(mean.speed_m_s)
    );
    let settled = format!("forces measured at {:.1}°", mean.rotation_deg);
    Some(Doubt::new(Severity::severe_if(away > others), kind, text).settled_by(settled))
}
