//! Onset speed as a function of the parameters of a model: its gradient by the sensitivities of an eigenvalue, and
//! the onset itself by following the same eigenvalue.
//!
//! For a simple eigenvalue `λ` of the state matrix `A(V, θ)` with right and left vectors `v`, `u`,
//! `dλ = uᴴ dA v / uᴴ v` (Murthy & Haftka, "Derivatives of eigenvalues and eigenvectors of a general complex matrix",
//! IJNME 26, 1988). At the onset `Re λ = 0`, so `dV_F/dθ = −Re(∂λ/∂θ)/Re(∂λ/∂V)`.

use super::coefficients::CoefficientUncertainty;
use crate::aeroelastic::{CoupledSection, CoupledSystem};
use crate::error::{Error, Result};
use crate::section::Structure;
use crate::state_space::{complex, eigenvector};
use nalgebra::{Complex, DMatrix, DVector};

/// Relative step of the difference of state matrices.
const STEP: f64 = 1e-6;
/// Secant steps to a zero of the growth rate.
const MAX_STEPS: usize = 40;
/// Relative size of the last secant step.
const TOLERANCE: f64 = 1e-10;
/// An onset this far from the estimate, relatively, is looked for afresh.
const REACH: f64 = 0.5;

/// The section with the model that the parameters make.
///
/// # Errors
/// Parameters that make no model, or a model that cannot be coupled.
fn section_at(
    structure: &Structure,
    estimate: &CoefficientUncertainty,
    values: &[f64],
) -> Result<CoupledSection> {
    CoupledSection::with_model(structure, &estimate.model_at(values)?)
}

/// Gradient of the onset speed (m/s) with respect to the parameters.
///
/// # Errors
/// [`Error::Numerical`] when the growth rate does not cross zero with speed.
pub(crate) fn onset_gradient(
    estimate: &CoefficientUncertainty,
    structure: &Structure,
    (speed_m_s, omega): (f64, f64),
) -> Result<Vec<f64>> {
    let values = estimate.values();
    let section = section_at(structure, estimate, &values)?;
    let start = Complex::new(0.0, omega);
    let lambda = nearest(&section.at(speed_m_s)?, start)?;
    let h = STEP * speed_m_s;
    let ahead = nearest(&section.at(speed_m_s + h)?, lambda)?;
    let behind = nearest(&section.at(speed_m_s - h)?, lambda)?;
    let with_speed = (ahead.re - behind.re) / (2.0 * h);
    if with_speed == 0.0 {
        return Err(Error::Numerical(
            "onset sensitivity: the growth rate does not change with wind speed".into(),
        ));
    }
    let here = section.at(speed_m_s)?;
    let mu = here.matrix_eigenvalue(lambda);
    let right = eigenvector(here.state_matrix(), mu)?;
    let left = eigenvector(&here.state_matrix().transpose(), mu)?;
    // the transposed matrix has the conjugate of the left vector, so no conjugation here
    let scale = bilinear(
        &left,
        &complex(&DMatrix::identity(right.len(), right.len())),
        &right,
    );
    let matrix_at = |p: usize, step: f64| -> Result<DMatrix<f64>> {
        let mut moved = values.clone();
        moved[p] += step;
        let section = section_at(structure, estimate, &moved)?;
        Ok(section.at(speed_m_s)?.state_matrix().clone())
    };
    (0..values.len())
        .map(|p| {
            let step = STEP * values[p].abs().max(1e-2);
            let change = (matrix_at(p, step)? - matrix_at(p, -step)?) / (2.0 * step);
            let slope = bilinear(&left, &complex(&change), &right) / scale;
            Ok(-rate_change(&here, mu, slope).re / with_speed)
        })
        .collect()
}

/// `xᵀ m y`.
fn bilinear(
    x: &DVector<Complex<f64>>,
    m: &DMatrix<Complex<f64>>,
    y: &DVector<Complex<f64>>,
) -> Complex<f64> {
    x.iter().zip((m * y).iter()).map(|(a, b)| a * b).sum()
}

/// Change of the continuous-time eigenvalue for a change of that of the state matrix.
fn rate_change(system: &CoupledSystem, mu: Complex<f64>, change: Complex<f64>) -> Complex<f64> {
    match system {
        CoupledSystem::Continuous(_) => change,
        CoupledSystem::Sampled(s) => change / (mu * s.time.step),
    }
}

/// The eigenvalue nearest to `target`, rad/s.
fn nearest(system: &CoupledSystem, target: Complex<f64>) -> Result<Complex<f64>> {
    system
        .eigenvalues()?
        .into_iter()
        .min_by(|a, b| (a - target).norm().total_cmp(&(b - target).norm()))
        .ok_or_else(|| Error::Numerical("onset: no eigenvalues".into()))
}

/// Onset speed near a known one: the zero of the growth rate of the same eigenvalue, by secants. `None` when it does not
/// settle or ends up far away.
pub(super) fn onset_nearby(
    section: &CoupledSection,
    (speed_m_s, omega): (f64, f64),
) -> Result<Option<f64>> {
    let mut followed = Complex::new(0.0, omega);
    let (mut v0, mut v1) = (speed_m_s, speed_m_s * 1.001);
    followed = nearest(&section.at(v0)?, followed)?;
    let mut f0 = followed.re;
    for _ in 0..MAX_STEPS {
        followed = nearest(&section.at(v1)?, followed)?;
        let f1 = followed.re;
        if f1 == f0 {
            return Ok((f1 == 0.0).then_some(v1));
        }
        let next = v1 - f1 * (v1 - v0) / (f1 - f0);
        if !(next.is_finite() && (next / speed_m_s - 1.0).abs() < REACH) {
            return Ok(None);
        }
        if (next - v1).abs() <= TOLERANCE * v1 {
            return Ok(Some(next));
        }
        (v0, f0, v1) = (v1, f1, next);
    }
    Ok(None)
}
