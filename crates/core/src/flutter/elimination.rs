//! Small complex systems of equations by Gaussian elimination with row pivoting, as they are solved for every mode of a bridge
//! at every wind speed.

use super::columns::{ComplexColumns, EntryBlock, WIDTH, dot, entry};
use crate::state_space::Complex64;
use nalgebra::DMatrix;
use std::ops::Range;

impl ComplexColumns {
    /// Lower and upper triangle; `None` where the matrix is singular or not finite.
    #[inline(always)]
    pub(super) fn factors(mut self) -> Option<Factors> {
        let (n, stride) = (self.rows, self.stride);
        let mut below = vec![EntryBlock::ZERO; stride];
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
}

/// A matrix as the product of its triangles, its rows in another order.
#[derive(Debug)]
pub(super) struct Factors {
    /// Multipliers below the diagonal, the upper triangle on and above it.
    lu: ComplexColumns,
    /// The row with which each was exchanged, in turn.
    swaps: Vec<usize>,
}

impl Factors {
    /// Numbers whose product is the determinant.
    pub(super) fn pivots(&self) -> impl Iterator<Item = Complex64> {
        let all = self.swaps.iter().enumerate();
        all.map(|(k, row)| {
            let pivot = self.lu.at(k, k);
            if k == *row { pivot } else { -pivot }
        })
    }

    /// The solution `x` of `A x = sides`.
    #[inline(always)]
    pub(super) fn solve(&self, mut sides: ComplexColumns) -> ComplexColumns {
        let n = self.lu.rows;
        for (k, row) in self.swaps.iter().enumerate() {
            sides.swap(k, *row);
        }
        for k in 0..n {
            self.take(k, k + 1..n, &mut sides);
        }
        for k in (0..n).rev() {
            let inverse = self.lu.at(k, k).inv();
            for j in 0..sides.columns() {
                sides.set(k, j, sides.at(k, j) * inverse);
            }
            self.take(k, 0..k, &mut sides);
        }
        sides
    }

    /// Subtracts row `k` of `sides` times those entries of column `k` that stand in `rows`.
    #[inline(always)]
    fn take(&self, k: usize, rows: Range<usize>, sides: &mut ComplexColumns) {
        let (stride, from) = (self.lu.stride, self.lu.column(k));
        for j in 0..sides.columns() {
            let factor = sides.at(k, j);
            let column = &mut sides.all[j * stride..][..stride];
            for i in rows.start / WIDTH..rows.end.div_ceil(WIDTH) {
                let kept = from[i].kept(i * WIDTH, |row| rows.contains(&row));
                column[i].subtract(&kept, factor);
            }
        }
    }

    /// The solution `x` of `Aᵀ x = side`, a column.
    #[inline(always)]
    pub(super) fn solve_transposed(&self, side: &ComplexColumns) -> ComplexColumns {
        let n = self.lu.rows;
        // what is not found yet is zero, so that a product with a whole column takes what is found
        let (mut y, mut x) = (ComplexColumns::zeros(n, 1), ComplexColumns::zeros(n, 1));
        for k in 0..n {
            let to = k.div_ceil(WIDTH);
            let known = dot(&self.lu.column(k)[..to], &y.column(0)[..to]);
            y.set(k, 0, (side.at(k, 0) - known) / self.lu.at(k, k));
        }
        for k in (0..n).rev() {
            let from = (k + 1) / WIDTH;
            let known = dot(&self.lu.column(k)[from..], &x.column(0)[from..]);
            x.set(k, 0, y.at(k, 0) - known);
        }
        for (k, row) in self.swaps.iter().enumerate().rev() {
            x.swap(k, *row);
        }
        x
    }
}

/// The solution `x` of `a x = sides`, n×n and n×m, compiled for the vectors of the processor; `None` where `a` is singular or not
/// finite.
pub fn solve_complex(
    a: &DMatrix<Complex64>,
    sides: &DMatrix<Complex64>,
) -> Option<DMatrix<Complex64>> {
    Some(solution(ComplexColumns::new(a), ComplexColumns::new(sides))?.to_matrix())
}

/// Numbers whose product is the determinant of `a`, n×n: that of many modes is beyond all numbers. `None` as for
/// [`solve_complex`].
pub fn pivots(a: &DMatrix<Complex64>) -> Option<Vec<Complex64>> {
    let factors = triangles(ComplexColumns::new(a))?;
    Some(factors.pivots().collect())
}

vectorised! {
    fn solution(a: ComplexColumns, sides: ComplexColumns) -> Option<ComplexColumns> {
        Some(a.factors()?.solve(sides))
    }

    fn triangles(a: ComplexColumns) -> Option<Factors> {
        a.factors()
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
            let found = solve_complex(&a, &sides).expect("a solution");
            assert!((&found - &expected).norm() < 1e-11 * expected.norm(), "{n}");
            assert!((&a * found - &sides).norm() < 1e-12 * sides.norm() * n as f64);
            let side = sides.columns(0, 1).into_owned();
            let factors = ComplexColumns::new(&a).factors().expect("a regular matrix");
            let of_transposed = factors
                .solve_transposed(&ComplexColumns::new(&side))
                .to_matrix();
            assert!((a.transpose() * of_transposed - &side).norm() < 1e-11 * side.norm());
        }
    }

    #[test]
    fn singular_and_not_finite_matrices_have_no_solution() {
        let side = DMatrix::from_element(2, 1, Complex64::from(1.0));
        for bad in [0.0, f64::NAN, f64::INFINITY] {
            let a = DMatrix::from_element(2, 2, Complex64::from(bad));
            assert!(solve_complex(&a, &side).is_none(), "{bad}");
        }
    }
}
