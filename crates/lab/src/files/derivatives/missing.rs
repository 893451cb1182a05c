//! Tables without `H4*`, `A4*`: what is written in their place.

use crate::aerodynamics::derivatives::{Derivative, DerivativePoint, Missing};
use std::collections::BTreeMap;

/// Fills in `H4*`, `A4*` where the other derivatives of their row are there; a note says so.
pub(super) fn fill_in(
    points: &mut BTreeMap<Derivative, Vec<DerivativePoint>>,
    stated: Option<Missing>,
) -> Option<String> {
    use Derivative::{A1, A2, A4, H1, H2, H4};
    let by = stated.unwrap_or_default();
    let mut filled = Vec::new();
    for (missing, rate, rotation) in [(H4, H1, H2), (A4, A1, A2)] {
        let source = if by == Missing::Zero { rate } else { rotation };
        if points.contains_key(&missing) {
            continue;
        }
        let Some(from) = points.get(&source) else {
            continue;
        };
        let mut own = from.clone();
        for p in &mut own {
            p.value = match by {
                Missing::Zero => 0.0,
                Missing::QuasiSteady => p.value * p.k().full_width(),
            };
        }
        points.insert(missing, own);
        filled.push(match by {
            Missing::Zero => format!("{missing}*"),
            Missing::QuasiSteady => format!("{missing}* = K {rotation}*"),
        });
    }
    if filled.is_empty() {
        return None;
    }
    let words = filled.join(", ");
    Some(match (by, stated) {
        (Missing::Zero, None) => format!(
            "the table does not hold {words}: taken as zero, since nothing is stated (`missing` = \"zero\" or \
             \"quasi_steady\")"
        ),
        (Missing::Zero, _) => format!("the table does not hold {words}: taken as zero, as stated"),
        (Missing::QuasiSteady, _) => format!(
            "the table does not hold H4*, A4* in full: {words} taken, quasi-steady, as stated"
        ),
    })
}
