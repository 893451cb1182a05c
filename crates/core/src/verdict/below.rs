//! The doubt about slow wind, in which motions are faster than every test.

use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::{FlutterReading, ForceBasis};
use super::words::speed;
use crate::flutter::{FastMotion, the_mode};
use crate::units::ReducedFrequencyRange;

/// Why damping in slow wind is not known from tests that do not tell of it.
pub const GUESSED: &str = "damping there is a guess: tests have to reach K 0.8 and to lead up to the highest over a factor of 2.5";

/// Whether tests tell how forces go over into those of still air: measured in docs/verdict.md on decks cut to other tests.
pub fn tell_of_slow_wind(tested: &ReducedFrequencyRange) -> bool {
    let k = tested.max.full_width();
    let lower_ends = tested.lower_ends().map(|(end, _)| end.full_width());
    k >= 0.8 && k >= 2.5 * lower_ends.fold(0.0, f64::max)
}

/// What to say of wind slower than `from_m_s`, where the fastest motion has a reduced frequency above the tests. There the forces
/// come close to those in still air; that they feed no motion is known only of forces that damp each of them.
pub(super) fn not_judged_below(first: &FlutterReading, from_m_s: f64) -> Doubt {
    let kind = DoubtKind::NotJudgedBelow {
        speed_m_s: from_m_s,
    };
    let (ForceBasis::Tested { range, .. }, Some(tested)) = (&first.basis, first.tested_from())
    else {
        let text = format!("Below {} not every motion was tested", speed(from_m_s));
        return Doubt::new(Severity::Severe, kind, text).settled_by("tests at higher K");
    };
    let k = range.max.full_width();
    let tells = tell_of_slow_wind(range);
    let what = match tested.below {
        FastMotion::Open => "a motion may gain energy there",
        _ if !tells => GUESSED,
        FastMotion::Damped => "every motion loses energy at all higher K",
        FastMotion::DampedAtTheEnd => "every motion loses energy at the highest K tested",
    };
    let severity = Severity::severe_if(!tells || tested.below == FastMotion::Open);
    let text = format!(
        "Below {} {} lies at K above {k:.2}, where nothing was tested; by {} {what}",
        speed(from_m_s),
        the_mode(&tested.branch),
        first.forces
    );
    Doubt::new(severity, kind, text).settled_by(format!("tests at K above {k:.2}"))
}
