//! The way through the interior of the cones, by Newton's steps towards the answer.

use super::second_order::{
    Cone, Scaling, Vector, determinant, dot, product, quotient, reach, tail,
};
use crate::error::{Error, Result};
use crate::identification::least_squares::subtract;
use aerodeck_core::vectorised;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::array::from_fn;

/// Steps at most; fifteen are the rule.
const STEPS: usize = 60;
/// Gap between the objectives, relative to the objective, at which the answer is exact to rounding.
const GAP: f64 = 1e-15;
/// The same at which an answer that no step improves any more is taken.
const GAP_TAKEN: f64 = 1e-6;
/// Share of the way to the boundary that a step takes.
const SHORT_OF_BOUNDARY: f64 = 0.99;
/// Refinements of a direction at most.
const REFINEMENTS: usize = 6;

/// All cones as one system `rows w + s = bound`.
pub(super) struct Problem {
    /// Places of the rows of each cone in `rows`.
    spans: Vec<(usize, usize)>,
    rows: DMatrix<f64>,
    bound: Vec<Vector>,
}

/// A point of the way: vector, slacks, multipliers.
#[derive(Clone)]
pub(super) struct Point {
    pub w: DVector<f64>,
    pub s: Vec<Vector>,
    pub z: Vec<Vector>,
}

impl Problem {
    pub(super) fn new(cones: &[Cone], seen: &[usize], unit: f64) -> Self {
        let mut end = 0;
        let span = |cone: &Cone| {
            end += cone.rows.len();
            (end - cone.rows.len(), cone.rows.len())
        };
        let spans = cones.iter().map(span).collect();
        let all: Vec<&DVector<f64>> = cones.iter().flat_map(|c| &c.rows).collect();
        Self {
            spans,
            rows: DMatrix::from_fn(all.len(), seen.len(), |r, c| all[r][seen[c]]),
            bound: cones.iter().map(|c| c.bound.map(|b| b / unit)).collect(),
        }
    }

    /// Rows, cone by cone.
    fn cut(&self, all: &DVector<f64>) -> Vec<Vector> {
        let of =
            |&(at, count): &(usize, usize)| from_fn(|r| if r < count { all[at + r] } else { 0.0 });
        self.spans.iter().map(of).collect()
    }

    /// The same as one vector.
    fn flat(&self, each: &[Vector]) -> DVector<f64> {
        let mut all = DVector::zeros(self.rows.nrows());
        for (&(at, count), v) in self.spans.iter().zip(each) {
            write(&mut all.as_mut_slice()[at..at + count], v);
        }
        all
    }

    /// `rows w`, cone by cone.
    fn times(&self, w: &DVector<f64>) -> Vec<Vector> {
        self.cut(&times(&self.rows, w))
    }

    /// `rowsᵀ z`.
    fn transposed(&self, z: &[Vector]) -> DVector<f64> {
        transposed_times(&self.rows, &self.flat(z))
    }

    pub(super) fn solve(&self) -> Result<Point> {
        let mut at = self.start();
        let mut best = (f64::INFINITY, at.clone());
        for _ in 0..STEPS {
            let gap: f64 = at.s.iter().zip(&at.z).map(|(s, z)| dot(s, z)).sum();
            let moved = self.times(&at.w);
            let short = |c: usize| from_fn(|r| moved[c][r] + at.s[c][r] - self.bound[c][r]);
            let short: Vec<Vector> = (0..at.s.len()).map(short).collect();
            let uneven = &at.w + self.transposed(&at.z);
            let infeasible = short.iter().flatten().fold(0.0, |a: f64, x| a.max(x.abs()));
            // the maximum passes over what is not a number
            if !(gap + moved.iter().flatten().sum::<f64>()).is_finite() {
                break;
            }
            let size = at.w.norm_squared().max(f64::MIN_POSITIVE);
            let error = (gap / size).max(infeasible * infeasible / size);
            let error = error.max(uneven.norm_squared() / size);
            if error < best.0 {
                best = (error, at.clone());
            }
            if error < GAP {
                break;
            }
            match self.step(&at, &short, &uneven, gap) {
                Some(next) => at = next,
                None => break,
            }
        }
        let (error, at) = best;
        if error < GAP_TAKEN {
            Ok(at)
        } else {
            Err(contradiction())
        }
    }

    /// Zero, the slacks moved into their cones, and the multipliers that are central to them.
    fn start(&self) -> Point {
        let inside = |v: &Vector| [v[0].max(tail(v) + 1.0), v[1], v[2]];
        let s: Vec<Vector> = self.bound.iter().map(inside).collect();
        let central = |s: &Vector| {
            let size = determinant(s);
            [s[0] / size, -s[1] / size, -s[2] / size]
        };
        Point {
            w: DVector::zeros(self.rows.ncols()),
            z: s.iter().map(central).collect(),
            s,
        }
    }

    fn step(&self, at: &Point, short: &[Vector], uneven: &DVector<f64>, gap: f64) -> Option<Point> {
        let cones = at.s.len();
        let scalings = at.s.iter().zip(&at.z).map(|(s, z)| Scaling::new(s, z));
        let scalings = scalings.collect::<Option<Vec<_>>>()?;
        // W⁻¹ rows
        let mut scaled = self.rows.clone();
        let rows = scaled.nrows().max(1);
        for column in scaled.as_mut_slice().chunks_exact_mut(rows) {
            for (&(first, count), scaling) in self.spans.iter().zip(&scalings) {
                let part = &mut column[first..first + count];
                let v = scaling.divide(&from_fn(|r| part.get(r).copied().unwrap_or(0.0)));
                write(part, &v);
            }
        }
        let factor = one_plus_gram(&scaled).cholesky()?;
        let direction = |wanted: &[Vector]| -> (DVector<f64>, Vec<Vector>, Vec<Vector>) {
            // W⁻¹ (short − W (λ \ wanted))
            let rest = |c: usize| {
                let back = quotient(&scalings[c].lambda, &wanted[c]);
                let short = scalings[c].divide(&short[c]);
                from_fn(|r| short[r] - back[r])
            };
            let rest: Vec<Vector> = (0..cones).map(rest).collect();
            let (w, left) = refined(&scaled, &factor, &self.flat(&rest), uneven);
            let left = self.cut(&left);
            let along = self.times(&w);
            let z = (0..cones).map(|c| scalings[c].divide(&left[c]));
            let s = (0..cones).map(|c| from_fn(|r| -short[c][r] - along[c][r]));
            (w, s.collect(), z.collect())
        };
        let squared = |c: usize| product(&scalings[c].lambda, &scalings[c].lambda);
        let affine: Vec<Vector> = (0..cones).map(squared).collect();
        let (_, s, z) = direction(&affine);
        let reach = reach(&at.s, &s).min(reach(&at.z, &z)).min(1.0);
        let gap_left = |c: usize| {
            let s: Vector = from_fn(|r| at.s[c][r] + reach * s[c][r]);
            let z: Vector = from_fn(|r| at.z[c][r] + reach * z[c][r]);
            dot(&s, &z)
        };
        let left: f64 = (0..cones).map(gap_left).sum();
        let centre = (left / gap).clamp(0.0, 1.0).powi(3) * gap / cones as f64;
        let corrected = |c: usize| {
            let second = product(&scalings[c].divide(&s[c]), &scalings[c].times(&z[c]));
            let mut all: Vector = from_fn(|r| affine[c][r] + second[r]);
            all[0] -= centre;
            all
        };
        let corrected: Vec<Vector> = (0..cones).map(corrected).collect();
        let (w, s, z) = direction(&corrected);
        let length =
            (SHORT_OF_BOUNDARY * self::reach(&at.s, &s).min(self::reach(&at.z, &z))).min(1.0);
        let moved = |from: &[Vector], by: &[Vector]| -> Vec<Vector> {
            let one = |(a, b): (&Vector, &Vector)| from_fn(|r| a[r] + length * b[r]);
            from.iter().zip(by).map(one).collect()
        };
        Some(Point {
            w: &at.w + w * length,
            s: moved(&at.s, &s),
            z: moved(&at.z, &z),
        })
    }
}

/// The `w` of `min ‖B w + b‖² + ‖w + a‖²` by the Cholesky factor of `I + BᵀB`, and `y = B w + b`. Rows of cones that hold the answer
/// are larger than the others by many digits, which the factor loses and refinement of both together brings back (Björck 1967).
fn refined(
    rows: &DMatrix<f64>,
    factor: &Cholesky<f64, Dyn>,
    b: &DVector<f64>,
    a: &DVector<f64>,
) -> (DVector<f64>, DVector<f64>) {
    let mut w = DVector::zeros(a.len());
    let mut y = DVector::zeros(b.len());
    // of nothing, whose products are nothing
    let (mut first, mut second) = (-a, -b);
    let mut before = f64::INFINITY;
    for _ in 0..=REFINEMENTS {
        let left = first.norm_squared() + second.norm_squared();
        if left == 0.0 || left > 0.1 * before {
            break;
        }
        before = left;
        let right = first + transposed_times(rows, &second);
        let by = factor.solve(&right);
        y += times(rows, &by) - second;
        w += by;
        first = -a - &w - transposed_times(rows, &y);
        second = &y - b - times(rows, &w);
    }
    (w, y)
}

/// As many numbers of a cone as it has rows.
fn write(rows: &mut [f64], v: &Vector) {
    // so few are no copy of memory
    match rows {
        [all] => *all = v[0],
        [t, x, y] => [*t, *x, *y] = *v,
        _ => {}
    }
}

vectorised! {
    /// `rows w`.
    fn times<'a>(rows: &'a DMatrix<f64>, w: &'a DVector<f64>) -> DVector<f64> {
        let mut sum = DVector::zeros(rows.nrows());
        for (column, w) in rows.as_slice().chunks_exact(rows.nrows().max(1)).zip(w) {
            subtract(sum.as_mut_slice(), -w, column);
        }
        sum
    }

    /// `rowsᵀ y`.
    fn transposed_times<'a>(rows: &'a DMatrix<f64>, y: &'a DVector<f64>) -> DVector<f64> {
        let columns = rows.as_slice().chunks_exact(rows.nrows().max(1));
        let mut products = DVector::zeros(rows.ncols());
        for (product, column) in products.iter_mut().zip(columns) {
            *product = in_eight_parts(column, y.as_slice());
        }
        products
    }

    /// `I + rowsᵀ rows`.
    fn one_plus_gram<'a>(rows: &'a DMatrix<f64>) -> DMatrix<f64> {
        let columns = rows.as_slice().chunks_exact(rows.nrows().max(1));
        let mut gram = DMatrix::identity(rows.ncols(), rows.ncols());
        for (i, one) in columns.clone().enumerate() {
            for (j, other) in columns.clone().enumerate().take(i + 1) {
                gram[(i, j)] += in_eight_parts(one, other);
                gram[(j, i)] = gram[(i, j)];
            }
        }
        gram
    }
}

/// `a·b` in eight partial sums, which the processor works on side by side.
#[inline(always)]
fn in_eight_parts(a: &[f64], b: &[f64]) -> f64 {
    let (a_blocks, a_rest) = a.as_chunks::<8>();
    let (b_blocks, b_rest) = b.as_chunks::<8>();
    let mut parts = [0.0; 8];
    for (x, y) in a_blocks.iter().zip(b_blocks) {
        for (part, (x, y)) in parts.iter_mut().zip(x.iter().zip(y)) {
            *part += x * y;
        }
    }
    let sum = (0..4).fold(0.0, |sum, i| sum + (parts[i] + parts[i + 4]));
    let rest = a_rest.iter().zip(b_rest);
    rest.fold(sum, |sum, (x, y)| sum + x * y)
}

pub(super) fn contradiction() -> Error {
    Error::Numerical("constraints of the fit that contradict each other".into())
}
