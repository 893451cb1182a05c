//! Small complex systems of equations by Gaussian elimination with row pivoting, as they are solved for every mode of a bridge
//! at every wind speed. Real and imaginary parts lie apart, column after column, so that a step works on whole vectors of the
//! processor; the order of the sums, and so the bits, are the same on every processor.

use nalgebra::{Complex, DMatrix};

type Complex64 = Complex<f64>;

/// A complex matrix, column by column.
#[derive(Debug, Clone)]
pub(super) struct Parts {
    rows: usize,
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Parts {
    pub fn zeros(rows: usize, columns: usize) -> Self {
        let zeros = vec![0.0; rows * columns];
        Self {
            rows,
            re: zeros.clone(),
            im: zeros,
        }
    }

    pub fn of(matrix: &DMatrix<Complex64>) -> Self {
        Self {
            rows: matrix.nrows(),
            re: matrix.iter().map(|z| z.re).collect(),
            im: matrix.iter().map(|z| z.im).collect(),
        }
    }

    fn columns(&self) -> usize {
        self.re.len() / self.rows.max(1)
    }

    fn at(&self, i: usize, j: usize) -> Complex64 {
        let place = j * self.rows + i;
        Complex64::new(self.re[place], self.im[place])
    }

    pub fn to_matrix(&self) -> DMatrix<Complex64> {
        DMatrix::from_fn(self.rows, self.columns(), |i, j| self.at(i, j))
    }

    /// Adds a real matrix of the same size times a complex number.
    #[inline(always)]
    pub fn add(&mut self, factor: Complex64, matrix: &[f64]) {
        for ((re, im), m) in self.re.iter_mut().zip(&mut self.im).zip(matrix) {
            *re += factor.re * m;
            *im += factor.im * m;
        }
    }

    /// `self · v` for a matrix `v`.
    #[inline(always)]
    pub fn times(&self, v: &Self) -> Self {
        let mut product = Self::zeros(self.rows, v.columns());
        for (j, (re, im)) in product
            .re
            .chunks_exact_mut(self.rows)
            .zip(product.im.chunks_exact_mut(self.rows))
            .enumerate()
        {
            for k in 0..v.rows {
                subtract((re, im), self.column(k), -v.at(k, j));
            }
        }
        product
    }

    #[inline(always)]
    fn column(&self, j: usize) -> (&[f64], &[f64]) {
        let range = j * self.rows..(j + 1) * self.rows;
        (&self.re[range.clone()], &self.im[range])
    }

    /// The solution `x` of `self · x = sides`; `None` where the matrix is singular or not finite.
    #[inline(always)]
    pub fn solve(mut self, mut sides: Self) -> Option<Self> {
        let n = self.rows;
        for k in 0..n {
            let pivot = self.pivot(k)?;
            self.swap(k, pivot);
            sides.swap(k, pivot);
            let inverse = self.at(k, k).inv();
            let (re, re_after) = self.re.split_at_mut((k + 1) * n);
            let (im, im_after) = self.im.split_at_mut((k + 1) * n);
            let (re, im) = (&mut re[k * n + k + 1..], &mut im[k * n + k + 1..]);
            for (re, im) in re.iter_mut().zip(im.iter_mut()) {
                let scaled = Complex64::new(*re, *im) * inverse;
                (*re, *im) = (scaled.re, scaled.im);
            }
            let after = re_after
                .chunks_exact_mut(n)
                .zip(im_after.chunks_exact_mut(n));
            let sides = sides
                .re
                .chunks_exact_mut(n)
                .zip(sides.im.chunks_exact_mut(n));
            for (of_re, of_im) in after.chain(sides) {
                let factor = Complex64::new(of_re[k], of_im[k]);
                subtract((&mut of_re[k + 1..], &mut of_im[k + 1..]), (re, im), factor);
            }
        }
        self.substitute(&mut sides);
        Some(sides)
    }

    /// From the last row up.
    #[inline(always)]
    fn substitute(&self, sides: &mut Self) {
        let n = self.rows;
        for k in (0..n).rev() {
            let inverse = self.at(k, k).inv();
            let (re, im) = self.column(k);
            let all = sides.re.chunks_exact_mut(n);
            for (of_re, of_im) in all.zip(sides.im.chunks_exact_mut(n)) {
                let x = Complex64::new(of_re[k], of_im[k]) * inverse;
                (of_re[k], of_im[k]) = (x.re, x.im);
                subtract((&mut of_re[..k], &mut of_im[..k]), (&re[..k], &im[..k]), x);
            }
        }
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
            for part in [&mut self.re, &mut self.im] {
                part.chunks_exact_mut(self.rows).for_each(|c| c.swap(a, b));
            }
        }
    }
}

/// Subtracts a column times a complex number.
#[inline(always)]
fn subtract(
    (to_re, to_im): (&mut [f64], &mut [f64]),
    (re, im): (&[f64], &[f64]),
    factor: Complex64,
) {
    let to = to_re.iter_mut().zip(to_im);
    for ((to_re, to_im), (re, im)) in to.zip(re.iter().zip(im)) {
        *to_re -= factor.re * re - factor.im * im;
        *to_im -= factor.re * im + factor.im * re;
    }
}

/// The solution `x` of `a x = sides`, compiled for the vectors of the processor; `None` where `a` is singular or not finite.
pub(super) fn solve(
    a: &DMatrix<Complex64>,
    sides: &DMatrix<Complex64>,
) -> Option<DMatrix<Complex64>> {
    let solve = Solve(Parts::of(a), Parts::of(sides));
    Some(pulp::Arch::new().dispatch(solve)?.to_matrix())
}

struct Solve(Parts, Parts);

impl pulp::NullaryFnOnce for Solve {
    type Output = Option<Parts>;

    #[inline(always)]
    fn call(self) -> Option<Parts> {
        self.0.solve(self.1)
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
