//! Static divergence: in closed form, and by a real eigenvalue of the coupled system that passes through zero.

use crate::aerodynamics::{FlatPlate, Transfer, TransferMatrix};
use crate::aeroelastic::{CoupledSection, CoupledSystem};
use crate::error::{Error, Result, ensure, positive};
use crate::section::{Dof, Structure};
use crate::state_space::{ValueAt, balance, eigenvalues, root};
use crate::units::ReducedFrequency;
use nalgebra::DMatrix;

/// Speeds at which the sign of the determinant is looked at.
const SPEEDS: usize = 400;

/// [`divergence_speed`] under the forces that a model has at rest, m/s.
///
/// # Errors
/// As there, and where the model has no forces at `K = 0`.
pub fn divergence_with_forces(structure: &Structure, forces: &dyn Transfer) -> Result<Option<f64>> {
    let still = forces.transfer(ReducedFrequency::from_full_width(0.0))?;
    divergence_speed(structure, &still)
}

/// Lowest speed at which `det(K − ½ρV² P(G(0))) = 0`, m/s; `None` when the steady forces never overcome the springs.
///
/// `static_transfer` is `G` at `K = 0`, n×n.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::{FlatPlate, Transfer};
/// use aerodeck::flutter::divergence_speed;
/// use aerodeck::section::SectionModel;
/// use aerodeck::units::ReducedFrequency;
/// use std::f64::consts::PI;
///
/// let structure = SectionModel::iabse_1_1a().structure()?;
/// let steady = FlatPlate::default().transfer(ReducedFrequency::from_full_width(0.0))?;
/// let found = divergence_speed(&structure, &steady)?.expect("a plate diverges");
/// // k_θ = ½ρV²B² π/2
/// let closed = (4.0 * structure.stiffness[(1, 1)] / (PI * structure.air_density_kg_m3)).sqrt() / structure.width_m;
/// assert!((found / closed - 1.0).abs() < 1e-12);
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] for forces of another number of motions; [`Error::Numerical`] when a degree of freedom has no stiffness or
/// the numbers are not finite.
pub fn divergence_speed(
    structure: &Structure,
    static_transfer: &TransferMatrix,
) -> Result<Option<f64>> {
    // a matrix has no names of its motions, only their number
    let (n, size) = (structure.dofs.len(), static_transfer.shape());
    let expected = format_args!("{n} by {n}, of {} motion", Dof::names(&structure.dofs));
    let found = format_args!("{} by {}", size.0, size.1);
    ensure(size == (n, n), "forces", expected, found)?;
    let per_pressure = structure.to_physical(&static_transfer.map(|z| z.re));
    let flexibility = structure.stiffness.clone().try_inverse().ok_or_else(|| {
        Error::Numerical("divergence: a degree of freedom has no stiffness".into())
    })?;
    // ½ρV² μ = 1 with μ the eigenvalues of K⁻¹ P(G(0))
    let largest = eigenvalues(&(flexibility * per_pressure))?
        .into_iter()
        .filter(|mu| mu.im.abs() <= 1e-9 * mu.norm())
        .map(|mu| mu.re)
        .fold(0.0, f64::max);
    Ok((largest > 0.0).then(|| (2.0 / (structure.air_density_kg_m3 * largest)).sqrt()))
}

/// The static part of forces `g` (n×n) known at a low reduced frequency only: what rotation causes in phase with it
/// (`H3*`, `A3*`, `P3*`). A displacement that is held causes no force; what a table shows for it in phase (`H4*`, `A4*`)
/// is of the rate of motion, and left in it moved the divergence of a published section by 4 % to the unsafe side.
pub fn static_part(dofs: &[Dof], g: &TransferMatrix) -> TransferMatrix {
    TransferMatrix::from_fn(g.nrows(), g.ncols(), |i, j| match dofs[j] {
        Dof::Torsion => g[(i, j)].re.into(),
        Dof::Vertical | Dof::Lateral => 0.0.into(),
    })
}

/// What stands for steady flow when nothing below a reduced frequency was tested, with what it costs on a flat plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AssumedAtRest {
    /// Lowest tested reduced frequency, whose slopes are used.
    k: ReducedFrequency,
    /// How much too high the divergence of a flat plate comes out, relatively.
    excess: f64,
}

impl AssumedAtRest {
    /// With the slopes at `k`.
    pub fn below(k: ReducedFrequency) -> Result<Self> {
        let slope = |k| FlatPlate::default().transfer(k).map(|g| g[(1, 1)].re);
        let still = slope(ReducedFrequency::from_full_width(0.0))?;
        // ½ρV² times the slope is the stiffness: the speed goes with one over the root
        let excess = (still / slope(k)?).sqrt() - 1.0;
        Ok(Self { k, excess })
    }

    /// What is left of a divergence speed when the deck behaves as a plate does, m/s.
    pub fn lower_m_s(self, speed_m_s: f64) -> f64 {
        speed_m_s / (1.0 + self.excess.max(0.0))
    }

    /// In words.
    pub fn explain(self) -> String {
        format!(
            "K → 0 was not tested: H3*, A3* at the lowest tested K, {:.3}, are used as the static slopes; nothing is used for \
             H4*, A4*, which are dynamic there (a flat plate's divergence would come out {:.1} % too high)",
            self.k.full_width(),
            100.0 * self.excess
        )
    }
}

/// Lowest speed up to `speed_max_m_s` at which a real eigenvalue of the coupled system passes through zero, m/s: a change
/// of sign of `det A` (of `det(A − I)` for the sampled system).
///
/// # Errors
/// [`Error::Input`] for a highest speed that is not positive.
pub fn divergence_by_eigenvalues(
    section: &CoupledSection,
    speed_max_m_s: f64,
) -> Result<Option<f64>> {
    let speed_max = positive("highest wind speed", speed_max_m_s)?;
    let mut before: Option<ValueAt> = None;
    for i in 1..=SPEEDS {
        let speed = speed_max * i as f64 / SPEEDS as f64;
        let after = ValueAt::new(speed, singularity(section, speed)?);
        if let Some(before) = before.filter(|b| (b.value > 0.0) != (after.value > 0.0)) {
            return root(before, after, |speed| singularity(section, speed)).map(Some);
        }
        before = Some(after);
    }
    Ok(None)
}

/// A number with the sign of the product of all eigenvalues (less one for the sampled system); zero at divergence.
fn singularity(section: &CoupledSection, speed_m_s: f64) -> Result<f64> {
    let CoupledSystem { mut a, step_s } = section.at(speed_m_s)?;
    if step_s.is_some() {
        a -= DMatrix::identity(a.nrows(), a.nrows());
    }
    Ok(balance(&a).determinant())
}
