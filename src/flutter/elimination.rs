//! Small complex systems of equations by Gaussian elimination with row pivoting, as they are solved for every mode of a bridge
//! at every wind speed. Real and imaginary parts of eight rows lie together, each column padded to whole eights, so that every
//! step works on full vectors of the processor; the order of the sums, and so the bits, are the same on every processor.

use nalgebra::{Complex, DMatrix};

type Complex64 = Complex<f64>;

/// Rows that lie together.
const WIDTH: usize = 8;

/// Eight rows of one column.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct Rows {
    re: [f64; WIDTH],
    im: [f64; WIDTH],
}

impl Rows {
    const ZERO: Self = Self {
        re: [0.0; WIDTH],
        im: [0.0; WIDTH],
    };

    /// Of these rows, of which the first is row `first`, the ones that are named; zero in place of the others.
    #[inline(always)]
    fn kept(&self, first: usize, keep: impl Fn(usize) -> bool) -> Self {
        let mut kept = Self::ZERO;
        for e in 0..WIDTH {
            let here = keep(first + e);
            kept.re[e] = if here { self.re[e] } else { 0.0 };
            kept.im[e] = if here { self.im[e] } else { 0.0 };
        }
        kept
    }

    /// Subtracts other rows times a complex number.
    #[inline(always)]
    fn subtract(&mut self, other: &Self, factor: Complex64) {
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
    all: Vec<Eight>,
}

/// Eight rows of one column.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct Eight([f64; WIDTH]);

impl RealColumns {
    pub fn of(matrix: &DMatrix<f64>) -> Self {
        let stride = matrix.nrows().div_ceil(WIDTH);
        let mut all = vec![Eight([0.0; WIDTH]); stride * matrix.ncols()];
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

/// A real matrix in a sum, the number it is multiplied with, and that number's derivative.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term<'a> {
    pub value: Complex64,
    pub slope: Complex64,
    pub matrix: &'a RealColumns,
}

/// A complex matrix, column by column.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    rows: usize,
    /// Eights of one column.
    stride: usize,
    all: Vec<Rows>,
}

impl Columns {
    pub fn zeros(rows: usize, columns: usize) -> Self {
        let stride = rows.div_ceil(WIDTH);
        Self {
            rows,
            stride,
            all: vec![Rows::ZERO; stride * columns],
        }
    }

    pub fn of(matrix: &DMatrix<Complex64>) -> Self {
        let mut all = Self::zeros(matrix.nrows(), matrix.ncols());
        for (j, column) in matrix.column_iter().enumerate() {
            for (i, z) in column.iter().enumerate() {
                all.set(i, j, *z);
            }
        }
        all
    }

    pub fn to_matrix(&self) -> DMatrix<Complex64> {
        DMatrix::from_fn(self.rows, self.columns(), |i, j| self.at(i, j))
    }

    /// The sum of the terms and its derivative.
    #[inline(always)]
    pub fn sum(terms: &[Term<'_>]) -> (Self, Self) {
        let (rows, eights) = terms.first().map_or((0, 0), |t| {
            let matrix = t.matrix;
            (matrix.rows, matrix.all.len())
        });
        let both = (0..eights).map(|i| {
            let (mut value, mut slope) = (Rows::ZERO, Rows::ZERO);
            for term in terms {
                let m = &term.matrix.all[i].0;
                for e in 0..WIDTH {
                    value.re[e] += term.value.re * m[e];
                    value.im[e] += term.value.im * m[e];
                    slope.re[e] += term.slope.re * m[e];
                    slope.im[e] += term.slope.im * m[e];
                }
            }
            (value, slope)
        });
        let (value, slope) = both.unzip();
        let stride = rows.div_ceil(WIDTH);
        let of = |all| Self { rows, stride, all };
        (of(value), of(slope))
    }

    fn columns(&self) -> usize {
        self.all.len() / self.stride.max(1)
    }

    #[inline(always)]
    pub fn at(&self, i: usize, j: usize) -> Complex64 {
        let rows = &self.all[j * self.stride + i / WIDTH];
        Complex64::new(rows.re[i % WIDTH], rows.im[i % WIDTH])
    }

    #[inline(always)]
    fn set(&mut self, i: usize, j: usize, z: Complex64) {
        let rows = &mut self.all[j * self.stride + i / WIDTH];
        (rows.re[i % WIDTH], rows.im[i % WIDTH]) = (z.re, z.im);
    }

    #[inline(always)]
    fn column(&self, j: usize) -> &[Rows] {
        &self.all[j * self.stride..][..self.stride]
    }

    /// `self · v` for a matrix `v`.
    #[inline(always)]
    pub fn times(&self, v: &Self) -> Self {
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
    pub fn transposed_times(&self, u: &Self) -> Self {
        let mut product = Self::zeros(self.columns(), 1);
        for k in 0..self.columns() {
            product.set(k, 0, dot(self.column(k), u.column(0)));
        }
        product
    }

    /// `uᵀ v` of two columns.
    #[inline(always)]
    pub fn dot(&self, v: &Self) -> Complex64 {
        dot(self.column(0), v.column(0))
    }

    /// Lower and upper triangle; `None` where the matrix is singular or not finite.
    #[inline(always)]
    pub fn factors(mut self) -> Option<Factors> {
        let (n, stride) = (self.rows, self.stride);
        let mut below = vec![Rows::ZERO; stride];
        let mut swaps = Vec::with_capacity(n);
        for k in 0..n {
            let pivot = self.pivot(k)?;
            self.swap(k, pivot);
            swaps.push(pivot);
            let inverse = self.at(k, k).inv();
            for i in k + 1..n {
                self.set(i, k, self.at(i, k) * inverse);
            }
            let first = (k + 1) / WIDTH;
            let (done, after) = self.all.split_at_mut((k + 1) * stride);
            for i in first..stride {
                below[i] = done[k * stride + i].kept(i * WIDTH, |row| row > k);
            }
            for column in after.chunks_exact_mut(stride) {
                let factor = entry(column, k);
                for (to, from) in column[first..].iter_mut().zip(&below[first..]) {
                    to.subtract(from, factor);
                }
            }
        }
        Some(Factors { lu: self, swaps })
    }

    /// Row at or below `k` with the largest entry of column `k`.
    #[inline(always)]
    fn pivot(&self, k: usize) -> Option<usize> {
        let mut best = (0.0, None);
        for i in k..self.rows {
            let size = self.at(i, k).norm_sqr();
            if size > best.0 {
                best = (size, Some(i));
            }
        }
        best.1.filter(|_| best.0.is_finite())
    }

    #[inline(always)]
    fn swap(&mut self, a: usize, b: usize) {
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
fn entry(column: &[Rows], i: usize) -> Complex64 {
    let rows = &column[i / WIDTH];
    Complex64::new(rows.re[i % WIDTH], rows.im[i % WIDTH])
}

/// `aᵀ b` in eight sums that are added at the end.
#[inline(always)]
fn dot(a: &[Rows], b: &[Rows]) -> Complex64 {
    let mut sums = Rows::ZERO;
    for (a, b) in a.iter().zip(b) {
        for e in 0..WIDTH {
            sums.re[e] += a.re[e] * b.re[e] - a.im[e] * b.im[e];
            sums.im[e] += a.re[e] * b.im[e] + a.im[e] * b.re[e];
        }
    }
    Complex64::new(sums.re.iter().sum(), sums.im.iter().sum())
}

/// A matrix as the product of its triangles, its rows in another order.
#[derive(Debug)]
pub(super) struct Factors {
    /// Multipliers below the diagonal, the upper triangle on and above it.
    lu: Columns,
    /// The row with which each was exchanged, in turn.
    swaps: Vec<usize>,
}

impl Factors {
    /// The solution `x` of `A x = sides`.
    #[inline(always)]
    pub fn solve(&self, mut sides: Columns) -> Columns {
        let n = self.lu.rows;
        for (k, row) in self.swaps.iter().enumerate() {
            sides.swap(k, *row);
        }
        for k in 0..n {
            self.take(k, |row| row > k, &mut sides);
        }
        for k in (0..n).rev() {
            let inverse = self.lu.at(k, k).inv();
            for j in 0..sides.columns() {
                sides.set(k, j, sides.at(k, j) * inverse);
            }
            self.take(k, |row| row < k, &mut sides);
        }
        sides
    }

    /// Subtracts row `k` of `sides` times those entries of column `k` whose rows are named.
    #[inline(always)]
    fn take(&self, k: usize, rows: impl Fn(usize) -> bool, sides: &mut Columns) {
        let stride = self.lu.stride;
        for j in 0..sides.columns() {
            let factor = sides.at(k, j);
            let column = &mut sides.all[j * stride..][..stride];
            for (i, (to, from)) in column.iter_mut().zip(self.lu.column(k)).enumerate() {
                to.subtract(&from.kept(i * WIDTH, &rows), factor);
            }
        }
    }

    /// The solution `x` of `Aᵀ x = side`, a column.
    #[inline(always)]
    pub fn solve_transposed(&self, side: &Columns) -> Columns {
        let n = self.lu.rows;
        // what is not found yet is zero, so that a product with a whole column takes what is found
        let (mut y, mut x) = (Columns::zeros(n, 1), Columns::zeros(n, 1));
        for k in 0..n {
            let known = dot(self.lu.column(k), y.column(0));
            y.set(k, 0, (side.at(k, 0) - known) / self.lu.at(k, k));
        }
        for k in (0..n).rev() {
            let known = dot(self.lu.column(k), x.column(0));
            x.set(k, 0, y.at(k, 0) - known);
        }
        for (k, row) in self.swaps.iter().enumerate().rev() {
            x.swap(k, *row);
        }
        x
    }
}

/// The solution `x` of `a x = sides`, compiled for the vectors of the processor; `None` where `a` is singular or not finite.
pub(super) fn solve(
    a: &DMatrix<Complex64>,
    sides: &DMatrix<Complex64>,
) -> Option<DMatrix<Complex64>> {
    let solve = Solve(Columns::of(a), Columns::of(sides));
    Some(pulp::Arch::new().dispatch(solve)?.to_matrix())
}

struct Solve(Columns, Columns);

impl pulp::NullaryFnOnce for Solve {
    type Output = Option<Columns>;

    #[inline(always)]
    fn call(self) -> Option<Columns> {
        Some(self.0.factors()?.solve(self.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the decomposition of nalgebra, on matrices whose pivots stand off the diagonal.
    #[test]
    fn solutions_are_those_of_a_decomposition() {
        for n in [1, 2, 5, 39] {
            let entry = |i: usize, j: usize| {
                let x = (7 * i + 13 * j + 3) as f64;
                Complex64::new((x * x).sin(), (0.7 * x).cos())
            };
            let a = DMatrix::from_fn(n, n, |i, j| {
                if i == j {
                    Complex64::default()
                } else {
                    entry(i, j)
                }
            }) + DMatrix::from_fn(n, n, |i, j| {
                Complex64::from(f64::from(u8::from((i + 1) % n == j)))
            });
            let sides = DMatrix::from_fn(n, 2, |i, j| entry(j, i));
            let expected = a.clone().lu().solve(&sides).expect("a regular matrix");
            let found = solve(&a, &sides).expect("a solution");
            assert!((&found - &expected).norm() < 1e-11 * expected.norm(), "{n}");
            assert!((&a * found - &sides).norm() < 1e-12 * sides.norm() * n as f64);
            let side = sides.columns(0, 1).into_owned();
            let factors = Columns::of(&a).factors().expect("a regular matrix");
            let of_transposed = factors.solve_transposed(&Columns::of(&side)).to_matrix();
            assert!((a.transpose() * of_transposed - &side).norm() < 1e-11 * side.norm());
        }
    }

    #[test]
    fn singular_and_not_finite_matrices_have_no_solution() {
        let side = DMatrix::from_element(2, 1, Complex64::from(1.0));
        for bad in [0.0, f64::NAN, f64::INFINITY] {
            let a = DMatrix::from_element(2, 2, Complex64::from(bad));
            assert!(solve(&a, &side).is_none(), "{bad}");
        }
    }
}
