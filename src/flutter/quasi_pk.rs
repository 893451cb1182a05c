//! Modes in wind of models that are only a `G(K)`, by the quasi-p-k iteration.

use crate::aerodynamics::AerodynamicModel;
use crate::error::{Error, Result, positive};
use crate::section::Structure;
use crate::state_space::{eigenvalues, eigenvector};
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix, DVector};

/// The iteration contracts by about ten a round; one that needs more than this has no solution.
const MAX_ROUNDS: usize = 200;
/// Relative change at which a mode counts as found.
const TOLERANCE: f64 = 1e-12;

/// Eigenvalue (rad/s) at one wind speed of the mode that moves the degree of freedom `dof` (its index) in still air.
///
/// The forces act as stiffness and damping at the frequency of the mode itself, `ω = Im λ`:
/// `M q̈ + (R − ½ρV² P(Im G)/ω) q̇ + (K − ½ρV² P(Re G)) q = 0` with `G` at `K = ωB/V`. Exact at an onset, where `λ` is
/// imaginary; for damped modes it means by frequency and damping what measured derivatives mean, not what the
/// eigenvalues of a realisation mean.
///
/// # Errors
/// [`Error::Input`] for a speed that is not positive or a `dof` that there is not; those of the model, e.g. outside the
/// range of a table; [`Error::Numerical`] when the mode stops oscillating or the iteration does not settle.
pub fn quasi_pk_mode(
    structure: &Structure,
    model: &dyn AerodynamicModel,
    speed_m_s: f64,
    dof: usize,
) -> Result<Complex<f64>> {
    positive("wind speed", speed_m_s)?;
    let n = structure.dofs.len();
    if dof >= n {
        return Err(Error::input(
            "degree of freedom",
            format!("an index below {n}"),
            dof.to_string(),
        ));
    }
    let square = structure.stiffness[(dof, dof)] / structure.mass[(dof, dof)];
    let start = Complex::new(0.0, square.sqrt());
    settle(structure, model, speed_m_s, start)?.ok_or_else(|| {
        Error::Numerical(format!(
            "quasi-p-k: no mode settles and oscillates at {speed_m_s} m/s"
        ))
    })
}

/// An eigenvalue (rad/s, upper half plane) with its displacements (n): m, rad; of any size.
#[derive(Debug, Clone)]
pub(super) struct PkMode {
    pub(super) lambda: Complex<f64>,
    pub(super) shape: DVector<Complex<f64>>,
}

/// The mode at `speed_m_s` that the iteration reaches from `start`; `None` when it stops oscillating or does not settle.
pub(super) fn pk_mode(
    structure: &Structure,
    model: &dyn AerodynamicModel,
    speed_m_s: f64,
    start: &PkMode,
) -> Result<Option<PkMode>> {
    let Some(lambda) = settle(structure, model, speed_m_s, start.lambda)? else {
        return Ok(None);
    };
    let n = structure.dofs.len();
    let vector = eigenvector(&frozen(structure, model, speed_m_s, lambda.im)?, lambda)?;
    let shape = vector.rows(0, n).into_owned();
    Ok(Some(PkMode { lambda, shape }))
}

fn settle(
    structure: &Structure,
    model: &dyn AerodynamicModel,
    speed_m_s: f64,
    start: Complex<f64>,
) -> Result<Option<Complex<f64>>> {
    let mut lambda = start;
    for _ in 0..MAX_ROUNDS {
        let next = eigenvalues(&frozen(structure, model, speed_m_s, lambda.im)?)?
            .into_iter()
            .filter(|z| z.im > 1e-6 * z.norm())
            .min_by(|a, b| (a - lambda).norm().total_cmp(&(b - lambda).norm()));
        let Some(next) = next else { return Ok(None) };
        if (next - lambda).norm() <= TOLERANCE * next.norm() {
            return Ok(Some(next));
        }
        lambda = next;
    }
    Ok(None)
}

/// State matrix of `[q, q̇]` with the forces frozen at one frequency.
fn frozen(
    s: &Structure,
    model: &dyn AerodynamicModel,
    speed: f64,
    omega: f64,
) -> Result<DMatrix<f64>> {
    let k = ReducedFrequency::from_circular(omega, s.width_m, speed);
    let force = s.to_physical(&model.transfer(k)?)
        * Complex::from(0.5 * s.air_density_kg_m3 * speed * speed);
    let inverse = s
        .mass
        .clone()
        .try_inverse()
        .ok_or_else(|| Error::Numerical("quasi-p-k: a degree of freedom has no mass".into()))?;
    let n = s.dofs.len();
    let mut a = DMatrix::zeros(2 * n, 2 * n);
    a.view_mut((0, n), (n, n)).fill_with_identity();
    a.view_mut((n, 0), (n, n))
        .copy_from(&(&inverse * (force.map(|z| z.re) - &s.stiffness)));
    a.view_mut((n, n), (n, n))
        .copy_from(&(inverse * (force.map(|z| z.im / omega) - &s.damping)));
    Ok(a)
}
