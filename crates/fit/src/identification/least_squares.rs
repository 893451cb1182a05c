//! Linear least squares by a QR factorisation that is accumulated while rows stream in.
//!
//! Blocks of rows `[regressors | right-hand sides]` are stacked under the triangular factor found so far and
//! re-factored by Householder reflections (Golub & Van Loan, *Matrix Computations*, section 5.2). Memory is that of
//! one block; the normal equations, which square the condition number, are never formed. One factorisation solves
//! every leading subset of the columns.

use crate::error::{Error, Result};
use aerodeck_core::vectorised;
use nalgebra::DMatrix;

/// Rows that are factored together: a block of a dozen columns stays in the first-level cache.
pub(crate) const BLOCK_ROWS: usize = 256;

/// A column whose part outside the span of the columns before it is smaller than this fraction of it is not
/// determined by the data: a thousand times the rounding error of the factorisation.
const RANK_TOLERANCE: f64 = 1e-12;

/// Accumulates rows of an overdetermined linear system with one or more right-hand sides.
#[derive(Debug, Clone)]
pub(crate) struct StreamingQr {
    columns: usize,
    right_hand_sides: usize,
    /// `[R | Qᵀb]`, columns×(columns + right-hand sides).
    upper: DMatrix<f64>,
    /// Sum of squares of each right-hand side that no column can reach.
    rest: Vec<f64>,
    rows: usize,
    /// Block waiting to be factored, one stretch of [`BLOCK_ROWS`] per column.
    pending: Vec<f64>,
    pending_rows: usize,
}

impl StreamingQr {
    /// An empty system of `columns` unknowns and `right_hand_sides` right-hand sides.
    pub(crate) fn new(columns: usize, right_hand_sides: usize) -> Self {
        let width = columns + right_hand_sides;
        Self {
            columns,
            right_hand_sides,
            upper: DMatrix::zeros(columns, width),
            rest: vec![0.0; right_hand_sides],
            rows: 0,
            pending: vec![0.0; width * BLOCK_ROWS],
            pending_rows: 0,
        }
    }

    /// Adds one row `[regressors | right-hand sides]`.
    pub(crate) fn push_row(&mut self, row: &[f64]) {
        debug_assert_eq!(row.len(), self.columns + self.right_hand_sides);
        for (c, value) in row.iter().enumerate() {
            self.pending[c * BLOCK_ROWS + self.pending_rows] = *value;
        }
        self.pending_rows += 1;
        self.rows += 1;
        if self.pending_rows == BLOCK_ROWS {
            reflect_pending(self);
        }
    }

    /// Adds rows given as columns of one length: regressors first, then right-hand sides.
    pub(crate) fn push_columns(&mut self, columns: &[&[f64]]) {
        debug_assert_eq!(columns.len(), self.columns + self.right_hand_sides);
        let rows = columns.first().map_or(0, |c| c.len());
        let mut at = 0;
        while at < rows {
            let count = (rows - at).min(BLOCK_ROWS - self.pending_rows);
            for (c, column) in columns.iter().enumerate() {
                let start = c * BLOCK_ROWS + self.pending_rows;
                self.pending[start..start + count].copy_from_slice(&column[at..at + count]);
            }
            self.pending_rows += count;
            at += count;
            if self.pending_rows == BLOCK_ROWS {
                reflect_pending(self);
            }
        }
        self.rows += rows;
    }

    /// Stacks what `other` has accumulated, times `weight`: its column `c` is column `column_map[c]` here, and its
    /// right-hand side `right_hand_side` is the only one here.
    pub(crate) fn absorb(
        &mut self,
        other: &Factor,
        column_map: &[usize],
        right_hand_side: usize,
        weight: f64,
    ) {
        let rows = self.rows + other.rows;
        let mut row = vec![0.0; self.columns + 1];
        for i in 0..other.columns() {
            row.fill(0.0);
            for (c, &to) in column_map.iter().enumerate().skip(i) {
                row[to] = weight * other.r[(i, c)];
            }
            row[self.columns] = weight * other.qtb[(i, right_hand_side)];
            self.push_row(&row);
        }
        self.rows = rows;
        self.rest[0] += weight * weight * other.rest[right_hand_side];
    }

    /// The factorisation of all rows so far.
    pub(crate) fn finish(mut self) -> Factor {
        reflect_pending(&mut self);
        let right = self.upper.columns(self.columns, self.right_hand_sides);
        Factor {
            r: self.upper.columns(0, self.columns).into_owned(),
            qtb: right.into_owned(),
            rest: self.rest,
            rows: self.rows,
        }
    }
}

vectorised! {
    /// Reflects the pending rows into `R`, one column after the other, with the widest vectors of the processor: they add in the order of
    /// any other.
    fn reflect_pending<'a>(qr: &'a mut StreamingQr) -> () {
        let rows = qr.pending_rows;
        for j in 0..qr.columns {
            let (head, tail) = qr.pending.split_at_mut((j + 1) * BLOCK_ROWS);
            let v = &head[j * BLOCK_ROWS..j * BLOCK_ROWS + rows];
            let below = dot(v, v);
            if below == 0.0 {
                continue;
            }
            let pivot = qr.upper[(j, j)];
            let norm = (pivot * pivot + below).sqrt();
            // the sign that adds: no cancellation in the head of the reflection vector
            let reflected = if pivot > 0.0 { -norm } else { norm };
            let first = pivot - reflected;
            let scale = 1.0 / (norm * (norm + pivot.abs()));
            qr.upper[(j, j)] = reflected;
            for (k, column) in tail.chunks_exact_mut(BLOCK_ROWS).enumerate() {
                let column = &mut column[..rows];
                let top = &mut qr.upper[(j, j + 1 + k)];
                let along = scale * (first * *top + dot(v, column));
                *top -= along * first;
                subtract(column, along, v);
            }
        }
        let right = qr.pending[qr.columns * BLOCK_ROWS..].chunks_exact(BLOCK_ROWS);
        for (rest, column) in qr.rest.iter_mut().zip(right) {
            *rest += dot(&column[..rows], &column[..rows]);
        }
        qr.pending_rows = 0;
    }
}

/// `a·b`, in eight partial sums so that the processor can work on them side by side.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut partial = [0.0; 8];
    let (a_blocks, a_tail) = a.as_chunks::<8>();
    let (b_blocks, b_tail) = b.as_chunks::<8>();
    for (x, y) in a_blocks.iter().zip(b_blocks) {
        for i in 0..8 {
            partial[i] += x[i] * y[i];
        }
    }
    let tail: f64 = a_tail.iter().zip(b_tail).map(|(x, y)| x * y).sum();
    partial.iter().sum::<f64>() + tail
}

/// `to −= factor · v`.
#[inline(always)]
pub(crate) fn subtract(to: &mut [f64], factor: f64, v: &[f64]) {
    for (t, x) in to.iter_mut().zip(v) {
        *t -= factor * x;
    }
}

/// `[R | Qᵀb]` of an accumulated system.
#[derive(Debug, Clone)]
pub(crate) struct Factor {
    /// Upper triangular, n×n.
    pub r: DMatrix<f64>,
    /// n×m.
    pub qtb: DMatrix<f64>,
    /// Sum of squares of each right-hand side outside the span of all columns.
    rest: Vec<f64>,
    /// Number of rows that went in.
    pub rows: usize,
}

impl Factor {
    /// Number of columns.
    pub(crate) fn columns(&self) -> usize {
        self.r.ncols()
    }

    /// The system of some of its columns, in the given order.
    pub(crate) fn select(&self, columns: &[usize]) -> Self {
        let mut qr = StreamingQr::new(columns.len(), self.qtb.ncols());
        for i in 0..self.columns() {
            let regressors = columns.iter().map(|&c| self.r[(i, c)]);
            let row: Vec<f64> = regressors.chain(self.qtb.row(i).iter().copied()).collect();
            qr.push_row(&row);
        }
        let mut factor = qr.finish();
        factor.rows = self.rows;
        let rests = factor.rest.iter_mut().zip(&self.rest);
        rests.for_each(|(rest, before)| *rest += before);
        factor
    }

    /// First of the `leading` columns that the data do not determine: zero, or a combination of those before it.
    pub(crate) fn undetermined(&self, leading: usize) -> Option<usize> {
        (0..leading).find(|&j| {
            let norm = self.column_norm(j);
            norm == 0.0 || self.r[(j, j)].abs() < RANK_TOLERANCE * norm
        })
    }

    /// Euclidean norm of column `j` of the system.
    pub(crate) fn column_norm(&self, j: usize) -> f64 {
        self.r.column(j).norm()
    }

    /// Coefficients of the `leading` columns for every right-hand side, leading×m.
    ///
    /// # Errors
    /// [`Error::Numerical`] when a column is not determined by the rows.
    pub(crate) fn solve(&self, leading: usize) -> Result<DMatrix<f64>> {
        if let Some(column) = self.undetermined(leading) {
            return Err(Error::Numerical(format!(
                "least squares: column {column} of {leading} is not determined by the {} rows",
                self.rows
            )));
        }
        let upper = self.r.view((0, 0), (leading, leading));
        let solution = upper.solve_upper_triangular(&self.qtb.rows(0, leading));
        let singular = || Error::Numerical("least squares: singular triangular factor".into());
        solution.ok_or_else(singular)
    }

    /// Sum of squared residuals of right-hand side `m` with the best coefficients of the `leading` columns.
    pub(crate) fn residual_sum(&self, leading: usize, m: usize) -> f64 {
        self.rest[m] + self.qtb.column(m).rows_range(leading..).norm_squared()
    }

    /// Sum of squared residuals of right-hand side `m` with given coefficients of all columns.
    pub(crate) fn residual_sum_of(&self, coefficients: &[f64], m: usize) -> f64 {
        let c = nalgebra::DVector::from_column_slice(coefficients);
        self.rest[m] + (self.qtb.column(m) - &self.r * c).norm_squared()
    }

    /// Sum of squares of right-hand side `m`.
    pub(crate) fn total_sum(&self, m: usize) -> f64 {
        self.residual_sum(0, m)
    }

    /// Condition number of the `leading` columns, each scaled to unit norm; infinite for a zero column.
    pub(crate) fn condition(&self, leading: usize) -> f64 {
        let mut scaled = self.r.view((0, 0), (leading, leading)).into_owned();
        for (j, mut column) in scaled.column_iter_mut().enumerate() {
            let norm = self.column_norm(j);
            if norm == 0.0 || !norm.is_finite() {
                return f64::INFINITY;
            }
            column.unscale_mut(norm);
        }
        match scaled.try_svd(false, false, f64::EPSILON, 10_000) {
            Some(svd) if leading > 0 => {
                svd.singular_values.max() / svd.singular_values.min().max(f64::MIN_POSITIVE)
            }
            Some(_) => 1.0,
            None => f64::INFINITY,
        }
    }

    /// `R⁻¹` of the `leading` columns: what the coefficients become for unit vectors added to `Qᵀb`.
    ///
    /// # Errors
    /// [`Error::Numerical`] when a column is not determined by the rows.
    pub(crate) fn inverse_upper(&self, leading: usize) -> Result<DMatrix<f64>> {
        let upper = self.r.view((0, 0), (leading, leading));
        let inverse = upper.solve_upper_triangular(&DMatrix::identity(leading, leading));
        let inverse = inverse.filter(|_| self.undetermined(leading).is_none());
        inverse.ok_or_else(|| Error::Numerical("covariance: singular triangular factor".into()))
    }

    /// `(RᵀR)⁻¹` of the `leading` columns: the covariance of the coefficients for white residuals of unit variance.
    ///
    /// # Errors
    /// [`Error::Numerical`] when a column is not determined by the rows.
    pub(crate) fn inverse_gram(&self, leading: usize) -> Result<DMatrix<f64>> {
        let inverse = self.inverse_upper(leading)?;
        Ok(&inverse * inverse.transpose())
    }

    /// How much the terms of a fit cancel: the largest `‖column · coefficient‖` over the norm of the fitted
    /// right-hand side. Near one for a sound fit; large numbers mean differences of large terms.
    pub(crate) fn cancellation(&self, coefficients: &[f64], m: usize) -> f64 {
        let fitted = self.qtb.column(m).rows_range(..coefficients.len()).norm();
        let each = coefficients.iter().enumerate();
        let sizes = each.map(|(j, c)| (c * self.column_norm(j)).abs());
        let largest = sizes.fold(0.0, f64::max);
        if largest == 0.0 {
            0.0
        } else {
            largest / fitted
        }
    }
}

#[cfg(test)]
mod tests;
