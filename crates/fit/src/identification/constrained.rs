//! Weighted linear least squares with equality constraints and a ridge.
//!
//! Constraints `C c = d` are met exactly by the null-space method (Golub & Van Loan, *Matrix Computations*, section
//! 6.2.3): `c = c₀ + N z` with `C c₀ = d`, `C N = 0`, and least squares for the free `z`.

use super::affine::{AffineMap, AffineSpace, unit};
use super::least_squares::{Factor, StreamingQr};
use super::report::enough_rows;
use crate::error::{Error, Result};
use nalgebra::{DMatrix, DVector};

/// Constraint rows whose independent part is smaller than this contradict or repeat each other.
const RANK_TOLERANCE: f64 = 1e-10;

/// `min ‖A c − b‖² + Σ (ridge_c ‖A_c‖ c)²` with `C c = d`.
#[derive(Debug, Clone, Default)]
pub(crate) struct LinearProblem {
    /// Weighted rows of `A`.
    pub rows: Vec<Vec<f64>>,
    /// Weighted right-hand side.
    pub right: Vec<f64>,
    /// Factor of the ridge of each column; zero for none.
    pub ridge: Vec<f64>,
    /// Rows of `C` and numbers of `d`.
    pub constraints: Vec<(Vec<f64>, f64)>,
}

/// Its solution.
pub(crate) struct LinearSolution {
    /// Factorisation in the free unknowns.
    pub factor: Factor,
    /// Coefficients of all columns, zero for those the rows cannot see.
    pub coefficients: Vec<f64>,
    /// Number of free unknowns.
    pub unknowns: usize,
    /// Columns that have a ridge, and what it multiplies their coefficients with.
    ridge: Vec<(usize, f64)>,
    /// Largest `‖A_c c‖` over `‖A c‖`: near one for a sound fit, large when terms cancel.
    pub cancellation: f64,
    /// From the free unknowns to all coefficients.
    space: AffineMap,
}

impl LinearProblem {
    fn columns(&self) -> usize {
        self.ridge.len()
    }

    /// Solves it; `place` and `names` of the columns are for messages.
    ///
    /// # Errors
    /// [`Error::Input`] for fewer rows than unknowns, columns that the rows do not determine and constraints that cannot
    /// be met together.
    pub(crate) fn solve(
        &self,
        place: &str,
        names: &dyn Fn(usize) -> String,
    ) -> Result<LinearSolution> {
        let space = self.space(place)?;
        let unknowns = space.spread.ncols();
        enough_rows(place, self.rows.len(), unknowns)?;
        let norms = self.norms();
        let with_ridge = (0..self.columns()).filter(|&c| self.ridge[c] > 0.0);
        let ridge: Vec<(usize, f64)> = with_ridge.map(|c| (c, self.ridge[c] * norms[c])).collect();
        let (measured, n) = (self.rows.len(), self.columns());
        let all = DMatrix::from_fn(measured + ridge.len(), n, |r, c| match self.rows.get(r) {
            Some(row) => row[c],
            None if ridge[r - measured].0 == c => ridge[r - measured].1,
            None => 0.0,
        });
        let at_start = &all * DVector::from_column_slice(&space.values);
        let right = self.right.iter().chain(std::iter::repeat(&0.0));
        let right: Vec<f64> = right.zip(&at_start).map(|(b, fitted)| b - fitted).collect();
        let free = &all * &space.spread;
        let mut columns: Vec<&[f64]> = free.as_slice().chunks_exact(right.len().max(1)).collect();
        columns.push(&right);
        let mut qr = StreamingQr::new(unknowns, 1);
        qr.push_columns(&columns);
        let factor = qr.finish();
        if let Some(z) = factor.undetermined(unknowns) {
            let what = match self.constraints.is_empty() {
                true => names(space.spread.column(z).imax()),
                false => "what the limits leave free".to_owned(),
            };
            return Err(Error::input(
                place,
                "samples at enough different K for the number of filters",
                format!("nothing that determines {what}"),
            ));
        }
        let coefficients = space.coefficients(&factor.solve(unknowns)?.column(0).into_owned());
        Ok(LinearSolution {
            unknowns,
            ridge,
            cancellation: self.cancellation(&norms, &coefficients),
            factor,
            coefficients,
            space,
        })
    }

    fn norms(&self) -> Vec<f64> {
        let norm = |c: usize| self.rows.iter().map(|r| r[c] * r[c]).sum::<f64>().sqrt();
        (0..self.columns()).map(norm).collect()
    }

    fn cancellation(&self, norms: &[f64], coefficients: &[f64]) -> f64 {
        let terms = norms.iter().zip(coefficients).map(|(n, c)| (n * c).abs());
        let largest = terms.fold(0.0, f64::max);
        if largest == 0.0 {
            return 0.0;
        }
        let fitted = |row: &Vec<f64>| -> f64 {
            let terms = row.iter().zip(coefficients).map(|(a, c)| a * c);
            terms.sum::<f64>().powi(2)
        };
        let fitted: f64 = self.rows.iter().map(fitted).sum();
        largest / fitted.sqrt()
    }

    /// The coefficients that meet the constraints, without those that neither rows nor constraints see: with one part only (say,
    /// no H4*), columns that have no such part are out of reach.
    fn space(&self, place: &str) -> Result<AffineMap> {
        let n = self.columns();
        let seen = |c: usize| self.rows.iter().any(|row| row[c] != 0.0);
        let bound = |c: usize| self.constraints.iter().any(|(row, _)| row[c] != 0.0);
        let mut space = AffineSpace::whole(n);
        for c in (0..n).filter(|&c| !seen(c) && !bound(c)) {
            space.hold(&unit(n, c), 0.0, RANK_TOLERANCE);
        }
        for (row, target) in &self.constraints {
            let gradient = DVector::from_column_slice(row);
            if !space.hold(&gradient, *target, RANK_TOLERANCE) {
                return Err(Error::input(
                    place,
                    "limits at K → 0 that the columns of the model can meet",
                    "a feed-through is missing, or one limit repeats another",
                ));
            }
        }
        Ok(AffineMap {
            spread: space.basis(),
            values: space.start.data.into(),
            at: 0,
        })
    }
}

impl LinearSolution {
    /// Residuals of the ridge with given coefficients, of the columns that have one.
    pub(crate) fn penalty<'a>(&'a self, coefficients: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let ridge = self.ridge.iter();
        ridge.map(|(c, factor)| factor * coefficients[*c])
    }

    /// What the coefficients become when the free unknowns leave their best values by one unit of the weighted residual,
    /// along each of them, n×unknowns: `N R⁻¹`.
    pub(crate) fn spread(&self) -> Result<DMatrix<f64>> {
        Ok(&self.space.spread * self.factor.inverse_upper(self.unknowns)?)
    }

    /// `(AᵀA)⁻¹` of the free unknowns, spread over all coefficients.
    pub(crate) fn inverse_gram(&self) -> Result<DMatrix<f64>> {
        let (small, map) = (self.factor.inverse_gram(self.unknowns)?, &self.space.spread);
        Ok(map * small * map.transpose())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(constraints: Vec<(Vec<f64>, f64)>) -> LinearProblem {
        let rows: Vec<Vec<f64>> = (0..7)
            .map(|i| {
                let x = f64::from(i) * 0.4 - 1.0;
                vec![1.0, x, x * x, x * x * x]
            })
            .collect();
        LinearProblem {
            right: rows.iter().map(|r| (2.0 * r[1]).exp()).collect(),
            rows,
            ridge: vec![0.0; 4],
            constraints,
        }
    }

    fn solve(p: &LinearProblem) -> Result<LinearSolution> {
        p.solve("test", &|c| format!("c{c}"))
    }

    /// Against the bordered normal equations `[AᵀA Cᵀ; C 0]`, whose condition costs about eight digits here.
    #[test]
    fn constrained_solution_is_that_of_the_bordered_system() {
        let rows = [
            (vec![1.0, 0.0, 0.0, 0.0], 0.9),
            (vec![0.0, 1.0, 0.0, 2.5], 2.2),
        ];
        let p = problem(rows.to_vec());
        let found = solve(&p).unwrap();
        let a = DMatrix::from_fn(7, 4, |i, j| p.rows[i][j]);
        let b = DVector::from_column_slice(&p.right);
        let mut bordered = DMatrix::zeros(6, 6);
        bordered
            .view_mut((0, 0), (4, 4))
            .copy_from(&(a.transpose() * &a));
        let mut right = DVector::zeros(6);
        right.rows_mut(0, 4).copy_from(&(a.transpose() * b));
        for (m, (row, d)) in rows.iter().enumerate() {
            for c in 0..4 {
                bordered[(4 + m, c)] = row[c];
                bordered[(c, 4 + m)] = row[c];
            }
            right[4 + m] = *d;
        }
        let expected = bordered.clone().lu().solve(&right).unwrap();
        for c in 0..4 {
            assert!((found.coefficients[c] - expected[c]).abs() < 1e-10);
        }
        // the covariance is the upper left block of the inverse of the bordered matrix
        let inverse = bordered.try_inverse().unwrap();
        let gram = found.inverse_gram().unwrap();
        assert!((gram - inverse.view((0, 0), (4, 4))).amax() < 1e-10);
        assert_eq!(found.unknowns, 2);
    }

    /// A ridge on one column against the normal equations with that number on the diagonal.
    #[test]
    fn ridge_is_that_of_the_normal_equations() {
        let mut p = problem(vec![]);
        p.ridge[3] = 0.3;
        let found = solve(&p).unwrap();
        let a = DMatrix::from_fn(7, 4, |i, j| p.rows[i][j]);
        let mut normal = a.transpose() * &a;
        normal[(3, 3)] *= 1.0 + 0.09;
        let right = a.transpose() * DVector::from_column_slice(&p.right);
        let expected = normal.lu().solve(&right).unwrap();
        for c in 0..4 {
            assert!((found.coefficients[c] - expected[c]).abs() < 1e-10);
        }
        assert_eq!(found.penalty(&found.coefficients).count(), 1);
    }

    #[test]
    fn limits_that_cannot_be_met_are_refused() {
        let twice = (vec![1.0, 0.0, 0.0, 0.0], 0.9);
        assert!(solve(&problem(vec![twice.clone(), twice])).is_err());
        assert!(solve(&problem(vec![(vec![0.0; 4], 1.0)])).is_err());
    }
}
