//! Aerodynamic derivatives from a released section: the free motion method (thesis, 1.2.1).
//!
//! A section released in wind moves as `q(t) = Σ_m Re(φ_m e^{λ_m t})`. The complex modes of this coupled response are identified from
//! all channels at once (`modes`); with the structure `(M, R, K)` known, each obeys
//!
//! ```text
//! (M λ² + R λ + K) φ = F_m = ½ρV² P(G(λB/V)) φ         P(G) = diag(B, B, B²) G diag(1/B, 1/B, 1)
//! ```
//!
//! exactly, whatever the memory of the flow. The n modes of n degrees of freedom determine one real pair `F = R_ae q̇ + K_ae q` (1.14)
//! that does the same to all of them (Sarkar, Jones & Scanlan 1994, J. Eng. Mech. 120(8), for the idea). Its columns are read as
//! derivatives at the frequency of the mode in which that motion leads. What this cannot see is how `G` changes between the modes:
//! an entry by which a mode hardly moves carries what the others change, and the growth of the mode counts as small,
//! `G(λB/V) ≈ G(iωB/V)`. [`FreeDecay::modal_force`] has none of these approximations.

mod modes;

pub use modes::{DecayMode, DecayOptions, identify_modes};

use crate::aerodynamics::derivatives::{Derivative, Part};
use crate::error::{Error, Result, positive};
use crate::section::{Dof, Structure};
use crate::units::ReducedFrequency;
use crate::wind_tunnel::Record;
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};

/// A derivative from a decay.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DecayDerivative {
    /// Which one.
    pub derivative: Derivative,
    /// `V̂ = V/(ωB)` of the mode at whose frequency it is read.
    pub v_hat: f64,
    /// The derivative.
    pub value: f64,
    /// Part of its motion in that mode, 1 for the one that leads: figures of a motion that hardly takes part are poor.
    pub participation: f64,
}

/// What a released section says of its aerodynamics at one wind speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FreeDecay {
    /// Name of the record.
    pub record: String,
    /// Wind speed, m/s.
    pub speed_m_s: f64,
    /// Degrees of freedom.
    pub dofs: Vec<Dof>,
    /// The modes, by frequency.
    pub modes: Vec<DecayMode>,
    /// Aerodynamic damping `R_ae` of `F = R_ae q̇ + K_ae q` about the axis of the section, row by row, per unit length.
    pub damping: Vec<Vec<f64>>,
    /// Aerodynamic stiffness `K_ae`, row by row, per unit length.
    pub stiffness: Vec<Vec<f64>>,
    /// Derivatives about the reference point of the section, each at the mode that its motion leads.
    pub derivatives: Vec<DecayDerivative>,
}

/// Identifies the modes of a decay and the aerodynamic damping and stiffness behind them; the forces of `record`, if it has any,
/// are not used.
///
/// # Errors
/// [`Error::Input`] when the record and the structure have other degrees of freedom, or the record is too short;
/// [`Error::Numerical`] when fewer modes than degrees of freedom can be told in it.
pub fn identify_free_decay(
    record: &Record,
    structure: &Structure,
    options: &DecayOptions,
) -> Result<FreeDecay> {
    let header = &record.header;
    let place = |key: &str| format!("record {}: {key}", header.name);
    let speed = positive(&place("mean_speed_m_s"), header.mean_speed_m_s)?;
    if header.dofs != structure.dofs {
        return Err(Error::input(
            place("dofs"),
            format!("{:?}, as the structure", structure.dofs),
            format!("{:?}", header.dofs),
        ));
    }
    let modes = identify_modes(&header.name, &record.motion, header.sampling_hz, options)?;
    let (damping, stiffness) = aerodynamic_matrices(structure, &modes)?;
    let derivatives = derivatives(structure, speed, &modes, &damping, &stiffness);
    let rows = |m: &DMatrix<f64>| m.row_iter().map(|r| r.iter().copied().collect()).collect();
    Ok(FreeDecay {
        record: header.name.clone(),
        speed_m_s: speed,
        dofs: header.dofs.clone(),
        modes,
        damping: rows(&damping),
        stiffness: rows(&stiffness),
        derivatives,
    })
}

impl FreeDecay {
    /// `(Mλ² + Rλ + K) φ`: the self-excited force of a mode per unit length, without any assumption on the flow.
    pub fn modal_force(&self, structure: &Structure, mode: usize) -> Vec<Complex<f64>> {
        let Some(mode) = self.modes.get(mode) else {
            return Vec::new();
        };
        let (lambda, shape) = (mode.eigenvalue(), mode.shape());
        let n = shape.len();
        (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| {
                        let (m, r, k) = (
                            structure.mass[(i, j)],
                            structure.damping[(i, j)],
                            structure.stiffness[(i, j)],
                        );
                        (lambda * lambda * m + lambda * r + k) * shape[j]
                    })
                    .sum()
            })
            .collect()
    }
}

/// `R − C` and `K − S` with the real pair of which all modes are solutions: `M λ² φ + C λ φ + S φ = 0`.
fn aerodynamic_matrices(
    structure: &Structure,
    modes: &[DecayMode],
) -> Result<(DMatrix<f64>, DMatrix<f64>)> {
    let n = structure.dofs.len();
    let mut known = DMatrix::zeros(n, 2 * n);
    let mut unknown = DMatrix::zeros(2 * n, 2 * n);
    for (m, mode) in modes.iter().enumerate() {
        let (lambda, shape) = (mode.eigenvalue(), mode.shape());
        for i in 0..n {
            let inertia: Complex<f64> = (0..n)
                .map(|j| lambda * lambda * shape[j] * structure.mass[(i, j)])
                .sum();
            known[(i, 2 * m)] = -inertia.re;
            known[(i, 2 * m + 1)] = -inertia.im;
            let rate = lambda * shape[i];
            unknown[(i, 2 * m)] = rate.re;
            unknown[(i, 2 * m + 1)] = rate.im;
            unknown[(n + i, 2 * m)] = shape[i].re;
            unknown[(n + i, 2 * m + 1)] = shape[i].im;
        }
    }
    let inverse = unknown.try_inverse().ok_or_else(|| {
        Error::Numerical("free decay: the shapes of the modes are not independent".into())
    })?;
    let both = known * inverse;
    Ok((
        &structure.damping - both.columns(0, n),
        &structure.stiffness - both.columns(n, n),
    ))
}

/// A physical aerodynamic matrix about the axis as one about the reference point, to which derivatives refer.
fn about_reference(structure: &Structure, about_axis: &DMatrix<f64>) -> DMatrix<f64> {
    // the reference point lies as far from the axis as the axis from it, on the other side; a width of one metre, so
    // that lengths stay in metres
    let back = Structure {
        axis_offset_m: -structure.axis_offset_m,
        width_m: 1.0,
        ..structure.clone()
    };
    back.at_axis(about_axis.clone())
}

fn derivatives(
    structure: &Structure,
    speed: f64,
    modes: &[DecayMode],
    damping: &DMatrix<f64>,
    stiffness: &DMatrix<f64>,
) -> Vec<DecayDerivative> {
    let (dofs, width) = (&structure.dofs, structure.width_m);
    let (damping, stiffness) = (
        about_reference(structure, damping),
        about_reference(structure, stiffness),
    );
    let pressure = 0.5 * structure.air_density_kg_m3 * speed * speed;
    let part = |mode: &DecayMode, j: usize| {
        let size = |i: usize| mode.shape()[i].norm() * dofs[i].motion_scale(width);
        size(j) / (0..dofs.len()).map(size).fold(f64::MIN_POSITIVE, f64::max)
    };
    let mut found = Vec::new();
    for (j, motion) in dofs.iter().enumerate() {
        let leading = modes
            .iter()
            .max_by(|a, b| part(a, j).total_cmp(&part(b, j)));
        let Some(mode) = leading else { continue };
        let omega = mode.eigenvalue().im;
        let k = ReducedFrequency::from_circular(omega, width, speed);
        for (i, force) in dofs.iter().enumerate() {
            let scale = 1.0 / (pressure * force.force_scale(width) * motion.motion_scale(width));
            for (which, g) in [
                (Part::Real, stiffness[(i, j)]),
                (Part::Imaginary, omega * damping[(i, j)]),
            ] {
                found.push(DecayDerivative {
                    derivative: Derivative::of(*force, *motion, which),
                    v_hat: k.v_hat(),
                    value: g * scale * k.v_hat() * k.v_hat(),
                    participation: part(mode, j),
                });
            }
        }
    }
    found
}

#[cfg(test)]
mod tests;
