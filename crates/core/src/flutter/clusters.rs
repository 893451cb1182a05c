//! Modes that share a frequency, or nearly: their shapes are those of any mixture, and turn at once with the first breath of
//! wind. What goes on smoothly is the space that they span, so they are corrected and recognised together.

use super::columns::Shape;
use super::following::{MIN_ASSURANCE, Mode, assurance};
use super::modal_characteristic::AtSpeed;
use crate::state_space::Complex64;
use crate::threads;
use nalgebra::DMatrix;
use nalgebra::linalg::Schur;

/// An eigenvalue and its shape.
pub(super) type Root = (Complex64, Shape);

/// Modal assurance above which a mode is the one before, whatever lies near.
const SAME_SHAPE: f64 = 0.99;
/// Modes closer than this, relatively, are one cluster.
const CLOSE: f64 = 3e-3;
/// Rounds of the correction of a cluster before each mode is corrected by itself, which then converges quadratically.
const ROUNDS: usize = 3;
/// Distance from the eigenvalues at which a cluster is looked at, over their spread; of one frequency, relative to it.
const STAND_OFF: (f64, f64) = (0.5, 1e-7);
/// Relative difference of the eigenvalues of the small matrix up to which it is rounding.
const ONE_FREQUENCY: f64 = 1e-6;

/// The modes of a bridge from their predictions and their shapes before: `None` for one that is lost or has become another.
pub(super) fn by_shapes(
    problem: &AtSpeed<'_>,
    predicted: &[Complex64],
    before: &[Mode],
) -> Vec<Option<Root>> {
    let mut roots = each_alone(problem, predicted, before);
    for cluster in clusters(predicted) {
        if cluster.len() == 1 || cluster.iter().all(|i| surely(&roots[*i], &before[*i])) {
            continue;
        }
        let near: Vec<_> = cluster.iter().map(|i| predicted[*i]).collect();
        let old: Vec<_> = cluster.iter().map(|i| &before[*i]).collect();
        let mut found = corrected(problem, &near, &old).into_iter().flatten();
        for i in cluster {
            roots[i] = found.next();
        }
    }
    roots
}

/// Every mode corrected by itself, unless it has become another.
fn each_alone(
    problem: &AtSpeed<'_>,
    predicted: &[Complex64],
    before: &[Mode],
) -> Vec<Option<Root>> {
    let alone = |i: usize| {
        let old = &before[i].shape;
        let root = problem.solve(predicted[i], old, Some(apart(predicted, i)));
        root.filter(|(_, shape)| assurance(shape, old) >= MIN_ASSURANCE)
    };
    threads::numbered(before.len(), true, alone)
}

/// How far an eigenvalue is from the nearest of the others.
fn apart(eigenvalues: &[Complex64], i: usize) -> f64 {
    let others = (0..eigenvalues.len()).filter(|j| *j != i);
    let distances = others.map(|j| (eigenvalues[j] - eigenvalues[i]).norm());
    distances.fold(f64::INFINITY, f64::min)
}

/// Whether a mode that has neighbours has hardly changed its shape, so that it needs no look at them.
fn surely(root: &Option<Root>, before: &Mode) -> bool {
    let kept = |(_, shape): &Root| assurance(shape, &before.shape) >= SAME_SHAPE;
    root.as_ref().is_some_and(kept)
}

/// Places of modes by clusters, from their eigenvalues; most are alone.
fn clusters(eigenvalues: &[Complex64]) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..eigenvalues.len()).collect();
    order.sort_by(|a, b| eigenvalues[*a].im.total_cmp(&eigenvalues[*b].im));
    let mut all: Vec<Vec<usize>> = Vec::new();
    for i in order {
        let near =
            |j: &usize| (eigenvalues[*j] - eigenvalues[i]).norm() < CLOSE * eigenvalues[i].norm();
        match all.last_mut().filter(|cluster| cluster.iter().any(near)) {
            Some(cluster) => cluster.push(i),
            None => all.push(vec![i]),
        }
    }
    all
}

/// The modes of a cluster at a wind speed, from eigenvalues that were predicted and the modes before, in their order;
/// `None` where the space that they span has turned, or they cannot be told apart.
fn corrected(
    problem: &AtSpeed<'_>,
    predicted: &[Complex64],
    before: &[&Mode],
) -> Option<Vec<Root>> {
    let old = DMatrix::from_columns(&before.iter().map(|m| m.shape.clone()).collect::<Vec<_>>());
    let space = old.qr().q();
    let mut found: Vec<Root> = Vec::new();
    let (mut at, mut basis) = (predicted.to_vec(), space.clone());
    for _ in 0..ROUNDS {
        found = split(problem, &at, &basis)?;
        at = found.iter().map(|r| r.0).collect();
        let shapes: Vec<Shape> = found.iter().map(|r| r.1.clone()).collect();
        basis = DMatrix::from_columns(&shapes).qr().q();
    }
    let each = found.iter().enumerate().map(|(i, (lambda, shape))| {
        let apart = apart(&at, i);
        problem.solve(*lambda, shape, Some(apart))
    });
    let mut roots = each.collect::<Option<Vec<Root>>>()?;
    let inside = |shape: &Shape| (space.adjoint() * shape).norm_squared() / shape.norm_squared();
    if roots.iter().any(|(_, shape)| inside(shape) < MIN_ASSURANCE) {
        return None;
    }
    // of a mixture each keeps the name that it resembles most
    let named = before.iter().map(|mode| {
        let likest = (0..roots.len()).max_by(|a, b| {
            let like = |i: usize| assurance(&roots[i].1, &mode.shape);
            like(*a).total_cmp(&like(*b))
        })?;
        Some(roots.swap_remove(likest))
    });
    named.collect()
}

/// One step of inverse iteration for a whole space: `D(λ) W = D'(λ) U`, in which `UᴴW` has the eigenvalues `1/(λ − λᵢ)`.
fn split(
    problem: &AtSpeed<'_>,
    near: &[Complex64],
    basis: &DMatrix<Complex64>,
) -> Option<Vec<Root>> {
    let count = near.len();
    let mean = near.iter().sum::<Complex64>() / count as f64;
    let spread = near.iter().map(|z| (z - mean).norm()).fold(0.0, f64::max);
    let from = mean + STAND_OFF.0 * spread + STAND_OFF.1 * mean.norm();
    let moved = problem.inverse_iteration(from, basis)?;
    let small = basis.adjoint() * &moved;
    let middle = small.trace() / count as f64;
    let apart = &small - DMatrix::identity(count, count) * middle;
    if apart.norm() < ONE_FREQUENCY * middle.norm() {
        // any shapes of the space will do
        let shapes = basis.column_iter().map(|c| c.into_owned());
        return Some(shapes.map(|s| (from - middle.inv(), s)).collect());
    }
    let values = Schur::try_new(small.clone(), f64::EPSILON, 0)?.eigenvalues()?;
    let root = |value: &Complex64| {
        let shifted = &small - DMatrix::identity(count, count) * *value;
        let v = shifted.try_svd(false, true, f64::EPSILON, 0)?.v_t?;
        // the right vector of the smallest singular value, which stands last
        let mixture = v.row(count - 1).adjoint();
        let shape = &moved * mixture;
        Some((from - value.inv(), shape.normalize()))
    };
    values.iter().map(root).collect()
}
