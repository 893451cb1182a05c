//! The doubt about slow wind, in which motions are faster than every test.

use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::{FlutterReading, ForceBasis};
use super::words::speed;
use crate::flutter::{FastMotion, the_mode};
use crate::units::ReducedFrequencyRange;

/// Why damping in wind slower than every test is not known; `None` where no motion gains energy there and tests tell how forces
/// go over into those of still air.
pub fn why_slow_wind_is_open(
    tested: &ReducedFrequencyRange,
    below: FastMotion,
) -> Option<&'static str> {
    let guessed = "damping there is a guess: tests have to reach K 0.8 and to lead up to the highest over a factor of 2.5";
    match below {
        FastMotion::Open => Some("a motion may gain energy there"),
        _ => (!tell_of_slow_wind(tested)).then_some(guessed),
    }
}

/// Measured in docs/verdict.md on decks cut to other tests.
fn tell_of_slow_wind(tested: &ReducedFrequencyRange) -> bool {
    let k = tested.max.full_width();
    let lower_ends = tested.lower_ends().map(|(end, _)| end.full_width());
    k >= 0.8 && k >= 2.5 * lower_ends.fold(0.0, f64::max)
}

/// What to say of wind slower than `from_m_s`, where the fastest motion has a reduced frequency above the tests. There the forces
/// come close to those in still air; that they feed no motion is known only of forces that damp each of them. What is judged
/// ends at `to_m_s`: a motion that is never among the tests is faster than they are up to there.
pub(super) fn not_judged_below(first: &FlutterReading, from_m_s: f64, to_m_s: f64) -> Doubt {
    let kind = DoubtKind::NotJudgedBelow {
        speed_m_s: from_m_s,
    };
    let (ForceBasis::Tested { range, .. }, Some(tested)) = (&first.basis, first.tested_from())
    else {
        let text = format!("Below {} not every motion was tested", speed(from_m_s));
        return Doubt::new(Severity::Severe, kind, text).settled_by("tests at higher K");
    };
    let k = range.max.full_width();
    let open = why_slow_wind_is_open(range, tested.below);
    let lose = "heave with rotation, and sway by itself where it moves, lose energy at";
    let what = match (open, tested.below) {
        (Some(open), _) => format!("by {} {open}", first.forces),
        (None, FastMotion::DampedAtTheEnd) => {
            format!("by {} {lose} the highest K tested", first.forces)
        }
        (None, _) => format!("by fitted forces {lose} all higher K"),
    };
    let severity = Severity::severe_if(open.is_some());
    let slow = match from_m_s < to_m_s {
        true => format!("Below {}", speed(from_m_s)),
        false => format!("Up to {}, the highest speed judged,", speed(to_m_s)),
    };
    let text = format!(
        "{slow} {} lies at K above {k:.2}, where nothing was tested; {what}",
        the_mode(&tested.branch),
    );
    Doubt::new(severity, kind, text).settled_by(format!("tests at K above {k:.2}"))
}
