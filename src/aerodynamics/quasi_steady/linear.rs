//! Linear quasi-steady theory: `G` affine in `iK`, and the buffeting matrix (1.11)–(1.13).

use super::{Arms, CoefficientsAt};
use crate::aerodynamics::{
    ContinuousRealization, Realizable, Realization, Transfer, TransferMatrix,
};
use crate::error::Result;
use crate::section::Dof;
use crate::state_space::complex;
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix};
use serde::Serialize;

/// The forces beside the static ones, `q = e₀ r + e₁ r' + A (u/V, w/V)`, first order in everything.
///
/// With the columns `A = [A_u, A_w]`,
///
/// ```text
/// A_u = 2 (C_L, C_D, C_M)    A_w = (C'_L + C_D, C'_D − C_L, C'_M)    e₀ = [0, 0, (C'_L, C'_D, C'_M)]
/// e₁ = −[A_w, A_u, (B₁y, B₁x, B₁θ)/B · A_w]                 (rows and columns y, x, θ)
/// ```
///
/// which is `½ρVB e₁` for `R_ae` (1.12b), `½ρV² e₀` for `K_ae` (1.12c) and `½ρVB A` for `A_m` (1.12d) once scaled to
/// physical motion and force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct LinearQuasiSteady {
    dofs: Vec<Dof>,
    rotation_rad: f64,
    arms: Arms,
    coefficients: CoefficientsAt,
    #[serde(with = "crate::state_space::rows")]
    e0: DMatrix<f64>,
    #[serde(with = "crate::state_space::rows")]
    e1: DMatrix<f64>,
    #[serde(with = "crate::state_space::rows")]
    buffeting: DMatrix<f64>,
}

impl LinearQuasiSteady {
    /// From the coefficients at the rotation `θ₀` (rad) about which the theory is linear.
    pub(crate) fn new(dofs: &[Dof], arms: Arms, rotation_rad: f64, at: CoefficientsAt) -> Self {
        let n = dofs.len();
        let by_u = |dof: Dof| 2.0 * at.of(dof).0;
        let by_w = |dof: Dof| match dof {
            Dof::Vertical => at.lift_slope + at.drag,
            Dof::Lateral => at.drag_slope - at.lift,
            Dof::Torsion => at.moment_slope,
        };
        let by_rotation = |dof: Dof| at.of(dof).1;
        let e0 = DMatrix::from_fn(n, n, |i, j| match dofs[j] {
            Dof::Torsion => by_rotation(dofs[i]),
            _ => 0.0,
        });
        let e1 = DMatrix::from_fn(n, n, |i, j| match dofs[j] {
            Dof::Vertical => -by_w(dofs[i]),
            Dof::Lateral => -by_u(dofs[i]),
            Dof::Torsion => -arms.of(dofs[i]) * by_w(dofs[i]),
        });
        let buffeting = DMatrix::from_fn(n, 2, |i, j| match j {
            0 => by_u(dofs[i]),
            _ => by_w(dofs[i]),
        });
        Self {
            dofs: dofs.to_vec(),
            rotation_rad,
            arms,
            coefficients: at,
            e0,
            e1,
            buffeting,
        }
    }

    /// `e₀` and `e₁`.
    pub(crate) fn feed_through(&self) -> (&DMatrix<f64>, &DMatrix<f64>) {
        (&self.e0, &self.e1)
    }

    /// The arms `B₁ᵢ/B`.
    pub(crate) fn arms(&self) -> Arms {
        self.arms
    }

    /// Dimensionless forces by the gusts `(u/V, w/V)`, n×2.
    pub(crate) fn buffeting(&self) -> &DMatrix<f64> {
        &self.buffeting
    }
}

impl Transfer for LinearQuasiSteady {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let p = Complex::new(0.0, k.full_width());
        Ok(complex(&self.e0) + complex(&self.e1) * p)
    }

    fn realizable(&self) -> Option<&dyn Realizable> {
        Some(self)
    }
}

impl Realizable for LinearQuasiSteady {
    fn realize(&self) -> Realization {
        let n = self.dofs.len();
        Realization::Continuous(ContinuousRealization {
            a: DMatrix::zeros(0, 0),
            b: DMatrix::zeros(0, n),
            c: DMatrix::zeros(n, 0),
            e0: self.e0.clone(),
            e1: self.e1.clone(),
            e2: DMatrix::zeros(n, n),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::QuasiSteady;
    use super::super::RelativeWind;
    use super::*;
    use crate::files::coefficients::embedded;

    /// Fourth-order central difference: error `h⁴/30` of the fifth derivative plus rounding over `h`, both near 1e-12.
    fn derivative(f: impl Fn(f64) -> [f64; 3]) -> [f64; 3] {
        let h = 1e-3;
        let at = [f(-2.0 * h), f(-h), f(h), f(2.0 * h)];
        std::array::from_fn(|i| {
            (at[0][i] - 8.0 * at[1][i] + 8.0 * at[2][i] - at[3][i]) / (12.0 * h)
        })
    }

    #[test]
    fn agrees_with_finite_differences_of_the_nonlinear_forces() {
        let arms = Arms {
            lateral: 0.17,
            vertical: -0.25,
            torsion: -0.32,
        };
        let table = embedded::coefficients("synthetic box girder").unwrap();
        for dofs in [&Dof::TWO[..], &Dof::THREE[..]] {
            let theory = QuasiSteady::new(table.clone(), arms, dofs).unwrap();
            for degrees in [-6.3_f64, 0.0, 1.7, 5.1] {
                let theta = degrees.to_radians();
                let linear = theory.linearised(theta).unwrap();
                let at = |dx: f64, dy: f64, rate: f64, turn: f64| {
                    let wind = RelativeWind {
                        along_m_s: 1.0 + dx,
                        vertical_m_s: dy,
                        rotation_m_s: rate,
                    };
                    theory.specific_forces(theta + turn, &wind).unwrap()
                };
                let by_u = derivative(|h| at(h, 0.0, 0.0, 0.0));
                let by_w = derivative(|h| at(0.0, h, 0.0, 0.0));
                let by_rate = derivative(|h| at(0.0, 0.0, h, 0.0));
                let by_turn = derivative(|h| at(0.0, 0.0, 0.0, h));
                for (i, _) in dofs.iter().enumerate() {
                    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-8, "{a} {b}");
                    close(linear.buffeting[(i, 0)], by_u[i]);
                    close(linear.buffeting[(i, 1)], by_w[i]);
                    for (j, dof) in dofs.iter().enumerate() {
                        let (e0, e1) = match dof {
                            Dof::Vertical => (0.0, -by_w[i]),
                            Dof::Lateral => (0.0, -by_u[i]),
                            Dof::Torsion => (by_turn[i], by_rate[i]),
                        };
                        close(linear.e0[(i, j)], e0);
                        close(linear.e1[(i, j)], e1);
                    }
                }
            }
        }
    }

    /// `H1* = −(C'_L + C_D)V̂`, `A3* = C'_M V̂²`: the quasi-steady limit in derivatives.
    #[test]
    fn derivatives_of_the_quasi_steady_limit() {
        let table = embedded::coefficients("flat plate").unwrap();
        let theory = QuasiSteady::new(table, Arms::default(), &Dof::TWO).unwrap();
        let k = ReducedFrequency::from_v_hat(7.0);
        let g = theory.linearised(0.0).unwrap().transfer(k).unwrap();
        let square = k.full_width().powi(2);
        let h1 = g[(0, 0)].im / square;
        let a3 = g[(1, 1)].re / square;
        let slope = std::f64::consts::TAU;
        assert!((h1 + (slope + 0.01) * 7.0).abs() < 1e-10);
        assert!((a3 - slope / 4.0 * 49.0).abs() < 1e-10);
    }

    #[test]
    fn the_realisation_is_the_transfer() {
        let table = embedded::coefficients("synthetic box girder").unwrap();
        let arms = Arms {
            vertical: -0.25,
            ..Arms::default()
        };
        let linear = QuasiSteady::new(table, arms, &Dof::THREE).unwrap();
        let linear = linear.linearised(0.03).unwrap();
        let k = ReducedFrequency::from_full_width(0.7);
        let again = linear.realize().transfer(k).unwrap();
        assert!((again - linear.transfer(k).unwrap()).camax() < 1e-15);
    }
}
