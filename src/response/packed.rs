//! A product of matrix and vector for small matrices that are used often.

use nalgebra::DMatrix;

/// Rows are padded to whole groups of this many, so that the inner loop has a fixed length.
const LANES: usize = 4;

/// A matrix stored for `y = W v`, in groups of rows.
#[derive(Debug, Clone)]
pub(super) struct Packed {
    rows: usize,
    columns: usize,
    /// For each group of `LANES` rows, the columns one after the other.
    data: Vec<[f64; LANES]>,
}

impl Packed {
    pub fn new(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let data = (0..rows.div_ceil(LANES))
            .flat_map(|group| (0..columns).map(move |j| (group, j)))
            .map(|(group, j)| {
                std::array::from_fn(|lane| {
                    let i = group * LANES + lane;
                    if i < rows { entry(i, j) } else { 0.0 }
                })
            })
            .collect();
        Self {
            rows,
            columns,
            data,
        }
    }

    /// A whole matrix.
    pub fn of(m: &DMatrix<f64>) -> Self {
        Self::new(m.nrows(), m.ncols(), |i, j| m[(i, j)])
    }
}

/// Sums that run side by side, so that no addition waits for the one before it.
const PARTIAL_SUMS: usize = 4;

/// `y = W v` over the first `v.len()` columns, which may be fewer than `W` has.
pub(super) fn apply(w: &Packed, v: &[f64], y: &mut [f64]) {
    let y = &mut y[..w.rows];
    for (out, columns) in y.chunks_mut(LANES).zip(w.data.chunks_exact(w.columns)) {
        let columns = &columns[..v.len()];
        let mut sums = [[0.0; LANES]; PARTIAL_SUMS];
        let four_columns = columns.chunks_exact(PARTIAL_SUMS);
        let four_values = v.chunks_exact(PARTIAL_SUMS);
        let rest = four_columns.remainder().iter().zip(four_values.remainder());
        for (four, x) in four_columns.zip(four_values) {
            for part in 0..PARTIAL_SUMS {
                for lane in 0..LANES {
                    sums[part][lane] += four[part][lane] * x[part];
                }
            }
        }
        for (part, (column, x)) in rest.enumerate() {
            for lane in 0..LANES {
                sums[part][lane] += column[lane] * x;
            }
        }
        for (lane, y) in out.iter_mut().enumerate() {
            *y = (sums[0][lane] + sums[1][lane]) + (sums[2][lane] + sums[3][lane]);
        }
    }
}
