//! Products with matrices of which most entries are zero.

use super::lanes::{FourLanes, LANES};
use super::packed::Packed;
use nalgebra::DMatrix;

/// A matrix of which most entries are zero, row by row.
#[derive(Debug, Clone)]
pub struct Sparse {
    /// Where the entries of each row end.
    ends: Vec<usize>,
    /// Column and entry.
    entries: Vec<(usize, f64)>,
}

impl Sparse {
    /// The entries of a matrix that are not zero.
    pub fn new(m: &DMatrix<f64>) -> Self {
        let (mut ends, mut entries) = (Vec::with_capacity(m.nrows()), Vec::new());
        for row in m.row_iter() {
            let filled = row.iter().enumerate().filter(|(_, x)| **x != 0.0);
            entries.extend(filled.map(|(j, x)| (j, *x)));
            ends.push(entries.len());
        }
        Self { ends, entries }
    }

    /// `y += W v`.
    #[inline(always)]
    pub(super) fn add(&self, v: impl Fn(usize) -> f64, y: &mut [f64]) {
        let mut from = 0;
        for (y, end) in y.iter_mut().zip(&self.ends) {
            let mut sum = *y;
            for (j, x) in &self.entries[from..*end] {
                sum += x * v(*j);
            }
            (*y, from) = (sum, *end);
        }
    }

    /// `Y = W V` for as many vectors as there are lanes.
    #[inline(always)]
    pub fn set_lanes(&self, v: &[[f64; LANES]], y: &mut [[f64; LANES]]) {
        y.fill([0.0; LANES]);
        self.add_lanes(v, y);
    }

    /// `Y += W V`.
    #[inline(always)]
    pub fn add_lanes(&self, v: &[[f64; LANES]], y: &mut [[f64; LANES]]) {
        let mut from = 0;
        for (y, end) in y.iter_mut().zip(&self.ends) {
            let mut sums = *y;
            for (j, x) in &self.entries[from..*end] {
                for lane in 0..LANES {
                    sums[lane] += x * v[*j][lane];
                }
            }
            (*y, from) = (sums, *end);
        }
    }
}

/// Rows of a matrix that are multiplied one and all, because there are few of them.
const FEW_ROWS: usize = 40;

/// The equation of pressure and filters. Filters of a bridge hang together in short chains, one or a few for each mode, so
/// that a product with their rows, taken by their links, costs modes × filters; on a section a row costs less than its links.
#[derive(Debug, Clone)]
pub(super) struct Linked {
    /// Rows of which most entries count; all where there are few.
    full: Packed,
    /// Those of the filters, behind them.
    linked: Sparse,
}

impl Linked {
    /// A matrix whose first `full` rows are full.
    pub(super) fn new(matrix: &DMatrix<f64>, full: usize) -> Self {
        let rows = matrix.nrows();
        let full = if rows > FEW_ROWS { full } else { rows };
        Self {
            full: Packed::new(&matrix.rows(0, full).into_owned()),
            linked: Sparse::new(&matrix.rows(full, rows - full).into_owned()),
        }
    }

    #[inline(always)]
    pub(super) fn set<S: FourLanes>(&self, simd: S, v: &[f64], y: &mut [f64]) {
        let (first, rest) = y.split_at_mut(self.full.rows);
        self.full.set(simd, v, first, |x| x);
        rest.fill(0.0);
        self.linked.add(|j| v[j], rest);
    }
}
