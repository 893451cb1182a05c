//! Quasi-steady theory: forces from static coefficients and the relative wind (1.1)–(1.7), and its linearisation
//! about a rotation (1.11)–(1.13, appendix A), with the corrections listed in `docs/quasi_steady.md`.
//!
//! The flow that a force component sees is that at a reference point at the distance `B₁` upwind of the axis; with
//! `B₁ᵢ` of its own for each component the theory is the corrected quasi-steady one.

mod arms;
pub mod coefficients;
mod linear;

pub use arms::Arms;
pub use coefficients::{CoefficientRow, CoefficientsAt, StaticCoefficients};
pub use linear::LinearQuasiSteady;

use crate::error::{Result, ensure};
use crate::section::Dof;

/// Quasi-steady theory of one deck.
///
/// Component `i` sees the relative wind at its own reference point,
///
/// ```text
/// a = V + u − ẋ,  bᵢ = w − ẏ − B₁ᵢ θ̇,  V_rel² = a² + bᵢ²,  ψᵢ = atan(bᵢ/a),  αᵢ = θ + ψᵢ
/// F_x = ½ρB V_rel² (C_D(α_x) cos ψ_x − C_L(α_x) sin ψ_x)
/// F_y = ½ρB V_rel² (C_D(α_y) sin ψ_y + C_L(α_y) cos ψ_y)
/// M   = ½ρB² V_rel² C_M(α_θ)
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct QuasiSteady {
    coefficients: StaticCoefficients,
    arms: Arms,
    dofs: Vec<Dof>,
}

impl QuasiSteady {
    /// The theory for a deck of these degrees of freedom.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) when the degrees of freedom are neither [`Dof::TWO`] nor [`Dof::THREE`] or an arm is not finite.
    pub fn new(coefficients: StaticCoefficients, arms: Arms, dofs: &[Dof]) -> Result<Self> {
        arms.validate("")?;
        ensure(
            dofs == Dof::TWO || dofs == Dof::THREE,
            "quasi-steady theory",
            "vertical and torsional degrees of freedom, with or without the lateral one between",
            Dof::names(dofs),
        )?;
        Ok(Self {
            coefficients,
            arms,
            dofs: dofs.to_vec(),
        })
    }

    /// The static coefficients.
    pub fn coefficients(&self) -> &StaticCoefficients {
        &self.coefficients
    }

    /// Degrees of freedom, in the order of the forces.
    pub fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    /// Refuses `what` of other degrees of freedom.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) naming both.
    pub fn check_dofs(&self, what: &str, dofs: &[Dof]) -> Result<()> {
        let expected = format_args!("quasi-steady forces of {}", Dof::names(dofs));
        ensure(self.dofs == dofs, what, expected, Dof::names(&self.dofs))
    }

    /// Forces `F/(½ρB)` and `M/(½ρB²)` (m²/s²) into the first n places, at the rotation `θ` (rad), in what the deck feels of the
    /// wind with its gusts and its own velocity: `V + u − ẋ`, `w − ẏ` and `B θ̇`, m/s.
    pub fn specific_forces(
        &self,
        rotation_rad: f64,
        [along, vertical, rotation]: [f64; 3],
    ) -> Result<[f64; 3]> {
        let mut forces = [0.0; 3];
        for (force, dof) in forces.iter_mut().zip(&self.dofs) {
            let normal = vertical - self.arms.arm(*dof) * rotation;
            let square = along * along + normal * normal;
            let psi = normal.atan2(along);
            let c = self.coefficients.at(rotation_rad + psi)?;
            let direction = match dof {
                Dof::Vertical => c.drag * psi.sin() + c.lift * psi.cos(),
                Dof::Lateral => c.drag * psi.cos() - c.lift * psi.sin(),
                Dof::Torsion => c.moment,
            };
            *force = square * direction;
        }
        Ok(forces)
    }

    /// Static coefficients of the force components at a rotation in smooth wind (1.9), and their slopes per rad, in the order of
    /// the degrees of freedom.
    pub fn static_forces(&self, rotation_rad: f64) -> Result<(Vec<f64>, Vec<f64>)> {
        let c = self.coefficients.at(rotation_rad)?;
        Ok(self.dofs.iter().map(|dof| c.coefficient(*dof)).unzip())
    }

    /// The linear theory about the rotation `θ₀` (rad) in smooth wind (1.11)–(1.13).
    pub fn linearised(&self, rotation_rad: f64) -> Result<LinearQuasiSteady> {
        let at = self.coefficients.at(rotation_rad)?;
        Ok(LinearQuasiSteady::new(
            &self.dofs,
            self.arms,
            rotation_rad,
            at,
        ))
    }
}
