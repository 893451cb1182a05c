//! Reference points of the corrected quasi-steady theory from derivatives.

use crate::aerodynamics::Transfer;
use crate::aerodynamics::quasi_steady::Arms;
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::units::ReducedFrequency;

/// An entry of `G` below this part of the largest in its row gives no arm: it is noise.
const SMALLEST_DIVISOR: f64 = 1e-6;

/// Arms from a model with derivatives, `B₁x = B P₂*/P₅*`, `B₁y = B H₂*/H₁*`, `B₁θ = B A₂*/A₁*` (1.18), at a reduced
/// frequency low enough for quasi-steady flow; each is a ratio of imaginary parts of `G`. A model without the
/// lateral degree of freedom gives a lateral arm of zero.
pub(super) fn arms_of(model: &dyn Transfer, k: ReducedFrequency) -> Result<Arms> {
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
    Ok(Arms {
        lateral: arm(Dof::Lateral)?,
        vertical: arm(Dof::Vertical)?,
        torsion: arm(Dof::Torsion)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::RationalModel;
    use crate::aerodynamics::quasi_steady::{CoefficientsAt, LinearQuasiSteady};
    use std::f64::consts::PI;

    #[test]
    fn arms_of_a_linear_theory_are_found_again() {
        let arms = Arms {
            lateral: 0.2,
            vertical: -0.25,
            torsion: -0.31,
        };
        let at = CoefficientsAt {
            drag: 0.07,
            lift: -0.1,
            moment: 0.02,
            drag_slope: 0.3,
            lift_slope: 4.4,
            moment_slope: 1.1,
        };
        let model = LinearQuasiSteady::new(&Dof::THREE, arms, 0.0, at);
        let found = arms_of(&model, ReducedFrequency::from_full_width(0.3)).unwrap();
        for dof in Dof::THREE {
            assert!((found.arm(dof) - arms.arm(dof)).abs() < 1e-14);
        }
    }

    /// Jones's plate at low K, by hand from its coefficients: `Im G_yθ/Im G_yy` and `Im G_θθ/Im G_θy`.
    #[test]
    fn arms_from_derivatives() {
        let k = ReducedFrequency::from_full_width(0.4);
        let arms = arms_of(&RationalModel::jones_flat_plate(), k).unwrap();
        let lag = |d: f64| 0.4 * d / (0.16 + d * d);
        let (l1, l2) = (lag(0.091), lag(0.6));
        let h1 = -PI * 0.4 - 0.094342 * l1 - 1.262920 * l2;
        let h2 = 0.75 * PI * 0.4 - 1.013140 * l1 - 1.789137 * l2;
        let a1 = -0.25 * PI * 0.4 - 0.023586 * l1 - 0.315730 * l2;
        let a2 = -PI / 16.0 * 0.4 - 0.253285 * l1 - 0.447284 * l2;
        // the coefficients have six decimals
        assert!((arms.vertical - h2 / h1).abs() < 1e-5);
        assert!((arms.torsion - a2 / a1).abs() < 1e-5);
        assert_eq!(arms.lateral, 0.0);
    }
}
