//! The end of the tested range, as the data alone have it.

use nalgebra::{DMatrix, DVector, Dyn, SymmetricEigen};

/// What the fit that the data alone give says of one part of the motions at the end of the tested range.
pub(super) struct TestedRangeEnd {
    /// The size against which margins and tolerances are measured: that of `sym Im G/K`, which the data determine.
    pub size: f64,
    /// Its part that feeds energy in, positive semidefinite; zero for decks that are damped there.
    pub own: DMatrix<f64>,
    /// Eigenvalues and eigenvectors of the whole, where it feeds energy in.
    eigen: Option<SymmetricEigen<f64, Dyn>>,
}

impl TestedRangeEnd {
    /// Of the matrix `sym Im G/K` there.
    pub(super) fn new(matrix: DMatrix<f64>) -> Self {
        let n = matrix.nrows();
        let norm = matrix.norm();
        let eigen = SymmetricEigen::new(matrix);
        let grows = eigen.eigenvalues.iter().any(|value| *value > 0.0);
        let own = grows.then(|| {
            let mut positive = eigen.clone();
            positive.eigenvalues.apply(|value| *value = value.max(0.0));
            positive.recompose()
        });
        Self {
            size: if norm > 0.0 { norm } else { 1.0 },
            own: own.unwrap_or_else(|| DMatrix::zeros(n, n)),
            eigen: grows.then_some(eigen),
        }
    }

    /// Weights `W` with which a change `dS` of the whole matrix changes `vᵀ P v` by `Σ W ∘ dS`; none where nothing is fed in.
    ///
    /// Derivative of a function of a symmetric matrix by divided differences (Daleckii & Krein, 1965).
    pub(super) fn change(&self, v: &DVector<f64>) -> Option<DMatrix<f64>> {
        let eigen = self.eigen.as_ref()?;
        let along = eigen.eigenvectors.tr_mul(v);
        let values = &eigen.eigenvalues;
        let weights = DMatrix::from_fn(v.len(), v.len(), |i, j| {
            let (a, b) = (values[i], values[j]);
            let divided = match (a > 0.0, b > 0.0) {
                (true, true) => 1.0,
                (false, false) => 0.0,
                _ => (a.max(0.0) - b.max(0.0)) / (a - b),
            };
            divided * along[i] * along[j]
        });
        Some(&eigen.eigenvectors * weights * eigen.eigenvectors.transpose())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_at_the_end_of_the_tests_is_the_decks_own() {
        let damped = DMatrix::from_row_slice(2, 2, &[-3.0, 0.4, 0.4, -0.2]);
        assert_eq!(TestedRangeEnd::new(damped).own.amax(), 0.0);
        let matrix = DMatrix::from_row_slice(2, 2, &[-3.0, 0.4, 0.4, 0.2]);
        let edge = TestedRangeEnd::new(matrix.clone());
        assert!((edge.size - matrix.norm()).abs() < 1e-15);
        // what is left is damped: its largest eigenvalue is zero
        let largest = SymmetricEigen::new(matrix - &edge.own).eigenvalues.max();
        assert!(largest.abs() < 1e-14, "{largest}");
        assert!(edge.own[(1, 1)] > 0.2, "{}", edge.own);
        let none = TestedRangeEnd::new(DMatrix::zeros(1, 1));
        assert!(none.size == 1.0 && none.own[(0, 0)] == 0.0);
    }

    /// Against central differences.
    #[test]
    fn a_change_of_the_matrix_changes_what_is_fed_in() {
        let matrix = DMatrix::from_row_slice(2, 2, &[-3.0, 0.4, 0.4, 0.2]);
        let change = DMatrix::from_row_slice(2, 2, &[0.7, -0.3, -0.3, 1.1]);
        let v = DVector::from_vec(vec![0.6, 0.8]);
        let grows = |step: f64| {
            let own = TestedRangeEnd::new(&matrix + &change * step).own;
            v.dot(&(own * &v))
        };
        let expected = (grows(1e-5) - grows(-1e-5)) / 2e-5;
        let weights = TestedRangeEnd::new(matrix.clone()).change(&v);
        let found = weights.map(|w| w.component_mul(&change).sum());
        assert!(
            found.is_some_and(|f| (f - expected).abs() < 1e-9),
            "{found:?} {expected}"
        );
        let damped = DMatrix::from_row_slice(2, 2, &[-3.0, 0.4, 0.4, -0.2]);
        assert!(TestedRangeEnd::new(damped).change(&v).is_none());
    }
}
