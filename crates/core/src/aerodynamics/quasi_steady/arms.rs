//! Reference points of the corrected quasi-steady theory.

use crate::aerodynamics::Transfer;
use crate::error::{Error, Result, ensure, finite};
use crate::section::Dof;
use crate::units::ReducedFrequency;
use serde::{Deserialize, Serialize};

/// An entry of `G` below this part of the largest in its row gives no arm: it is noise.
const SMALLEST_DIVISOR: f64 = 1e-6;

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

    /// Arms from a model with derivatives, `B₁x = B P₂*/P₅*`, `B₁y = B H₂*/H₁*`, `B₁θ = B A₂*/A₁*` (1.18), at a reduced
    /// frequency low enough for quasi-steady flow; each is a ratio of imaginary parts of `G`. A model without the
    /// lateral degree of freedom gives a lateral arm of zero.
    pub fn from_model(model: &dyn Transfer, k: ReducedFrequency) -> Result<Self> {
        let g = model.transfer(k)?;
        let place = |dof: Dof| model.dofs().iter().position(|d| *d == dof);
        let (Some(y), Some(theta)) = (place(Dof::Vertical), place(Dof::Torsion)) else {
            return Err(Error::input(
                "arms of quasi-steady theory",
                "a model with the vertical and the torsional degree of freedom",
                Dof::names(model.dofs()),
            ));
        };
        let arm = |dof: Dof| -> Result<f64> {
            let Some(row) = place(dof) else {
                return Ok(0.0);
            };
            let (by_heave, by_rotation) = (g[(row, y)].im, g[(row, theta)].im);
            let largest = g.row(row).iter().map(|z| z.norm()).fold(0.0, f64::max);
            if by_heave.abs() <= SMALLEST_DIVISOR * largest {
                return Err(Error::Numerical(format!(
                    "arms of quasi-steady theory: the force of the {} degree of freedom does not depend on the vertical \
                     velocity at K = {}",
                    dof.name(),
                    k.full_width()
                )));
            }
            Ok(by_rotation / by_heave)
        };
        Ok(Self {
            lateral: arm(Dof::Lateral)?,
            vertical: arm(Dof::Vertical)?,
            torsion: arm(Dof::Torsion)?,
        })
    }
}
