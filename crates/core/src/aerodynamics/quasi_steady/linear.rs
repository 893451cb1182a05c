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
pub struct LinearQuasiSteady {
    dofs: Vec<Dof>,
    rotation_rad: f64,
    /// The arms `B₁ᵢ/B`.
    pub arms: Arms,
    coefficients: CoefficientsAt,
    /// `e₀`, n×n.
    #[serde(with = "crate::state_space::rows")]
    pub e0: DMatrix<f64>,
    /// `e₁`, n×n.
    #[serde(with = "crate::state_space::rows")]
    pub e1: DMatrix<f64>,
    /// Dimensionless forces by the gusts `(u/V, w/V)`, n×2.
    #[serde(with = "crate::state_space::rows")]
    pub buffeting: DMatrix<f64>,
}

impl LinearQuasiSteady {
    /// From the coefficients at the rotation `θ₀` (rad) about which the theory is linear.
    pub fn new(dofs: &[Dof], arms: Arms, rotation_rad: f64, at: CoefficientsAt) -> Self {
        let n = dofs.len();
        let by_u = |dof: Dof| 2.0 * at.coefficient(dof).0;
        let by_w = |dof: Dof| match dof {
            Dof::Vertical => at.lift_slope + at.drag,
            Dof::Lateral => at.drag_slope - at.lift,
            Dof::Torsion => at.moment_slope,
        };
        let by_rotation = |dof: Dof| at.coefficient(dof).1;
        let e0 = DMatrix::from_fn(n, n, |i, j| match dofs[j] {
            Dof::Torsion => by_rotation(dofs[i]),
            _ => 0.0,
        });
        let e1 = DMatrix::from_fn(n, n, |i, j| match dofs[j] {
            Dof::Vertical => -by_w(dofs[i]),
            Dof::Lateral => -by_u(dofs[i]),
            Dof::Torsion => -arms.arm(dofs[i]) * by_w(dofs[i]),
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
