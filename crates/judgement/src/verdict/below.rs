//! The doubt about slow wind, in which motions are faster than every test.

use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::{FlutterReading, ForceBasis};
use super::words::speed;
use crate::flutter::{FastMotion, GrowthBand, the_mode};

/// What to say of wind slower than `from_m_s`, where the fastest motion has a reduced frequency above the tests. There the forces
/// come close to those in still air; that they feed no motion is known only of forces that damp each of them.
/// `growth` is what a scan found, also of motions out of phase with each other.
pub(super) fn not_judged_below(
    first: &FlutterReading,
    from_m_s: f64,
    growth: &[GrowthBand],
) -> Doubt {
    let kind = DoubtKind::NotJudgedBelow {
        speed_m_s: from_m_s,
    };
    let (ForceBasis::Tested { range, .. }, Some(tested)) = (&first.basis, first.tested_from())
    else {
        let text = format!("Below {} not every motion was tested", speed(from_m_s));
        return Doubt::new(Severity::Severe, kind, text).settled_by("tests at higher K");
    };
    let k = range.max.full_width();
    let open = match growth
        .iter()
        .any(|b| b.reduced_frequency > range.max && b.from_m_s < from_m_s)
    {
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
    let severity = Severity::severe_if(open.is_some());
    let text = format!(
        "Below {} {} lies at K above {k:.2}, where nothing was tested; {what}",
        speed(from_m_s),
        the_mode(&tested.branch),
    );
    Doubt::new(severity, kind, text).settled_by(format!("tests at K above {k:.2}"))
}
