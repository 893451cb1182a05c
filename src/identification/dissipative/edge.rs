//! The end of the tested range, as the data alone have it.

use crate::section::Dof;
use nalgebra::{DMatrix, SymmetricEigen};

/// What the fit that the data alone give says at the end of the tested range.
pub(super) struct TestedRangeEnd {
    /// The size against which margins and tolerances are measured: that of `sym Im G/K`, which the data determine.
    pub size: f64,
    /// Its part that feeds energy into heave and torsion, n×n, positive semidefinite; zero for decks that are damped
    /// there. Lateral motion is damped by the mean drag: what tests of it feed in is scatter.
    pub own: DMatrix<f64>,
}

impl TestedRangeEnd {
    /// Of the matrix `sym Im G/K` there, n×n in the order of `dofs`.
    pub(crate) fn new(matrix: DMatrix<f64>, dofs: &[Dof]) -> Self {
        let mut edge = Self::nothing(dofs.len());
        let size = matrix.norm();
        if size == 0.0 {
            return edge;
        }
        edge.size = size;
        let of_deck: Vec<usize> = (0..dofs.len())
            .filter(|i| dofs[*i] != Dof::Lateral)
            .collect();
        let mut eigen = SymmetricEigen::new(matrix.select_rows(&of_deck).select_columns(&of_deck));
        if eigen.eigenvalues.iter().any(|value| *value > 0.0) {
            eigen.eigenvalues.apply(|value| *value = value.max(0.0));
            let fed = eigen.recompose();
            for (a, i) in of_deck.iter().enumerate() {
                for (b, j) in of_deck.iter().enumerate() {
                    edge.own[(*i, *j)] = fed[(a, b)];
                }
            }
        }
        edge
    }

    /// Where nothing is asked.
    pub(crate) fn nothing(n: usize) -> Self {
        Self {
            size: 1.0,
            own: DMatrix::zeros(n, n),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_of_heave_and_torsion_is_the_decks_own_and_that_of_sway_is_scatter() {
        let damped = DMatrix::from_row_slice(2, 2, &[-3.0, 0.4, 0.4, -0.2]);
        assert_eq!(TestedRangeEnd::new(damped, &Dof::TWO).own.amax(), 0.0);
        let matrix = DMatrix::from_row_slice(3, 3, &[-3.0, 1.0, 0.4, 1.0, 0.5, 0.1, 0.4, 0.1, 0.2]);
        let edge = TestedRangeEnd::new(matrix.clone(), &Dof::THREE);
        assert!((edge.size - matrix.norm()).abs() < 1e-15);
        assert_eq!(edge.own.row(1).amax(), 0.0);
        // what is left of heave and torsion is damped: its largest eigenvalue is zero
        let rest = (matrix - &edge.own)
            .select_rows(&[0, 2])
            .select_columns(&[0, 2]);
        let largest = SymmetricEigen::new(rest).eigenvalues.max();
        assert!(largest.abs() < 1e-14, "{largest}");
        assert!(edge.own[(2, 2)] > 0.2, "{}", edge.own);
    }
}
