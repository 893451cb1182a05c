//! What linear equations leave free: `x = x₀ + z` with `z` across all their gradients.

use nalgebra::{DMatrix, DVector};

/// Coefficients as a function of free numbers: `values + spread · u` with the numbers `u` from `at` on. Those of one transfer
/// function without constraints are in units in which the joint objective grows by `‖u‖²`.
#[derive(Debug, Clone)]
pub(crate) struct AffineMap {
    pub values: Vec<f64>,
    pub spread: DMatrix<f64>,
    pub at: usize,
}

impl AffineMap {
    /// Coefficients at given free numbers.
    pub(crate) fn coefficients(&self, u: &DVector<f64>) -> Vec<f64> {
        let moved = &self.spread * u.rows(self.at, self.spread.ncols());
        self.values.iter().zip(&moved).map(|(v, d)| v + d).collect()
    }

    /// Adds the gradient of `weight · row · coefficients` in the free numbers.
    pub(crate) fn add_gradient(&self, row: &[f64], weight: f64, to: &mut DVector<f64>) {
        let row = DVector::from_column_slice(row);
        let own = self.spread.tr_mul(&row) * weight;
        let mut place = to.rows_mut(self.at, own.len());
        place += own;
    }

    /// Some of the coefficients, each times a factor.
    pub(crate) fn picked(&self, places: &[(usize, f64)]) -> Self {
        let values = places.iter().map(|&(c, factor)| factor * self.values[c]);
        Self {
            values: values.collect(),
            spread: DMatrix::from_fn(places.len(), self.spread.ncols(), |r, m| {
                places[r].1 * self.spread[(places[r].0, m)]
            }),
            at: self.at,
        }
    }

    /// The first place behind its free numbers.
    pub(crate) fn end(&self) -> usize {
        self.at + self.spread.ncols()
    }
}

/// The numbers that satisfy linear equations.
#[derive(Debug, Clone)]
pub(crate) struct AffineSpace {
    /// The shortest of them.
    pub start: DVector<f64>,
    /// Orthonormal directions, those of the equations.
    taken: Vec<DVector<f64>>,
}

impl AffineSpace {
    /// All `n` numbers, without equations.
    pub(crate) fn whole(n: usize) -> Self {
        Self {
            start: DVector::zeros(n),
            taken: Vec::new(),
        }
    }

    /// Adds the equation `gradient · x = target`; `false`, and nothing, where no more than the part `tolerance` of the gradient
    /// lies outside those before it.
    pub(crate) fn hold(&mut self, gradient: &DVector<f64>, target: f64, tolerance: f64) -> bool {
        let mut across = gradient.clone();
        // twice is enough (Kahan): the first time leaves rounding errors of the cancelled part
        self.project(&mut across);
        self.project(&mut across);
        let left = across.norm();
        let adds = left > tolerance * gradient.norm();
        if adds {
            across.unscale_mut(left);
            let short = target - gradient.dot(&self.start);
            self.start.axpy(short / left, &across, 1.0);
            self.taken.push(across);
        }
        adds
    }

    /// Takes away from a vector what lies along the gradients of the equations.
    pub(crate) fn project(&self, vector: &mut DVector<f64>) {
        project_out(vector, &self.taken);
    }

    /// Orthonormal basis of the directions that are left, n×(n − taken).
    pub(crate) fn basis(&self) -> DMatrix<f64> {
        let n = self.start.len();
        if self.taken.is_empty() {
            return DMatrix::identity(n, n);
        }
        let mut left: Vec<DVector<f64>> = Vec::new();
        // the unit vectors that stick out furthest come first
        let out = |i: usize| 1.0 - self.taken.iter().map(|q| q[i] * q[i]).sum::<f64>();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|a, b| out(*b).total_cmp(&out(*a)));
        for i in order {
            if left.len() + self.taken.len() == n {
                break;
            }
            let mut unit = unit(n, i);
            for _ in 0..2 {
                self.project(&mut unit);
                project_out(&mut unit, &left);
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
        entry: &AffineMap,
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

/// The unit vector along `i`.
pub(super) fn unit(n: usize, i: usize) -> DVector<f64> {
    DVector::from_fn(n, |row, _| f64::from(u8::from(row == i)))
}

fn project_out(vector: &mut DVector<f64>, directions: &[DVector<f64>]) {
    for q in directions {
        let along = q.dot(vector);
        vector.axpy(-along, q, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_orthonormal_and_across() {
        let a = DVector::from_vec(vec![1.0, 2.0, 0.0, -1.0]);
        let b = DVector::from_vec(vec![0.0, 1.0, 1.0, 0.0]);
        let mut space = AffineSpace::whole(4);
        assert!(space.hold(&a, 3.0, 1e-8) && space.hold(&b, -1.0, 1e-8));
        assert!(!space.hold(&(&a * 2.0 - &b), 7.0, 1e-8));
        assert!((a.dot(&space.start) - 3.0).abs() < 1e-14);
        assert!((b.dot(&space.start) + 1.0).abs() < 1e-14);
        let basis = space.basis();
        assert_eq!(basis.ncols(), 2);
        assert!((basis.transpose() * &basis - DMatrix::identity(2, 2)).amax() < 1e-15);
        assert!((basis.transpose() * a).amax() < 1e-15 && (basis.transpose() * b).amax() < 1e-15);
    }
}
