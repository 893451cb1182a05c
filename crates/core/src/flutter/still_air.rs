//! Modes of a structure in still air, where following them over wind speed begins.

use super::following::{Mode, dimensionless, oscillates};
use crate::aerodynamics::Realization;
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::section::Structure;
use crate::state_space::{eigenvalues, eigenvector, first_order, is_diagonal};
use nalgebra::{Complex, DMatrix, DVector, SymmetricEigen};

/// Sampled systems start where this many samples fall into one period, below which frequencies would alias.
const SAMPLES_PER_PERIOD: f64 = 5.0;
/// Samples in a period that tell a frequency from others: two, and a tenth for what slow wind changes.
const TOLD_APART: f64 = 2.2;
/// Relative difference of eigenvalues that is rounding.
const EQUAL: f64 = 1e-8;

/// The modes of the mass-normalised coordinates of a bridge, by the symmetric problem of the undamped structure: modes of one
/// frequency, of which bridges have some, keep shapes of their own. The damping is that of each mode by itself; the first step
/// corrects it. Where dampers couple them, see [`coupled_modes`]. `None` for a section and for sampled models.
pub(super) fn modes_of_many(section: &CoupledSection) -> Option<Vec<Mode>> {
    let s = section.structure();
    let sampled = matches!(section.aerodynamics(), Realization::Discrete(_));
    if !s.is_modal() || sampled || s.stiffness.diagonal().min() <= 0.0 {
        return None;
    }
    if is_coupled(s) {
        return coupled_modes(s, section.inverse_mass()).ok();
    }
    let n = s.dofs.len();
    let root: Vec<f64> = s.stiffness.diagonal().iter().map(|k| k.sqrt()).collect();
    let inverse = section.inverse_mass();
    let symmetric = DMatrix::from_fn(n, n, |i, j| {
        0.5 * (inverse[(i, j)] + inverse[(j, i)]) * root[i] * root[j]
    });
    let natural = SymmetricEigen::new(symmetric);
    let mut modes = Vec::with_capacity(n);
    let vectors = natural.eigenvectors.column_iter();
    for (square, vector) in natural.eigenvalues.iter().zip(vectors) {
        let shape = DVector::from_fn(n, |i, _| vector[i] / root[i]);
        let decay = 0.5 * square * shape.dot(&(&s.damping * &shape));
        let lambda = Complex::new(-decay, (square - decay * decay).max(0.0).sqrt());
        if !oscillates(&lambda) {
            return None;
        }
        let shape = shape.normalize().map(Complex::from);
        modes.push(Mode::new(0, lambda, shape));
    }
    order_by_dof(section, &mut modes);
    Some(modes)
}

/// Whether springs, dashpots or masses couple the coordinates of a structure.
pub(super) fn is_coupled(s: &Structure) -> bool {
    ![&s.mass, &s.damping, &s.stiffness]
        .into_iter()
        .all(is_diagonal)
}

/// The modes of such a structure that oscillate, by the eigenvalues of its states. Equal eigenvalues, as of dampers that are alike,
/// have as many shapes as there are of them: what `λ²M + λR + K` moves least. Each mode is named by the coordinate that it moves most
/// among those that no other mode moves more.
pub(super) fn coupled_modes(s: &Structure, inverse_mass: &DMatrix<f64>) -> Result<Vec<Mode>> {
    let n = s.dofs.len();
    let a = first_order(inverse_mass, &-&s.stiffness, &-&s.damping);
    let mut all: Vec<_> = eigenvalues(&a)?.into_iter().filter(oscillates).collect();
    all.sort_by(|x, y| x.im.total_cmp(&y.im));
    let mass = inverse_mass.clone().try_inverse().unwrap_or_default();
    let mut modes: Vec<Mode> = Vec::with_capacity(n);
    for lambda in &all {
        let equal = |other: &Complex<f64>| (other - lambda).norm() <= EQUAL * lambda.norm();
        // places of this one and of those equal to it, before which the same have been taken
        let count = all.iter().filter(|z| equal(z)).count();
        let taken = modes.iter().filter(|m| equal(&m.lambda)).count();
        let shape = if count == 1 {
            eigenvector(&a, *lambda)?.rows(0, n).into_owned()
        } else {
            let of = |m: &DMatrix<f64>, factor: Complex<f64>| m.map(|x| factor * x);
            let resistance = of(&mass, lambda * lambda)
                + of(&s.damping, *lambda)
                + of(&s.stiffness, Complex::from(1.0));
            let v_t = resistance.svd(false, true).v_t.unwrap_or_default();
            v_t.row(n - 1 - taken).adjoint()
        };
        modes.push(Mode::new(0, *lambda, shape.normalize()));
    }
    let mut free: Vec<usize> = (0..n).collect();
    let mut named = Vec::with_capacity(modes.len());
    while !modes.is_empty() {
        let pairs = (0..modes.len()).flat_map(|m| free.iter().map(move |i| (m, *i)));
        let share = |p: &(usize, usize)| modes[p.0].shape[p.1].norm();
        let best = pairs.max_by(|p, q| share(p).total_cmp(&share(q)));
        let (m, branch) = best.unwrap_or_default();
        free.retain(|i| *i != branch);
        named.push(Mode {
            branch,
            ..modes.swap_remove(m)
        });
    }
    named.sort_by_key(|m| m.branch);
    Ok(named)
}

/// Modes of the structure with its added mass in still air, in the order of the degrees of freedom they move most.
pub(super) fn natural_modes(section: &CoupledSection) -> Result<Vec<Mode>> {
    let s = section.structure();
    let n = s.dofs.len();
    let a = section.structure_alone().a;
    let mut modes = Vec::with_capacity(n);
    for lambda in eigenvalues(&a)?.into_iter().filter(|z| z.im > 0.0) {
        let vector = eigenvector(&a, lambda)?;
        let shape = vector.rows(0, n).into_owned();
        let size = dimensionless(section.structure(), &shape).norm();
        modes.push(Mode::new(0, lambda, shape.unscale(size)));
    }
    if modes.len() != n {
        return Err(Error::Numerical(
            "mode tracking: a degree of freedom does not oscillate in still air".into(),
        ));
    }
    order_by_dof(section, &mut modes);
    Ok(modes)
}

/// Puts the modes into the order of the degrees of freedom they move most.
fn order_by_dof(section: &CoupledSection, modes: &mut [Mode]) {
    let n = modes.len();
    for dof in 0..n {
        let share = |m: &usize| dimensionless(section.structure(), &modes[*m].shape)[dof].norm();
        let strongest = (dof..n).max_by(|i, j| share(i).total_cmp(&share(j)));
        modes.swap(dof, strongest.unwrap_or(dof));
        modes[dof].branch = dof;
    }
}

/// Lowest speed at which the system can be judged: still air, or for the sampled system the speed with enough samples a
/// period.
pub(super) fn lowest_speed(section: &CoupledSection) -> Result<f64> {
    // no sampled system has these, and all of them oscillate
    if modes_of_many(section).is_some() {
        return Ok(0.0);
    }
    Ok(start_speed(section, &natural_modes(section)?))
}

/// Wind speed, m/s, below which a sample of the sampled system lasts half a period of its fastest mode in still air, so that its
/// eigenvalues are those of other motions; 0 for other systems.
///
/// # Errors
/// Where the modes in still air are not found.
pub fn aliased_below(section: &CoupledSection) -> Result<f64> {
    Ok(lowest_speed(section)? * TOLD_APART / SAMPLES_PER_PERIOD)
}

pub(super) fn start_speed(section: &CoupledSection, modes: &[Mode]) -> f64 {
    let Realization::Discrete(d) = section.aerodynamics() else {
        return 0.0;
    };
    let highest_hz = modes.iter().map(|m| m.lambda.im).fold(0.0, f64::max) / std::f64::consts::TAU;
    SAMPLES_PER_PERIOD * highest_hz * d.delta_s * section.structure().width_m
}
