//! Single doubts that take more than a line: slow wind, readings that exclude each other, constraints, what a bridge is not whole of.

use super::critical_speed::Phenomenon;
use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::{
    Divergence, Evidence, FlutterReading, ForceBasis, ModesLeftOut, UntestedPart, UntestedParts,
};
use super::words::{speed, speed_or_none};
use crate::error::counted;
use crate::flutter::{CriticalPoint, FastMotion, GrowthBand, MovedOnset, the_mode};

/// Divergence by one reading of the tests over that by another from which on they contradict each other: between the fitted models and
/// the tables of the embedded decks it is 1.05 at most.
const APART: f64 = 1.25;

/// What constraints, other forces or modes may move an onset by before it counts, relative to the onset without them.
const MOVES_AT_MOST: f64 = 0.01;

/// Least onset of a fit without constraints that is believed, relative to the one with them.
const BELIEVABLE: f64 = 0.5;

/// How near to the end of a search an onset says nothing of one that constraints have moved, relative to the end.
const NEAR_THE_END: f64 = 0.05;

/// Share of a bridge in the wind from which on forces without a test bear on its onset wherever they act: at mid-span 4 % of
/// Langenuen move it by 2.2 m/s, more than half a 95 % interval, at its ends by 0.1.
const BEARS: f64 = 0.05;

/// What to say of wind slower than `from_m_s`, where the fastest motion has a reduced frequency above the tests. There the forces
/// come close to those in still air; that they feed no motion is known only of forces that damp each of them.
/// `growth` is what a scan found, also of motions out of phase with each other.
pub(super) fn not_judged_below(
    first: &FlutterReading,
    from_m_s: f64,
    growth: &[GrowthBand],
) -> Doubt {
    let speed_m_s = from_m_s;
    let kind = DoubtKind::NotJudgedBelow { speed_m_s };
    let (ForceBasis::Tested { range, .. }, Some(tested)) = (&first.basis, first.tested_from())
    else {
        let text = format!("Below {} not every motion was tested", speed(from_m_s));
        return Doubt::new(Severity::Severe, kind, text).settled_by("tests at higher K");
    };
    let k = range.max.full_width();
    let grows = |b: &GrowthBand| b.reduced_frequency > range.max && b.from_m_s < from_m_s;
    let open = match growth.iter().any(grows) {
        true => Some("a motion grows there"),
        false => tested.below.why_open(),
    };
    let lose = "heave with rotation, and sway by itself where it moves, lose energy at";
    let what = match (open, tested.below) {
        (Some(open), _) => format!("by {} {open}", first.forces),
        (None, FastMotion::DampedAtTheEnd) => {
            format!("by {} {lose} the highest K tested", first.forces)
        }
        (None, _) => format!("by fitted forces {lose} all higher K"),
    };
    let text = format!(
        "Below {} {} lies at K above {k:.2}, where nothing was tested; {what}",
        speed(from_m_s),
        the_mode(&tested.branch),
    );
    Doubt::new(Severity::severe_if(open.is_some()), kind, text)
        .settled_by(format!("tests at K above {k:.2}"))
}

pub(super) fn contradiction(first: &FlutterReading, second: &FlutterReading) -> Doubt {
    let kind = DoubtKind::Contradiction {
        phenomenon: Phenomenon::Flutter,
        first: first.forces.clone(),
        first_m_s: first.best_m_s(),
        second: second.forces.clone(),
        second_m_s: second.best_m_s(),
    };
    let text = format!(
        "Contradiction: {} by {}, {} by {}",
        first.found(),
        first.forces,
        second.found(),
        second.forces
    );
    let doubt = Doubt::new(Severity::Severe, kind, text);
    let at = [first, second].map(|r| r.search.critical());
    let k = |at: &CriticalPoint| format!("{:.2}", at.reduced_frequency.full_width());
    let ks: Vec<String> = at.into_iter().flatten().map(k).collect();
    if ks.is_empty() {
        return doubt;
    }
    let near = ks.join(" and ");
    doubt.settled_by(format!("tests near K {near}, where the two differ"))
}

/// Static divergence that another reading has much later or not at all: forces of steady flow, which no test of a moving deck has, are
/// then what the form of a model makes of them. Coefficients that were measured at rest are believed. First comes the reading that makes
/// it up, then the one that has it much later, or measured it.
pub(super) fn doubted_divergence(evidence: &Evidence) -> Option<[&Divergence; 2]> {
    let at = |d: &Divergence| d.speed_m_s.unwrap_or(f64::INFINITY);
    let readings = || evidence.divergence.iter();
    let first = readings().min_by(|a, b| at(a).total_cmp(&at(b)))?;
    let least = |d: &Divergence| d.lower_m_s.unwrap_or(at(d)).min(at(d));
    let second = readings().find(|d| least(d) > APART * at(first))?;
    Some(match first.measured {
        true => [second, first],
        false => [first, second],
    })
}

/// The doubt of such readings, where a speed is asked for above the lower of the two.
pub(super) fn of_divergence(readings: [&Divergence; 2], asked_m_s: f64) -> Option<Doubt> {
    let [doubted, other] = readings;
    let speeds = readings.into_iter().filter_map(|d| d.speed_m_s);
    speeds
        .reduce(f64::min)
        .filter(|least| *least <= asked_m_s)?;
    let kind = DoubtKind::Contradiction {
        phenomenon: Phenomenon::Divergence,
        first: doubted.forces.clone(),
        first_m_s: doubted.speed_m_s,
        second: other.forces.clone(),
        second_m_s: other.speed_m_s,
    };
    let text = format!(
        "Contradiction: static divergence at {} by {}, {} by {}",
        speed_or_none(doubted.speed_m_s),
        doubted.forces,
        speed_or_none(other.speed_m_s),
        other.forces
    );
    let doubt = Doubt::new(Severity::Severe, kind, text);
    Some(doubt.settled_by("static coefficients, or tests at lower K"))
}

/// What to say where the data alone give another onset than the fit under its constraints.
pub(super) fn constraints(
    moved: MovedOnset,
    first: &FlutterReading,
    evidence: &Evidence,
) -> Option<Doubt> {
    let kind = DoubtKind::ConstraintsMovedOnset {
        without_m_s: moved.without_m_s,
        with_m_s: moved.with_m_s,
    };
    let doubt = |severity, text: String| {
        let doubt = Doubt::new(severity, kind, text);
        Some(doubt.settled_by("tests that determine the onset without constraints"))
    };
    let (without, with) = match (moved.without_m_s, moved.with_m_s) {
        (without, Some(with)) => (without, with),
        (None, None) => return None,
        (Some(without), None) => {
            let gone = format!(
                "Constraints removed the onset: by the data alone {}",
                speed(without)
            );
            // where the search ends stands for an onset that lies above
            let (_, searched_to) = first.judged_m_s();
            if (without / searched_to - 1.0).abs() < NEAR_THE_END {
                // with them it may lie just beyond
                let severity =
                    Severity::severe_if(!evidence.clears((1.0 - NEAR_THE_END) * without));
                let text = format!(
                    "By the data alone, without constraints, the onset is {}, near {}, where the search ends",
                    speed(without),
                    speed(searched_to)
                );
                return doubt(severity, text);
            }
            let severity = Severity::severe_if(without >= BELIEVABLE * searched_to);
            return doubt(severity, gone);
        }
    };
    let (low, high) = first.ends_m_s().unwrap_or((with, with));
    let severity = match without {
        // a fit that grows from nearly no wind, or nowhere, has no onset that could have been moved
        Some(without) if without >= BELIEVABLE * with => {
            if !has_moved(without, with, high - low) {
                return None;
            }
            let inside = low <= without && without <= high;
            // the data alone, with the same interval, may clear what is required as well
            Severity::severe_if(!(inside || evidence.clears(without - (with - low))))
        }
        _ => Severity::Minor,
    };
    let text = match without {
        Some(without) if without >= BELIEVABLE * with => format!(
            "Constraints moved the onset: by the data alone {}, with them {}",
            speed(without),
            speed(with)
        ),
        _ => format!(
            "Constraints decide: by the data alone the model {}, with them the onset is {}",
            without.map_or(
                "has no onset, or grows from the lowest speed on".to_owned(),
                |v| format!("grows from {}", speed(v))
            ),
            speed(with)
        ),
    };
    doubt(severity, text)
}

/// Whether an onset that moved did so by more than counts, where its 95 % interval, which is four standard errors, is so wide.
fn has_moved(from_m_s: f64, to_m_s: f64, interval_m_s: f64) -> bool {
    (to_m_s - from_m_s).abs() > (MOVES_AT_MOST * from_m_s).max(0.25 * interval_m_s)
}

/// The doubt that parts of a bridge leave in whose forces no test stands behind.
pub(super) fn untested(
    parts: &UntestedParts,
    first: &FlutterReading,
    evidence: &Evidence,
) -> Doubt {
    let own = parts.as_it_is_m_s;
    let bears = |other: Option<f64>| bears(own, other, first, evidence);
    let share: f64 = parts.parts.iter().map(|p| p.share).sum();
    let grave = share >= BEARS || bears(parts.as_tested_m_s) || bears(parts.in_still_air_m_s);
    let part = |p: &UntestedPart| {
        format!(
            "{} ({:.0} % of what the wind does to the modes) are {}",
            p.part,
            100.0 * p.share,
            p.forces
        )
    };
    let named: Vec<String> = parts.parts.iter().map(part).collect();
    let text = format!(
        "The forces of {}, which no test of this deck confirms; the onset by the models is {}, with the forces of section {} there \
         {}, with none {}",
        named.join(", those of "),
        at(parts.as_it_is_m_s),
        parts.tested,
        at(parts.as_tested_m_s),
        at(parts.in_still_air_m_s)
    );
    let names: Vec<&str> = parts.parts.iter().map(|p| p.part.as_str()).collect();
    Doubt::new(Severity::severe_if(grave), DoubtKind::Untested, text)
        .settled_by(format!("measured derivatives of {}", names.join(", ")))
}

/// The doubt that modes leave which are left out.
pub(super) fn left_out(modes: &ModesLeftOut, first: &FlutterReading, evidence: &Evidence) -> Doubt {
    let grave = bears(modes.as_it_is_m_s, modes.with_all_m_s, first, evidence);
    let text = format!(
        "{} of the file are left out; the onset by the models is {}, with all of them {}",
        counted(modes.modes.len(), "mode"),
        at(modes.as_it_is_m_s),
        at(modes.with_all_m_s)
    );
    Doubt::new(Severity::severe_if(grave), DoubtKind::ModesLeftOut, text)
        .settled_by("all modes of the file")
}

fn at(speed_m_s: Option<f64>) -> String {
    speed_m_s.map_or("nowhere".to_owned(), |v| format!("at {}", speed(v)))
}

/// Whether another onset than that of the model, by other forces or modes, is so far away that the answer could be another.
fn bears(
    own: Option<f64>,
    other: Option<f64>,
    first: &FlutterReading,
    evidence: &Evidence,
) -> bool {
    match (own, other) {
        (None, None) => false,
        (None, Some(other)) => !evidence.clears(other),
        (Some(_), None) => true,
        (Some(own), Some(other)) => {
            let (low, high) = first.ends_m_s().unwrap_or((own, own));
            has_moved(own, other, high - low) && !evidence.clears(low - (other - own).abs())
        }
    }
}
