//! Tables without `H4*`, `A4*`: what stands in their place.

use super::{Derivative, DerivativePoint};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What is taken for `H4*`, `A4*` when a table does not hold them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Missing {
    /// Zero: no force in phase with heave.
    #[default]
    Zero,
    /// `H4* = K H2*`, `A4* = K A2*`: heaving acts through the angle of attack `−ẏ/V` as rotation does (R. H. Scanlan,
    /// N. P. Jones, L. Singh, J. Wind Eng. Ind. Aerodyn. 69–71, 1997, 829), here without added mass.
    QuasiSteady,
}

impl Missing {
    /// The word for it in studies and commands.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::QuasiSteady => "quasi_steady",
        }
    }
}

read_by_name!(
    Missing,
    "missing",
    |text: &str| [Self::Zero, Self::QuasiSteady]
        .into_iter()
        .find(|m| m.name() == text),
    "zero or quasi_steady"
);

/// Fills in `H4*`, `A4*` where the other derivatives of their row are there; a note says so.
pub fn fill_in(
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
        let value = |p: &DerivativePoint| match by {
            Missing::Zero => 0.0,
            Missing::QuasiSteady => p.value * p.k().full_width(),
        };
        let own = from.iter().map(|p| DerivativePoint {
            value: value(p),
            ..*p
        });
        let own: Vec<_> = own.collect();
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
        (Missing::QuasiSteady, _) => {
            format!(
                "the table does not hold H4*, A4* in full: {words} taken, quasi-steady, as stated"
            )
        }
    })
}
