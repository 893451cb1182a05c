//! Theodorsen's flat plate, exact in the frequency domain, about mid-chord.
//!
//! T. Theodorsen, NACA Report 496 (1935), written for full width `B`, `k = K/2` and lift positive up.

use super::{Transfer, TransferMatrix};
use crate::error::{Result, positive};
use crate::section::Dof;
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix};
use serde::Deserialize;
use std::f64::consts::PI;

/// Self-excited forces on a thin plate in potential flow.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::{FlatPlate, Transfer};
/// use aerodeck::units::ReducedFrequency;
/// use std::f64::consts::{FRAC_PI_2, PI};
///
/// // in steady flow a rotation gives the lift slope 2π and about mid-chord the moment slope π/2
/// let steady = FlatPlate::default().transfer(ReducedFrequency::from_full_width(0.0))?;
/// assert!((steady[(0, 1)].re - 2.0 * PI).abs() < 1e-12);
/// assert!((steady[(1, 1)].re - FRAC_PI_2).abs() < 1e-12);
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FlatPlate {
    /// Keep the apparent rotary inertia of the air (the `π/64` term of `A3*`). Participants of the IABSE
    /// benchmark leave it out.
    pub rotary_inertia: bool,
}

impl Default for FlatPlate {
    fn default() -> Self {
        Self {
            rotary_inertia: true,
        }
    }
}

/// Theodorsen's function `C(k) = H₁⁽²⁾/(H₁⁽²⁾ + i H₀⁽²⁾)` at semi-chord reduced frequency `k ≥ 0`; `C(0) = 1`.
pub fn theodorsen(k: f64) -> Complex<f64> {
    if k == 0.0 {
        return Complex::new(1.0, 0.0);
    }
    let h0 = Complex::new(libm::j0(k), -libm::y0(k));
    let h1 = Complex::new(libm::j1(k), -libm::y1(k));
    h1 / (h1 + Complex::<f64>::i() * h0)
}

impl Transfer for FlatPlate {
    fn dofs(&self) -> &[Dof] {
        &Dof::TWO
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let k_full = k.full_width();
        if k_full != 0.0 {
            positive("reduced frequency K", k_full)?;
        }
        let p = Complex::new(0.0, k_full);
        let c = theodorsen(k.semi_chord());
        let rotary = if self.rotary_inertia { PI / 64.0 } else { 0.0 };
        let lagged = (p / 4.0 + 1.0) * c;
        Ok(DMatrix::from_row_slice(
            2,
            2,
            &[
                -p * p * (PI / 2.0) - p * c * (2.0 * PI),
                p * (PI / 2.0) + lagged * (2.0 * PI),
                -p * c * (PI / 2.0),
                -p * (PI / 8.0) - p * p * rotary + lagged * (PI / 2.0),
            ],
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn theodorsen_matches_the_tabulated_function() {
        // Bisplinghoff, Ashley, Halfman, Aeroelasticity (1955): C(0.1) and C(1.0), four printed digits
        for (k, re, im) in [(0.1, 0.8319, -0.1723), (1.0, 0.5394, -0.1003)] {
            let c = theodorsen(k);
            assert!((c.re - re).abs() < 5e-5 && (c.im - im).abs() < 5e-5, "{c}");
        }
    }
}
