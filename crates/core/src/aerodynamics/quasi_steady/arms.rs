//! Reference points of the corrected quasi-steady theory.

use crate::error::{Result, ensure, finite};
use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// No reference point is farther from a deck than this, in widths.
const LARGEST: f64 = 100.0;

/// `B₁ᵢ/B` of each force component: the reference point stands this part of the width upwind of the axis (downwind when
/// negative). All zero: quasi-steady theory without correction.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Arms {
    /// `B₁x/B`, of the drag.
    pub lateral: f64,
    /// `B₁y/B`, of the lift.
    pub vertical: f64,
    /// `B₁θ/B`, of the moment.
    pub torsion: f64,
}

impl Arms {
    /// The arm of one force component.
    pub fn arm(&self, dof: Dof) -> f64 {
        match dof {
            Dof::Vertical => self.vertical,
            Dof::Lateral => self.lateral,
            Dof::Torsion => self.torsion,
        }
    }

    /// Checks that all are parts of a width; `place` goes before their keys.
    pub fn validate(&self, place: &str) -> Result<()> {
        for dof in Dof::THREE {
            let (key, arm) = (format!("{place}arms.{}", dof.name()), self.arm(dof));
            ensure(
                finite(key.as_str(), arm)?.abs() <= LARGEST,
                key,
                format_args!("a part of the width, {LARGEST} at most"),
                format_args!("{arm:e}"),
            )?;
        }
        Ok(())
    }
}
