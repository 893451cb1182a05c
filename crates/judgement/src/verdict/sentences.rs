//! The sentences of a verdict.

use super::Verdict;
use super::critical::{Critical, contradict};
use super::critical_speed::{CriticalSpeed, Phenomenon};
use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::{Evidence, FlutterReading};
use super::outcome::{Below, Outcome};
use super::reasons::doubted_divergence;
use super::words::{speed, speed_or_none};
use crate::flutter::FlutterSearch;

/// The answer in one line; begins with the outcome where a speed is required.
pub(super) fn headline(verdict: &Verdict, evidence: &Evidence) -> String {
    let what = what(&verdict.critical, evidence);
    match (&verdict.outcome, evidence.required) {
        (Some(outcome), Some(required)) => format!(
            "{} {}, required {} m/s: {what}",
            outcome.sign(),
            outcome.words(),
            required.speed_m_s
        ),
        _ => what,
    }
}

/// What governs, then what the search for flutter found; and what is expected before flutter although its own lower end is not
/// known.
fn what(critical: &Critical, evidence: &Evidence) -> String {
    let flutter = flutter(evidence) + &judged_before(critical, evidence);
    let against = doubted_divergence(evidence);
    let says = |c: &CriticalSpeed| {
        let (name, best) = (c.phenomenon.name(), speed(c.best_m_s));
        let lower = c.lower_m_s.filter(|l| *l < c.best_m_s);
        let lower = lower.map_or_else(String::new, |l| format!(", lower end {}", speed(l)));
        let against = against.filter(|[doubted, _]| {
            doubted.forces == c.forces && c.phenomenon == Phenomenon::Divergence
        });
        let against = against.map_or_else(String::new, |[_, other]| {
            let at = speed_or_none(other.speed_m_s);
            format!(", CONTRADICTED by {}: {at}", other.forces)
        });
        format!("{name} at {best}{lower} ({}){against}", c.forces)
    };
    match &critical.governs {
        Some(c) if c.phenomenon != Phenomenon::Flutter => {
            // beyond the search there may be flutter before it
            match evidence.searched_to_m_s.is_some_and(|to| c.best_m_s > to) {
                true => format!("{flutter}; {}", says(c)),
                false => format!("{}; {flutter}", says(c)),
            }
        }
        Some(c) => {
            let mut others = critical.others.iter();
            let before = others
                .find(|o| o.phenomenon != Phenomenon::Flutter && o.best_m_s < c.best_m_s)
                .map(|o| format!("; {} comes before it", says(o)));
            flutter + &before.unwrap_or_default()
        }
        None => flutter,
    }
}

/// What the first reading found, with the interval of another that agrees where it has none, and what contradicts it.
fn flutter(evidence: &Evidence) -> String {
    let Some((first, others)) = evidence.flutter.split_first() else {
        return "flutter not searched".to_owned();
    };
    let support = others.iter().find(|o| {
        !first.interval_is_known()
            && o.onset().is_some()
            && o.interval_is_known()
            && !contradict(first, o)
    });
    let mut text = match (&first.search, support) {
        (FlutterSearch::Onset(onset), Some(other)) => format!(
            "flutter onset {} by {}{}; {}: {}",
            speed(onset.at.speed_m_s),
            first.forces,
            match onset.in_tested_range {
                Some(true) => ", inside the tested range",
                Some(false) => ", OUTSIDE the tested range",
                None => "",
            },
            other.forces,
            other.found()
        ),
        (FlutterSearch::Onset(onset), None) => onset.headline(),
        (other, _) => other.explain(),
    };
    for other in others.iter().filter(|o| contradict(first, o)) {
        let found = other.found();
        text.push_str(&format!("; CONTRADICTED by {}: {found}", other.forces));
    }
    text
}

/// How far all motions can be judged, where that ends before an onset that lies among the tests itself.
fn judged_before(critical: &Critical, evidence: &Evidence) -> String {
    let onset = evidence.flutter.first().and_then(FlutterReading::onset);
    let tested = onset.filter(|onset| onset.in_tested_range == Some(true));
    let to = critical.judged_to_m_s;
    match tested.is_some_and(|onset| onset.at.speed_m_s > to * (1.0 + 1e-9)) {
        true => format!("; all motions judged up to {} only", speed(to)),
        false => String::new(),
    }
}

/// Why the outcome is what it is.
pub(super) fn explanation(verdict: &Verdict) -> String {
    match (&verdict.outcome, verdict.against) {
        (Some(Outcome::Met), Some(required)) => met(verdict, required.speed_m_s),
        (Some(Outcome::NotMet { below }), Some(required)) => {
            not_met(&verdict.critical, *below, required.speed_m_s)
        }
        (
            Some(Outcome::CannotBeJudged {
                missing,
                settled_by,
            }),
            Some(_),
        ) => {
            let text = format!("Cannot be judged: {}.", missing.join("; "));
            if settled_by.is_empty() {
                return text;
            }
            format!("{text} It would be settled by {}.", settled_by.join("; "))
        }
        _ => no_requirement(verdict),
    }
}

fn one(c: &CriticalSpeed) -> String {
    let lower = match c.lower_m_s {
        Some(low) if low <= 0.0 => " or at any speed below".to_owned(),
        Some(low) if low < c.best_m_s => format!(", lower end {}", speed(low)),
        _ => String::new(),
    };
    format!(
        "{} at {} by {}{lower}",
        c.phenomenon.name(),
        speed(c.best_m_s),
        c.forces
    )
}

fn met(verdict: &Verdict, required_m_s: f64) -> String {
    let critical = &verdict.critical;
    let all: Vec<String> = critical.all().map(one).collect();
    let mut text = match all.is_empty() {
        true => format!(
            "Met: nothing critical up to {}.",
            speed(critical.judged_to_m_s)
        ),
        false => format!("Met: everything critical lies above: {}.", all.join("; ")),
    };
    // not one test is at so slow a wind
    let below = |d: &&Doubt| matches!(d.kind, DoubtKind::NotJudgedBelow { speed_m_s } if required_m_s < speed_m_s);
    if let Some(doubt) = verdict.doubts.iter().find(below) {
        text.push_str(&format!(" {}.", doubt.text));
    }
    text
}

fn not_met(critical: &Critical, below: Below, required_m_s: f64) -> String {
    let speed = |c: &CriticalSpeed| match below {
        Below::BestEstimate => c.best_m_s,
        Below::LowerEnd => c.least_m_s(),
    };
    let which = |c: &&CriticalSpeed| c.phenomenon != Phenomenon::Growth && speed(c) < required_m_s;
    let Some(c) = critical.all().find(which) else {
        return "Not met.".to_owned();
    };
    match below {
        Below::BestEstimate => format!(
            "Not met: the best estimate lies below {required_m_s} m/s: {}.",
            one(c)
        ),
        Below::LowerEnd if c.lower_m_s.is_some_and(|low| low <= 0.0) => format!(
            "Not met: where it begins is not known, at {required_m_s} m/s or elsewhere: {}.",
            one(c)
        ),
        Below::LowerEnd => format!(
            "Not met: the best estimate lies above {required_m_s} m/s, but only the lower end counts: {}.",
            one(c)
        ),
    }
}

fn no_requirement(verdict: &Verdict) -> String {
    let how = "state required_speed_m_s, the criterion of a code";
    match verdict.suggested_m_s {
        Some(most) => {
            // a search that found nothing and went farther would show more
            let nothing_found = verdict.critical.governs.is_none();
            let at_least = if nothing_found { "at least " } else { "" };
            format!(
                "No required speed is stated, so that nothing is judged; {how}: {at_least}up to {most} m/s it would be met."
            )
        }
        None => {
            let doubts = verdict.doubts.iter();
            let severe = doubts.filter(|d| d.severity == Severity::Severe);
            let why: Vec<&str> = severe.map(|d| d.text.as_str()).collect();
            let governs = verdict.critical.governs.as_ref();
            let why = match governs.filter(|c| c.lower_m_s.is_some_and(|low| low <= 0.0)) {
                Some(first) => one(first),
                None if why.is_empty() => "nothing was judged by data".to_owned(),
                None => why.join("; "),
            };
            format!("No required speed is stated ({how}), and none could be met: {why}.")
        }
    }
}
