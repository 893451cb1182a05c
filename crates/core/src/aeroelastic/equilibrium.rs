//! Static equilibrium of the section under quasi-steady forces over wind speed (1.9).
//!
//! `K q = ½ρV² diag(B, B, B²) Tᵀ c(θ)`: only the rotation enters the forces, so that with the flexibility `K⁻¹` one equation
//! `g(θ) = θ − ½ρV² [K⁻¹ diag(B, B, B²) Tᵀ c(θ)]_θ = 0` is left. It is followed from still air by Newton's method with
//! prediction along the tangent. The branch ends where its slope `g'` comes to zero (torsional divergence) or where
//! the rotation leaves the table.

use crate::aerodynamics::quasi_steady::QuasiSteady;
use crate::error::{Error, Result, ensure, non_negative};
use crate::section::{Dof, Structure};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Newton steps before the step in pressure is halved.
const MAX_NEWTON_STEPS: usize = 12;
/// Relative size of the last Newton step.
const NEWTON_TOLERANCE: f64 = 1e-14;
/// Part of the still-air stiffness at which the section has diverged.
const DIVERGED: f64 = 1e-9;
/// Stiffness left at the end of the branch above which the end is that of the table and no divergence.
const STIFF: f64 = 1e-3;
/// Least part of its stiffness that a step may leave; keeps Newton's method on the branch.
const LEAST_LEFT: f64 = 0.3;
/// Relative step in pressure at which the branch has ended.
const LEAST_STEP: f64 = 1e-14;

/// The section at rest in the mean wind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StaticEquilibrium {
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// Displacements (n): m, rad, in the order of the degrees of freedom.
    pub displacement: Vec<f64>,
    /// Rotation, rad, which is the angle of attack as well.
    pub rotation_rad: f64,
    /// Torsional stiffness that is left in the wind, as a part of that in still air; zero at divergence.
    pub stiffness_left: f64,
}

/// Where the equilibrium ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EquilibriumEnd {
    /// Torsional divergence: no equilibrium beyond, or no stable one.
    Divergence {
        /// Wind speed of the last equilibrium, m/s.
        speed_m_s: f64,
        /// Rotation there, rad.
        rotation_rad: f64,
    },
    /// The rotation leaves the table of static coefficients.
    OutsideTable {
        /// Wind speed of the last equilibrium, m/s.
        speed_m_s: f64,
        /// Rotation there, rad.
        rotation_rad: f64,
    },
}

impl EquilibriumEnd {
    /// Wind speed, m/s.
    pub fn speed_m_s(&self) -> f64 {
        match self {
            Self::Divergence { speed_m_s, .. } | Self::OutsideTable { speed_m_s, .. } => *speed_m_s,
        }
    }

    /// In words.
    pub fn explain(&self) -> String {
        let (what, rotation) = match self {
            Self::Divergence { rotation_rad, .. } => ("torsional divergence", rotation_rad),
            Self::OutsideTable { rotation_rad, .. } => (
                "the rotation leaves the table of coefficients",
                rotation_rad,
            ),
        };
        format!(
            "no equilibrium above {:.3} m/s: {what} at {:.3} deg",
            self.speed_m_s(),
            rotation.to_degrees()
        )
    }
}

/// Equilibria over wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EquilibriumPath {
    /// One for each speed asked for, up to the end of the branch.
    pub points: Vec<StaticEquilibrium>,
    /// Where the branch ends, if it does so below the highest speed asked for.
    pub end: Option<EquilibriumEnd>,
}

/// Equilibria at the rising `speeds_m_s` on the branch that begins in still air.
///
/// # Errors
/// [`Error::Input`] for speeds that fall, for a theory of other degrees of freedom than the structure's and for a table
/// without the angle zero; [`Error::Numerical`] when a degree of freedom has no stiffness.
pub fn static_equilibria(
    structure: &Structure,
    theory: &QuasiSteady,
    speeds_m_s: &[f64],
) -> Result<EquilibriumPath> {
    let branch = Branch::new(structure, theory)?;
    let mut at = branch.place(0.0, 0.0)?;
    let mut points = Vec::with_capacity(speeds_m_s.len());
    let mut last = 0.0;
    for &speed in speeds_m_s {
        let rises = non_negative("wind speeds", speed)? >= last;
        let found = format_args!("{speed} after {last}");
        ensure(rises, "wind speeds", "rising numbers", found)?;
        last = speed;
        let pressure = 0.5 * structure.air_density_kg_m3 * speed * speed;
        let (reached, arrived) = branch.follow(at, pressure)?;
        at = reached;
        if !arrived {
            let end = Some(branch.end(at));
            return Ok(EquilibriumPath { points, end });
        }
        points.push(branch.point(at, speed)?);
    }
    Ok(EquilibriumPath { points, end: None })
}

/// A place on the branch.
#[derive(Debug, Clone, Copy)]
struct BranchPoint {
    /// `½ρV²`, N/m².
    pressure: f64,
    /// Rotation, rad.
    rotation: f64,
    /// `g'`, the stiffness that is left.
    left: f64,
    /// Rotation per pressure by the forces at this angle, rad·m²/N.
    compliance: f64,
}

struct Branch<'a> {
    structure: &'a Structure,
    theory: &'a QuasiSteady,
    /// `K⁻¹ diag(B, B, B²) Tᵀ`, n×n.
    flexibility: DMatrix<f64>,
    torsion: usize,
}

impl<'a> Branch<'a> {
    fn new(structure: &'a Structure, theory: &'a QuasiSteady) -> Result<Self> {
        theory.check_dofs("static equilibrium", &structure.dofs)?;
        let mut flexibility = structure.stiffness.clone().try_inverse().ok_or_else(|| {
            Error::Numerical("static equilibrium: a degree of freedom has no stiffness".into())
        })?;
        for (mut column, dof) in flexibility.column_iter_mut().zip(&structure.dofs) {
            column *= dof.force_scale(structure.width_m);
        }
        let n = structure.dofs.len();
        flexibility *= structure.forces_at_axis(DMatrix::identity(n, n));
        let torsion = structure.dofs.iter().position(|d| *d == Dof::Torsion);
        Ok(Self {
            structure,
            theory,
            flexibility,
            torsion: torsion.unwrap_or(structure.dofs.len() - 1),
        })
    }

    /// Compliance and stiffness left at a pressure and rotation.
    fn place(&self, pressure: f64, rotation: f64) -> Result<BranchPoint> {
        let (values, slopes) = self.theory.static_forces(rotation)?;
        let row = self.flexibility.row(self.torsion);
        let by = |v: &[f64]| row.iter().zip(v).map(|(f, c)| f * c).sum::<f64>();
        Ok(BranchPoint {
            pressure,
            rotation,
            left: 1.0 - pressure * by(&slopes),
            compliance: by(&values),
        })
    }

    /// From one place to the pressure `target`, or to the end of the branch; whether it arrived.
    fn follow(&self, from: BranchPoint, target: f64) -> Result<(BranchPoint, bool)> {
        let mut at = from;
        let mut step = target - at.pressure;
        while at.pressure < target {
            if at.left < DIVERGED || step <= LEAST_STEP * target {
                return Ok((at, false));
            }
            let pressure = (at.pressure + step).min(target);
            match self.correct(at, pressure) {
                Some(next) => {
                    at = next;
                    step *= 2.0;
                }
                None => step = 0.5 * step.min(target - at.pressure),
            }
        }
        Ok((at, true))
    }

    /// The place at `pressure` on the branch through `from`; `None` when the step is too long.
    fn correct(&self, from: BranchPoint, pressure: f64) -> Option<BranchPoint> {
        let mut rotation = from.rotation + (pressure - from.pressure) * from.compliance / from.left;
        for _ in 0..MAX_NEWTON_STEPS {
            // outside the table there is nothing to correct with
            let at = self.place(pressure, rotation).ok()?;
            if at.left <= LEAST_LEFT * from.left {
                return None;
            }
            let change = (rotation - pressure * at.compliance) / at.left;
            if change.abs() <= NEWTON_TOLERANCE * (1.0 + rotation.abs()) / at.left {
                return Some(at);
            }
            rotation -= change;
        }
        None
    }

    fn end(&self, at: BranchPoint) -> EquilibriumEnd {
        let speed_m_s = (2.0 * at.pressure / self.structure.air_density_kg_m3).sqrt();
        let rotation_rad = at.rotation;
        if at.left < STIFF {
            EquilibriumEnd::Divergence {
                speed_m_s,
                rotation_rad,
            }
        } else {
            EquilibriumEnd::OutsideTable {
                speed_m_s,
                rotation_rad,
            }
        }
    }

    fn point(&self, at: BranchPoint, speed_m_s: f64) -> Result<StaticEquilibrium> {
        let (values, _) = self.theory.static_forces(at.rotation)?;
        let displacement = &self.flexibility * DVector::from_vec(values) * at.pressure;
        Ok(StaticEquilibrium {
            speed_m_s,
            displacement: displacement.as_slice().to_vec(),
            rotation_rad: at.rotation,
            stiffness_left: at.left,
        })
    }
}

#[cfg(test)]
mod tests;
