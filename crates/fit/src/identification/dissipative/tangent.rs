//! The directions that active constraints leave free.

use nalgebra::{DMatrix, DVector};

/// Part of a gradient outside the others below which it adds no direction.
const RANK_TOLERANCE: f64 = 1e-8;

/// One transfer function of a linear fit without constraints: its coefficients are `values + spread · u` with the free
/// numbers `u` from `at` on, in units in which the joint objective grows by `‖u‖²`.
#[derive(Debug, Clone)]
pub(crate) struct LinearEntry {
    pub values: Vec<f64>,
    pub spread: DMatrix<f64>,
    pub at: usize,
}

impl LinearEntry {
    /// Coefficients at given free numbers.
    pub(crate) fn coefficients(&self, u: &DVector<f64>) -> Vec<f64> {
        let moved = &self.spread * u.rows(self.at, self.spread.ncols());
        self.values.iter().zip(&moved).map(|(v, d)| v + d).collect()
    }

    pub(super) fn end(&self) -> usize {
        self.at + self.spread.ncols()
    }
}

/// Takes away from a vector what lies along orthonormal directions. Twice is enough (Kahan): the first time leaves rounding
/// errors of the cancelled part.
pub(super) fn take_away(vector: &mut DVector<f64>, directions: &[DVector<f64>]) {
    for q in directions {
        let along = q.dot(vector);
        vector.axpy(-along, q, 1.0);
    }
}

/// Orthonormal directions that active constraints take.
#[derive(Debug, Clone)]
pub(crate) struct Tangent {
    taken: Vec<DVector<f64>>,
}

impl Tangent {
    /// From the gradients of the constraints, in one scale for all unknowns.
    pub(crate) fn new(gradients: impl Iterator<Item = DVector<f64>>) -> Self {
        let mut taken: Vec<DVector<f64>> = Vec::new();
        for mut gradient in gradients {
            let norm = gradient.norm();
            take_away(&mut gradient, &taken);
            take_away(&mut gradient, &taken);
            let left = gradient.norm();
            if left > RANK_TOLERANCE * norm {
                taken.push(gradient / left);
            }
        }
        Self { taken }
    }

    /// Number of directions that are taken.
    pub(crate) fn count(&self) -> usize {
        self.taken.len()
    }

    /// Orthonormal basis of the directions that are left, n×(n − taken).
    pub(crate) fn basis(&self, n: usize) -> DMatrix<f64> {
        let mut left: Vec<DVector<f64>> = Vec::new();
        // the unit vectors that stick out furthest come first
        let out = |i: usize| 1.0 - self.taken.iter().map(|q| q[i] * q[i]).sum::<f64>();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|a, b| out(*b).total_cmp(&out(*a)));
        for i in order {
            if left.len() + self.count() == n {
                break;
            }
            let mut unit = DVector::zeros(n);
            unit[i] = 1.0;
            for _ in 0..2 {
                take_away(&mut unit, &self.taken);
                take_away(&mut unit, &left);
            }
            let norm = unit.norm();
            if norm > 1e-3 {
                left.push(unit / norm);
            }
        }
        DMatrix::from_fn(n, left.len(), |i, j| left[j][i])
    }

    /// Covariance of the coefficients of one transfer function, from how many numbers are free in each without constraints and
    /// their variance: with the projector `P`, that of `P u`.
    pub(crate) fn covariance(
        &self,
        entry: &LinearEntry,
        free: impl Iterator<Item = (usize, f64)>,
    ) -> DMatrix<f64> {
        let each = free.flat_map(|(count, variance)| std::iter::repeat_n(variance, count));
        let variances: Vec<f64> = each.collect();
        let width = entry.spread.ncols();
        let mut rows = DMatrix::zeros(width, variances.len());
        for m in 0..width {
            rows[(m, entry.at + m)] = 1.0;
            for q in &self.taken {
                for (c, x) in q.iter().enumerate() {
                    rows[(m, c)] -= q[entry.at + m] * x;
                }
            }
        }
        let spread = &entry.spread * rows;
        let weighted = DMatrix::from_fn(spread.nrows(), spread.ncols(), |i, c| {
            spread[(i, c)] * variances[c]
        });
        weighted * spread.transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_orthonormal_and_across() {
        let a = DVector::from_vec(vec![1.0, 2.0, 0.0, -1.0]);
        let b = DVector::from_vec(vec![0.0, 1.0, 1.0, 0.0]);
        let tangent = Tangent::new([a.clone(), b.clone(), &a * 2.0 - &b].into_iter());
        assert_eq!(tangent.count(), 2);
        let basis = tangent.basis(4);
        assert_eq!(basis.ncols(), 2);
        assert!((basis.transpose() * &basis - DMatrix::identity(2, 2)).amax() < 1e-15);
        assert!((basis.transpose() * a).amax() < 1e-15 && (basis.transpose() * b).amax() < 1e-15);
    }
}
