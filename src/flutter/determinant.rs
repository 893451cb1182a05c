//! Onset for any `G(K)`: the impedance is singular at a real `(V, ω)`.
//!
//! At a given `K` the speed follows from the frequency, `V = ωB/K`, and the impedance becomes a quadratic eigenvalue
//! problem `ω² (M + ½ρB²/K² P(G)) − iωR − K_s = 0`. Its roots are followed over `K`; where one becomes real, the
//! section flutters (Theodorsen's method with viscous damping).

use super::onset::{FlutterSearch, Onset, OnsetMethod, choose};
use super::search::root;
use super::tracking::branch_name;
use crate::aerodynamics::{AerodynamicModel, Realization, TransferMatrix};
use crate::error::{Error, Result, positive};
use crate::section::{Dof, Structure};
use crate::state_space::complex;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::{Complex, DMatrix, DVector, Schur};

/// Reduced frequencies at which the roots are looked at, logarithmically spaced over the range.
const GRID: usize = 600;
const MAX_SCHUR_SWEEPS: usize = 600;
/// Relative step of the differences for the damping slope: truncation 1e-10 against rounding 1e-11.
const SLOPE_STEP: f64 = 1e-5;

/// Impedance `−ω²M + iωR + K − ½ρV² P(G(ωB/V))` at speed (m/s) and circular frequency (rad/s), n×n, per unit length.
///
/// # Errors
/// Those of [`AerodynamicModel::transfer`].
pub fn impedance(
    structure: &Structure,
    model: &dyn AerodynamicModel,
    speed_m_s: f64,
    omega: f64,
) -> Result<DMatrix<Complex<f64>>> {
    let k = ReducedFrequency::from_circular(omega, structure.width_m, speed_m_s);
    let force = structure.to_physical(&model.transfer(k)?);
    let pressure = 0.5 * structure.air_density_kg_m3 * speed_m_s * speed_m_s;
    Ok(complex(&structure.mass) * Complex::new(-omega * omega, 0.0)
        + complex(&structure.damping) * Complex::new(0.0, omega)
        + complex(&structure.stiffness)
        - force * Complex::new(pressure, 0.0))
}

/// Lowest speed up to `speed_max_m_s` at which the section flutters at a reduced frequency inside `range`.
///
/// Says nothing outside `range`: a table cannot be searched where it was not measured.
///
/// # Errors
/// [`Error::Input`] for an empty range; those of the model; [`Error::Numerical`] when the roots cannot be computed.
pub fn determinant_onset(
    name: &str,
    structure: &Structure,
    model: &dyn AerodynamicModel,
    range: ReducedFrequencyRange,
    speed_max_m_s: f64,
) -> Result<FlutterSearch> {
    let k_min = positive("range of reduced frequencies", range.min.full_width())?;
    let k_max = positive("range of reduced frequencies", range.max.full_width())?;
    let problem = Problem { structure, model };
    let at = |i: usize| {
        // both ends exactly, so that a table is not asked beyond its last point
        match i {
            0 => k_max,
            i if i == GRID => k_min,
            i => k_max * (k_min / k_max).powf(i as f64 / GRID as f64),
        }
    };
    let mut crossings = Vec::new();
    // at the highest K the speeds are lowest: the roots are in the order of the natural frequencies
    let mut roots = problem.frequencies(at(0))?;
    roots.sort_by(|a, b| a.re.total_cmp(&b.re));
    let branches = structure.dofs_by_frequency();
    for i in 1..=GRID {
        let current = problem.frequencies(at(i))?;
        for (root, dof) in roots.iter_mut().zip(&branches) {
            let Some(after) = nearest(*root, &current) else {
                continue;
            };
            if root.im > 0.0 && after.im <= 0.0 {
                let (from, to) = ((at(i - 1), *root), (at(i), after));
                let onset = problem.refine(name, from, to, branch_name(*dof))?;
                if onset.speed_m_s <= speed_max_m_s {
                    crossings.push(onset);
                }
            }
            *root = after;
        }
    }
    // at the lowest K each root has come to a speed of its own; beyond the slowest nothing was looked at
    let searched = roots
        .iter()
        .map(|root| root.re * structure.width_m / k_min)
        .fold(speed_max_m_s, f64::min);
    Ok(choose(crossings, Some(range), searched))
}

fn nearest(target: Complex<f64>, among: &[Complex<f64>]) -> Option<Complex<f64>> {
    among
        .iter()
        .copied()
        .min_by(|a, b| (a - target).norm().total_cmp(&(b - target).norm()))
}

struct Problem<'a> {
    structure: &'a Structure,
    model: &'a dyn AerodynamicModel,
}

impl Problem<'_> {
    /// Roots `ω` with positive real part at the reduced frequency `k`, rad/s.
    fn frequencies(&self, k: f64) -> Result<Vec<Complex<f64>>> {
        let s = self.structure;
        let n = s.dofs.len();
        let g = self.model.transfer(ReducedFrequency::from_full_width(k))?;
        let air = 0.5 * s.air_density_kg_m3 * (s.width_m / k).powi(2);
        let mass = complex(&s.mass) + s.to_physical(&g) * Complex::new(air, 0.0);
        let inverse = mass
            .try_inverse()
            .ok_or_else(|| Error::Numerical(format!("determinant: singular at K = {k}")))?;
        let mut companion = DMatrix::zeros(2 * n, 2 * n);
        companion.view_mut((0, n), (n, n)).fill_with_identity();
        companion
            .view_mut((n, 0), (n, n))
            .copy_from(&(&inverse * complex(&s.stiffness)));
        companion
            .view_mut((n, n), (n, n))
            .copy_from(&(inverse * complex(&s.damping) * Complex::i()));
        if !companion
            .iter()
            .all(|z| z.re.is_finite() && z.im.is_finite())
        {
            return Err(Error::Numerical(format!(
                "determinant: the model is not finite at K = {k}"
            )));
        }
        let (_, triangular) = Schur::try_new(companion, f64::EPSILON, MAX_SCHUR_SWEEPS)
            .ok_or_else(|| Error::Numerical(format!("determinant: no roots at K = {k}")))?
            .unpack();
        Ok(triangular
            .diagonal()
            .iter()
            .copied()
            .filter(|omega| omega.re > 0.0)
            .collect())
    }

    /// The reduced frequency at which the root becomes real, and the onset there.
    fn refine(
        &self,
        name: &str,
        before: (f64, Complex<f64>),
        after: (f64, Complex<f64>),
        branch: String,
    ) -> Result<Onset> {
        let root_at = |k: f64| -> Result<Complex<f64>> {
            // the roots move little over one cell of the grid: nearest to the straight line between its ends
            let share = (k - before.0) / (after.0 - before.0);
            let guess = before.1 + (after.1 - before.1) * share;
            nearest(guess, &self.frequencies(k)?)
                .ok_or_else(|| Error::Numerical(format!("determinant: no root at K = {k}")))
        };
        let k = root((before.0, -before.1.im), (after.0, -after.1.im), |k| {
            Ok(-root_at(k)?.im)
        })?;
        let omega = root_at(k)?.re;
        let s = self.structure;
        let speed = omega * s.width_m / k;
        let shape = null_vector(s, &impedance(s, self.model, speed, omega)?, omega)?;
        let (method, at) = (OnsetMethod::Determinant, (speed, omega));
        let mut onset = Onset::new(name, method, s, at, &shape, branch);
        onset.damping_slope_s_m = damping_slope(s, self.model, speed, omega);
        Ok(onset)
    }
}

/// `dζ/dV` (s/m) at an onset, from the determinant `d(V, ω)` of the impedance alone: with `λ = iω` on the axis,
/// `dλ/dV = −d_V/d_λ = −i d_V/d_ω` and `dζ/dV = −Re(dλ/dV)/ω`, central differences. `None` where the model does not
/// answer on both sides (a table at the end of its range).
pub(super) fn damping_slope(
    structure: &Structure,
    model: &dyn AerodynamicModel,
    speed_m_s: f64,
    omega: f64,
) -> Option<f64> {
    let determinant = |speed: f64, omega: f64| {
        let z = impedance(structure, model, speed, omega).ok()?;
        Some(z.determinant())
    };
    let h = SLOPE_STEP;
    let over_speed =
        determinant(speed_m_s * (1.0 + h), omega)? - determinant(speed_m_s * (1.0 - h), omega)?;
    let over_omega =
        determinant(speed_m_s, omega * (1.0 + h))? - determinant(speed_m_s, omega * (1.0 - h))?;
    let rate = Complex::new(0.0, -1.0) * (over_speed / speed_m_s) / (over_omega / omega);
    let slope = -rate.re / omega;
    slope.is_finite().then_some(slope)
}

/// Onset speed of one degree of freedom with the others locked, m/s.
pub(super) fn single_dof_onset(
    structure: &Structure,
    model: &dyn AerodynamicModel,
    dof: usize,
    range: ReducedFrequencyRange,
    speed_max_m_s: f64,
) -> Result<Option<f64>> {
    let locked = structure.only(&[structure.dofs[dof]]);
    let alone = OneDof { model, dof };
    let search = determinant_onset("", &locked, &alone, range, speed_max_m_s)?;
    Ok(search.onset().map(|o| o.speed_m_s))
}

/// One diagonal entry of a model.
struct OneDof<'a> {
    model: &'a dyn AerodynamicModel,
    dof: usize,
}

impl AerodynamicModel for OneDof<'_> {
    fn dofs(&self) -> &[Dof] {
        &self.model.dofs()[self.dof..=self.dof]
    }
    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let g = self.model.transfer(k)?;
        Ok(DMatrix::from_element(1, 1, g[(self.dof, self.dof)]))
    }
    fn realize(&self) -> Option<Realization> {
        None
    }
}

/// The motion (m, rad) that the impedance at `omega` resists least: the right singular vector of the smallest singular
/// value. Rows and columns are scaled by the root of the typical impedance of each degree of freedom, `K_ii + ω² M_ii`,
/// since heave and rotation have different units; a row by its own size would hide a degree of freedom that is alone.
pub(super) fn null_vector(
    structure: &Structure,
    impedance: &DMatrix<Complex<f64>>,
    omega: f64,
) -> Result<DVector<Complex<f64>>> {
    let scale = |i: usize| {
        let typical = structure.stiffness[(i, i)] + omega * omega * structure.mass[(i, i)];
        typical.sqrt().recip()
    };
    let n = impedance.nrows();
    let scaled = DMatrix::from_fn(n, n, |i, j| impedance[(i, j)] * (scale(i) * scale(j)));
    let singular = || Error::Numerical("determinant: no mode shape at the onset".into());
    let svd = scaled
        .try_svd(false, true, f64::EPSILON, MAX_SCHUR_SWEEPS)
        .ok_or_else(singular)?;
    let v_t = svd.v_t.ok_or_else(singular)?;
    let smallest = svd.singular_values.imin();
    let mut shape = v_t.row(smallest).adjoint();
    for (i, z) in shape.iter_mut().enumerate() {
        *z *= Complex::from(scale(i));
    }
    Ok(shape)
}
