//! The end of the tested range, as the data alone have it.

use nalgebra::{DMatrix, SymmetricEigen};

/// What the fit that the data alone give says of one part of the motions at the end of the tested range.
pub(super) struct TestedRangeEnd {
    /// The size against which margins and tolerances are measured: that of `sym Im G/K`, which the data determine.
    pub size: f64,
    /// Its part that feeds energy in, positive semidefinite; zero for decks that are damped there.
    pub own: DMatrix<f64>,
}

impl TestedRangeEnd {
    /// Of the matrix `sym Im G/K` there.
    pub(crate) fn new(matrix: DMatrix<f64>) -> Self {
        let n = matrix.nrows();
        let norm = matrix.norm();
        let mut eigen = SymmetricEigen::new(matrix);
        let fed = eigen.eigenvalues.iter().any(|value| *value > 0.0);
        eigen.eigenvalues.apply(|value| *value = value.max(0.0));
        Self {
            size: if norm > 0.0 { norm } else { 1.0 },
            own: if fed {
                eigen.recompose()
            } else {
                DMatrix::zeros(n, n)
            },
        }
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
}
