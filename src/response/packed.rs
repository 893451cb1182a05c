//! A product of matrix and vector for small matrices that are used often.

use nalgebra::DMatrix;

/// States smaller than this have died out. Numbers below 1e-308 are computed thirty times slower; products with the
/// coefficients of a step stay above.
const DIED_OUT: f64 = 1e-250;

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

/// A matrix of which most entries are zero, row by row.
#[derive(Debug, Clone)]
pub(super) struct Sparse {
    /// Where the entries of each row end.
    ends: Vec<usize>,
    /// Column and entry.
    entries: Vec<(usize, f64)>,
}

impl Sparse {
    pub fn of(m: &DMatrix<f64>) -> Self {
        let (mut ends, mut entries) = (Vec::with_capacity(m.nrows()), Vec::new());
        for row in m.row_iter() {
            let filled = row.iter().enumerate().filter(|(_, x)| **x != 0.0);
            entries.extend(filled.map(|(j, x)| (j, *x)));
            ends.push(entries.len());
        }
        Self { ends, entries }
    }

    /// `y = W v`.
    pub fn apply(&self, v: &[f64], y: &mut [f64]) {
        let mut from = 0;
        for (y, end) in y.iter_mut().zip(&self.ends) {
            *y = self.entries[from..*end]
                .iter()
                .map(|(j, x)| x * v[*j])
                .sum();
            from = *end;
        }
    }
}

/// Rows of a matrix that are multiplied one and all, because there are few of them.
const FEW_ROWS: usize = 40;

/// The equation of pressure and filters. Filters of a bridge hang together in short chains, one or a few for each mode, so
/// that a product with their rows, taken by their links, costs modes × filters; on a section a row costs less than its links.
#[derive(Debug, Clone)]
pub(super) enum Linked {
    Few(Packed),
    /// Rows of which most entries count, and behind them those of the filters.
    Many(Packed, Sparse),
}

impl Linked {
    /// A matrix whose first `full` rows are full.
    pub fn of(matrix: &DMatrix<f64>, full: usize) -> Self {
        let rest = matrix.nrows() - full;
        if matrix.nrows() > FEW_ROWS {
            let linked = Sparse::of(&matrix.rows(full, rest).into_owned());
            Self::Many(Packed::of(&matrix.rows(0, full).into_owned()), linked)
        } else {
            Self::Few(Packed::of(matrix))
        }
    }

    pub fn apply(&self, v: &[f64], y: &mut [f64]) {
        match self {
            Self::Few(matrix) => apply(matrix, v, y),
            Self::Many(full, linked) => {
                let (first, rest) = y.split_at_mut(full.rows);
                apply(full, v, first);
                linked.apply(v, rest);
            }
        }
    }
}

/// Sums that run side by side, so that no addition waits for the one before it.
const PARTIAL_SUMS: usize = 4;

/// `y = W v` over the first `v.len()` columns, which may be fewer than `W` has.
///
/// Lanes and partial sums are added in one order on every processor: whatever vectors it has, the bits are the same.
pub(super) fn apply(w: &Packed, v: &[f64], y: &mut [f64]) {
    pulp::Arch::new().dispatch(Apply { w, v, y });
}

/// [`apply`] to a state: what has died out becomes zero; returns whether all of the new state is finite.
pub(super) fn advanced(w: &Packed, v: &[f64], y: &mut [f64]) -> bool {
    pulp::Arch::new().dispatch(Advance(Apply { w, v, y }))
}

/// A product that is compiled for each set of vectors a processor may have.
struct Apply<'a> {
    w: &'a Packed,
    v: &'a [f64],
    y: &'a mut [f64],
}

struct Advance<'a>(Apply<'a>);

impl pulp::NullaryFnOnce for Apply<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        product(self.w, self.v, self.y, |sums| sums);
    }
}

impl pulp::NullaryFnOnce for Advance<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let Apply { w, v, y } = self.0;
        let mut spoilt = [0.0; LANES];
        product(w, v, y, |sums| {
            std::array::from_fn(|lane| settle(sums[lane], &mut spoilt[lane]))
        });
        spoilt == [0.0; LANES]
    }
}

/// `y = W v`, each group of rows through `finish`.
#[inline(always)]
fn product(
    w: &Packed,
    v: &[f64],
    y: &mut [f64],
    mut finish: impl FnMut([f64; LANES]) -> [f64; LANES],
) {
    let y = &mut y[..w.rows];
    let (fours, rest) = v.as_chunks::<PARTIAL_SUMS>();
    let (whole, last) = y.as_chunks_mut::<LANES>();
    let mut data = w.data.as_slice();
    for out in whole {
        let (columns, others) = data.split_at(w.columns);
        *out = finish(group(&columns[..v.len()], fours, rest));
        data = others;
    }
    if !last.is_empty() {
        let sums = finish(group(&data[..v.len()], fours, rest));
        last.copy_from_slice(&sums[..last.len()]);
    }
}

/// The sums of one group of rows.
#[inline(always)]
fn group(columns: &[[f64; LANES]], fours: &[[f64; PARTIAL_SUMS]], rest: &[f64]) -> [f64; LANES] {
    let mut sums = [[0.0; LANES]; PARTIAL_SUMS];
    let (four_columns, last) = columns.as_chunks::<PARTIAL_SUMS>();
    for (four, x) in four_columns.iter().zip(fours) {
        for part in 0..PARTIAL_SUMS {
            for lane in 0..LANES {
                sums[part][lane] += four[part][lane] * x[part];
            }
        }
    }
    for (sum, (column, x)) in sums.iter_mut().zip(last.iter().zip(rest)) {
        for lane in 0..LANES {
            sum[lane] += column[lane] * x;
        }
    }
    let [a, b, c, d] = sums;
    std::array::from_fn(|lane| (a[lane] + b[lane]) + (c[lane] + d[lane]))
}

/// `x`, or zero where it has died out; `spoilt` stays zero as long as all are finite. Without a branch: this is part of
/// every step.
#[inline(always)]
fn settle(x: f64, spoilt: &mut f64) -> f64 {
    *spoilt += 0.0 * x;
    if x.abs() < DIED_OUT { 0.0 } else { x }
}

/// Whether all values are finite; those that have died out become zero.
pub(super) fn settled(values: &mut [f64]) -> bool {
    let mut spoilt = 0.0;
    for x in values {
        *x = settle(*x, &mut spoilt);
    }
    spoilt == 0.0
}
