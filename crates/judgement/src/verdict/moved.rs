//! The doubt about an onset that constraints of a fit have moved.

use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::FlutterReading;
use super::words::speed;
use crate::flutter::MovedOnset;

/// What constraints may move an onset by before it is told, relative to the onset without them.
const MOVES_AT_MOST: f64 = 0.01;

/// Least onset of a fit without constraints that is believed, relative to the one with them.
const BELIEVABLE: f64 = 0.5;

/// How near to the end of a search an onset says nothing of one that constraints have moved, relative to the end.
const NEAR_THE_END: f64 = 0.05;

/// What to say where the data alone give another onset than the fit under its constraints; `clears` tells whether a speed is known to
/// lie above what is required.
pub(super) fn constraints(
    moved: MovedOnset,
    first: &FlutterReading,
    clears: impl Fn(f64) -> bool,
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
                let severity = Severity::severe_if(!clears((1.0 - NEAR_THE_END) * without));
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
            // a 95 % interval is four standard errors wide
            let allowed = (MOVES_AT_MOST * without).max(0.25 * (high - low));
            if (with - without).abs() <= allowed {
                return None;
            }
            let inside = low <= without && without <= high;
            // the data alone, with the same interval, may clear what is required as well
            Severity::severe_if(!(inside || clears(without - (with - low))))
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
