//! Static divergence in closed form.

use crate::aerodynamics::TransferMatrix;
use crate::error::{Error, Result};
use crate::section::Structure;
use crate::state_space::eigenvalues;

/// Lowest speed at which `det(K − ½ρV² P(G(0))) = 0`, m/s; `None` when the steady forces never overcome the springs.
///
/// `static_transfer` is `G` at `K = 0`, n×n.
///
/// # Errors
/// [`Error::Numerical`] when a degree of freedom has no stiffness or the numbers are not finite.
pub fn divergence_speed(
    structure: &Structure,
    static_transfer: &TransferMatrix,
) -> Result<Option<f64>> {
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
