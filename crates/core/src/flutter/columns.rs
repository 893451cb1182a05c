//! Complex matrices for the vectors of the processor: real and imaginary parts of eight rows lie together, each column padded to
//! whole eights, so that every step works on full vectors; the order of the sums, and so the bits, are the same on every processor.
//! Loops count, where iterators would read better: those stay functions of their own, compiled for the plainest of processors.

use crate::state_space::Complex64;
use nalgebra::{DMatrix, DVector};

/// What moves in a mode, in its coordinates.
pub(super) type Shape = DVector<Complex64>;

/// Rows that lie together.
pub(super) const WIDTH: usize = 8;

/// Eight rows of one column.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct EntryBlock {
    re: [f64; WIDTH],
    im: [f64; WIDTH],
}

impl EntryBlock {
    pub(super) const ZERO: Self = Self {
        re: [0.0; WIDTH],
        im: [0.0; WIDTH],
    };

    /// Of these rows, of which the first is row `first`, the ones that are named; zero in place of the others.
    #[inline(always)]
    pub(super) fn kept(&self, first: usize, keep: impl Fn(usize) -> bool) -> Self {
        let mut kept = Self::ZERO;
        for e in 0..WIDTH {
            let here = keep(first + e);
            kept.re[e] = if here { self.re[e] } else { 0.0 };
            kept.im[e] = if here { self.im[e] } else { 0.0 };
        }
        kept
    }

    /// Adds real rows times a complex number.
    #[inline(always)]
    fn add(&mut self, real: &RowGroup, factor: Complex64) {
        for e in 0..WIDTH {
            self.re[e] += factor.re * real.0[e];
        }
        for e in 0..WIDTH {
            self.im[e] += factor.im * real.0[e];
        }
    }

    /// Subtracts other rows times a complex number.
    #[inline(always)]
    pub(super) fn subtract(&mut self, other: &Self, factor: Complex64) {
        for e in 0..WIDTH {
            self.re[e] -= factor.re * other.re[e] - factor.im * other.im[e];
        }
        for e in 0..WIDTH {
            self.im[e] -= factor.re * other.im[e] + factor.im * other.re[e];
        }
    }
}

/// A real matrix, column by column, in whole eights.
#[derive(Debug, Clone)]
pub(super) struct RealColumns {
    rows: usize,
    all: Vec<RowGroup>,
}

/// Eight rows of one column.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct RowGroup([f64; WIDTH]);

impl RealColumns {
    pub(super) fn new(matrix: &DMatrix<f64>) -> Self {
        let stride = matrix.nrows().div_ceil(WIDTH);
        let mut all = vec![RowGroup([0.0; WIDTH]); stride * matrix.ncols()];
        for (j, column) in matrix.column_iter().enumerate() {
            for (i, x) in column.iter().enumerate() {
                all[j * stride + i / WIDTH].0[i % WIDTH] = *x;
            }
        }
        Self {
            rows: matrix.nrows(),
            all,
        }
    }
}

/// In a sum the number that a real matrix is multiplied with, that number's derivative, and the matrix.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term<'a>(pub Complex64, pub Complex64, pub &'a RealColumns);

/// A complex matrix, column by column.
#[derive(Debug, Clone)]
pub(super) struct ComplexColumns {
    pub(super) rows: usize,
    /// Groups of eight of one column.
    pub(super) stride: usize,
    pub(super) all: Vec<EntryBlock>,
}

impl ComplexColumns {
    pub(super) fn zeros(rows: usize, columns: usize) -> Self {
        let stride = rows.div_ceil(WIDTH);
        Self {
            rows,
            stride,
            all: vec![EntryBlock::ZERO; stride * columns],
        }
    }

    pub(super) fn new(matrix: &DMatrix<Complex64>) -> Self {
        let mut all = Self::zeros(matrix.nrows(), matrix.ncols());
        for (j, column) in matrix.column_iter().enumerate() {
            for (i, z) in column.iter().enumerate() {
                all.set(i, j, *z);
            }
        }
        all
    }

    /// One column.
    pub(super) fn of_column(column: &DVector<Complex64>) -> Self {
        let mut all = Self::zeros(column.len(), 1);
        for (i, z) in column.iter().enumerate() {
            all.set(i, 0, *z);
        }
        all
    }

    /// The first column.
    pub(super) fn to_column(&self) -> DVector<Complex64> {
        DVector::from_fn(self.rows, |i, _| self.at(i, 0))
    }

    pub(super) fn to_matrix(&self) -> DMatrix<Complex64> {
        DMatrix::from_fn(self.rows, self.columns(), |i, j| self.at(i, j))
    }

    /// The sum of the terms.
    #[inline(always)]
    pub(super) fn value(terms: &[Term<'_>]) -> Self {
        let mut value = Self::like(terms);
        for i in 0..value.all.len() {
            let mut sum = EntryBlock::ZERO;
            for Term(factor, _, matrix) in terms {
                sum.add(&matrix.all[i], *factor);
            }
            value.all[i] = sum;
        }
        value
    }

    /// The sum of the terms and its derivative.
    #[inline(always)]
    pub(super) fn sum(terms: &[Term<'_>]) -> (Self, Self) {
        let (mut value, mut slope) = (Self::like(terms), Self::like(terms));
        for i in 0..value.all.len() {
            let (mut sum, mut slopes) = (EntryBlock::ZERO, EntryBlock::ZERO);
            for Term(factor, slope, matrix) in terms {
                sum.add(&matrix.all[i], *factor);
                slopes.add(&matrix.all[i], *slope);
            }
            (value.all[i], slope.all[i]) = (sum, slopes);
        }
        (value, slope)
    }

    /// Zeros of the size of the terms.
    fn like(terms: &[Term<'_>]) -> Self {
        let matrix = terms.first().map(|Term(.., matrix)| matrix);
        let (rows, eights) = matrix.map_or((0, 0), |m| (m.rows, m.all.len()));
        Self {
            rows,
            stride: rows.div_ceil(WIDTH),
            all: vec![EntryBlock::ZERO; eights],
        }
    }

    pub(super) fn columns(&self) -> usize {
        self.all.len() / self.stride.max(1)
    }

    #[inline(always)]
    pub(super) fn at(&self, i: usize, j: usize) -> Complex64 {
        let rows = &self.all[j * self.stride + i / WIDTH];
        Complex64::new(rows.re[i % WIDTH], rows.im[i % WIDTH])
    }

    #[inline(always)]
    pub(super) fn set(&mut self, i: usize, j: usize, z: Complex64) {
        let rows = &mut self.all[j * self.stride + i / WIDTH];
        (rows.re[i % WIDTH], rows.im[i % WIDTH]) = (z.re, z.im);
    }

    #[inline(always)]
    pub(super) fn column(&self, j: usize) -> &[EntryBlock] {
        &self.all[j * self.stride..][..self.stride]
    }

    /// `self · v` for a matrix `v`.
    #[inline(always)]
    pub(super) fn times(&self, v: &Self) -> Self {
        let mut product = Self::zeros(self.rows, v.columns());
        for j in 0..v.columns() {
            let to = &mut product.all[j * self.stride..][..self.stride];
            for k in 0..v.rows {
                let factor = -v.at(k, j);
                for (to, from) in to.iter_mut().zip(self.column(k)) {
                    to.subtract(from, factor);
                }
            }
        }
        product
    }

    /// `uᵀ self` for a column `u`, as a column.
    #[inline(always)]
    pub(super) fn transposed_times(&self, u: &Self) -> Self {
        let mut product = Self::zeros(self.columns(), 1);
        for k in 0..self.columns() {
            product.set(k, 0, dot(self.column(k), u.column(0)));
        }
        product
    }

    /// Subtracts another matrix of the same size.
    #[inline(always)]
    pub(super) fn subtract(&mut self, other: &Self) {
        for (to, from) in self.all.iter_mut().zip(&other.all) {
            to.subtract(from, Complex64::from(1.0));
        }
    }

    /// Scales to unit norm; the norm before.
    #[inline(always)]
    pub(super) fn normalise(&mut self) -> f64 {
        let squares: f64 = self
            .all
            .iter()
            .map(|r| {
                (0..WIDTH)
                    .map(|e| r.re[e] * r.re[e] + r.im[e] * r.im[e])
                    .sum::<f64>()
            })
            .sum();
        let size = squares.sqrt();
        for rows in &mut self.all {
            for e in 0..WIDTH {
                rows.re[e] /= size;
                rows.im[e] /= size;
            }
        }
        size
    }

    /// `uᵀ v` of two columns.
    #[inline(always)]
    pub(super) fn dot(&self, v: &Self) -> Complex64 {
        dot(self.column(0), v.column(0))
    }

    #[inline(always)]
    pub(super) fn swap(&mut self, a: usize, b: usize) {
        if a != b {
            for j in 0..self.columns() {
                let (x, y) = (self.at(a, j), self.at(b, j));
                self.set(a, j, y);
                self.set(b, j, x);
            }
        }
    }
}

#[inline(always)]
pub(super) fn entry(column: &[EntryBlock], i: usize) -> Complex64 {
    let rows = &column[i / WIDTH];
    Complex64::new(rows.re[i % WIDTH], rows.im[i % WIDTH])
}

/// `aᵀ b` in eight sums that are added at the end.
#[inline(always)]
pub(super) fn dot(a: &[EntryBlock], b: &[EntryBlock]) -> Complex64 {
    let mut sums = EntryBlock::ZERO;
    for (a, b) in a.iter().zip(b) {
        for e in 0..WIDTH {
            sums.re[e] += a.re[e] * b.re[e] - a.im[e] * b.im[e];
        }
        for e in 0..WIDTH {
            sums.im[e] += a.re[e] * b.im[e] + a.im[e] * b.re[e];
        }
    }
    Complex64::new(total(&sums.re), total(&sums.im))
}

/// The sum of eight numbers, by halves.
#[inline(always)]
fn total(x: &[f64; WIDTH]) -> f64 {
    ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]))
}
