//! Derivatives of a theory over reduced velocity, to stand beside measured ones.

use crate::aerodynamics::Transfer;
use crate::aerodynamics::derivatives::{Derivative, Part};
use crate::error::Result;
use crate::units::ReducedFrequency;
use std::collections::BTreeMap;

/// Points a line.
const POINTS: usize = 120;

/// `V̂` and value of every derivative that `model` has, from `v_hat_max/120` to `v_hat_max`.
pub(crate) fn derivative_lines(
    model: &dyn Transfer,
    v_hat_max: f64,
) -> Result<BTreeMap<Derivative, Vec<(f64, f64)>>> {
    let dofs = model.dofs();
    let mut lines = BTreeMap::<Derivative, Vec<(f64, f64)>>::new();
    for step in 1..=POINTS {
        let v_hat = v_hat_max * step as f64 / POINTS as f64;
        let g = model.transfer(ReducedFrequency::from_v_hat(v_hat))?;
        for (i, force) in dofs.iter().enumerate() {
            for (j, motion) in dofs.iter().enumerate() {
                let z = g[(i, j)] * v_hat * v_hat;
                for (part, value) in [(Part::Real, z.re), (Part::Imaginary, z.im)] {
                    let line = lines.entry(Derivative::from_entry(*force, *motion, part));
                    line.or_default().push((v_hat, value));
                }
            }
        }
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::FlatPlate;

    /// At high reduced velocity the flat plate is quasi-steady: `H1* → −2πV̂ F`, `A3*/V̂² → (π/2) F`, F → 1.
    #[test]
    fn the_flat_plate_tends_to_its_quasi_steady_limit() {
        let lines = derivative_lines(&FlatPlate::default(), 2000.0).unwrap();
        let (v_hat, h1) = lines[&Derivative::H1][POINTS - 1];
        assert_eq!(v_hat, 2000.0);
        // F(k = 1/4000) = 1 − πk/2 + …
        assert!(
            (h1 / (-std::f64::consts::TAU * v_hat) - 1.0).abs() < 1e-3,
            "{h1}"
        );
        let (v_hat, a3) = lines[&Derivative::A3][POINTS - 1];
        assert!((a3 / (0.5 * std::f64::consts::PI * v_hat * v_hat) - 1.0).abs() < 1e-3);
    }
}
