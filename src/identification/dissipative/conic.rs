//! The shortest vector under linear matrix inequalities of order one and two.
//!
//! `S = [s₁₁ s₁₂; s₁₂ s₂₂] ⪰ 0` says `t ≥ ‖(x, y)‖` for `t = (s₁₁ + s₂₂)/√2`, `x = (s₁₁ − s₂₂)/√2`, `y = √2 s₁₂`: a second-order cone,
//! of which a scalar inequality is the one without `x` and `y`. A primal–dual interior-point method with Nesterov–Todd
//! scaling and Mehrotra's corrector (Vandenberghe, *The CVXOPT linear and quadratic cone program solvers*, 2010) takes some
//! fifteen steps whatever the number of inequalities that hold the answer, each a Cholesky factor of the size of the vector.

use crate::error::{Error, Result};
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

/// `(t, x, y)`.
type Vector = [f64; 3];

/// `bound − rows · w` is in the cone.
#[derive(Debug, Clone)]
pub(super) struct Cone {
    rows: Vec<DVector<f64>>,
    bound: Vector,
}

/// The shortest vector, and which cones hold it.
pub(super) struct Shortest {
    pub w: DVector<f64>,
    pub holds: Vec<bool>,
}

impl Cone {
    /// `gradient · w ≤ bound`.
    pub(super) fn half_space(gradient: DVector<f64>, bound: f64) -> Self {
        Self {
            rows: vec![gradient],
            bound: [bound, 0.0, 0.0],
        }
    }

    /// `Σ gradients w ⪯ bound` for the entries 11, 22, 12 of symmetric matrices of order two.
    pub(super) fn matrix(gradients: [DVector<f64>; 3], bound: Vector) -> Self {
        let [one, two, across] = gradients;
        let root = std::f64::consts::FRAC_1_SQRT_2;
        Self {
            bound: [
                (bound[0] + bound[1]) * root,
                (bound[0] - bound[1]) * root,
                bound[2] / root,
            ],
            rows: vec![(&one + &two) * root, (one - two) * root, across / root],
        }
    }

    /// The same inequality with rows of the size of one.
    fn scaled(&self, factor: f64) -> Self {
        Self {
            rows: self.rows.iter().map(|r| r * factor).collect(),
            bound: self.bound.map(|b| b * factor),
        }
    }

    fn size(&self) -> f64 {
        self.rows
            .iter()
            .map(DVector::norm_squared)
            .sum::<f64>()
            .sqrt()
    }
}

/// The shortest `w` of `size` numbers in all cones.
///
/// # Errors
/// [`Error::Numerical`] for cones that have nothing in common.
pub(super) fn shortest(cones: &[Cone], size: usize) -> Result<Shortest> {
    let unit: Vec<Cone> = cones
        .iter()
        .map(|c| c.scaled(c.size().max(f64::MIN_POSITIVE).recip()))
        .collect();
    // distances of the order of one
    let furthest = unit
        .iter()
        .map(|c| tail(&c.bound) - c.bound[0])
        .fold(0.0, f64::max);
    if !furthest.is_finite() {
        return Err(contradiction());
    }
    if furthest == 0.0 {
        return Ok(Shortest {
            w: DVector::zeros(size),
            holds: vec![false; cones.len()],
        });
    }
    // numbers that no cone looks at stay zero
    let seen: Vec<usize> = (0..size)
        .filter(|&c| unit.iter().any(|u| u.rows.iter().any(|r| r[c] != 0.0)))
        .collect();
    let problem = Problem::new(&unit, &seen, furthest);
    let point = problem.solve()?;
    let mut w = DVector::zeros(size);
    for (&c, x) in seen.iter().zip(&point.w) {
        w[c] = x * furthest;
    }
    let holds = |(s, z): (&Vector, &Vector)| s[0] - tail(s) < z[0] + tail(z);
    Ok(Shortest {
        w,
        holds: point.s.iter().zip(&point.z).map(holds).collect(),
    })
}

fn contradiction() -> Error {
    Error::Numerical("constraints of the fit that contradict each other".into())
}

/// All cones as one system `rows w + s = bound`.
struct Problem {
    /// Places of the rows of each cone in `rows`.
    spans: Vec<(usize, usize)>,
    rows: DMatrix<f64>,
    bound: Vec<Vector>,
}

/// A point of the way: vector, slacks, multipliers.
#[derive(Clone)]
struct Point {
    w: DVector<f64>,
    s: Vec<Vector>,
    z: Vec<Vector>,
}

impl Problem {
    fn new(cones: &[Cone], seen: &[usize], unit: f64) -> Self {
        let mut spans = Vec::new();
        let mut count = 0;
        for cone in cones {
            spans.push((count, cone.rows.len()));
            count += cone.rows.len();
        }
        let all: Vec<&DVector<f64>> = cones.iter().flat_map(|c| &c.rows).collect();
        Self {
            spans,
            rows: DMatrix::from_fn(count, seen.len(), |r, c| all[r][seen[c]]),
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
            all.rows_mut(at, count).copy_from_slice(&v[..count]);
        }
        all
    }

    /// `rows w`, cone by cone.
    fn times(&self, w: &DVector<f64>) -> Vec<Vector> {
        self.cut(&(&self.rows * w))
    }

    /// `rowsᵀ z`.
    fn transposed(&self, z: &[Vector]) -> DVector<f64> {
        self.rows.tr_mul(&self.flat(z))
    }

    fn solve(&self) -> Result<Point> {
        let mut at = self.start();
        let mut best = (f64::INFINITY, at.clone());
        for _ in 0..STEPS {
            let gap: f64 = at.s.iter().zip(&at.z).map(|(s, z)| dot(s, z)).sum();
            let moved = self.times(&at.w);
            let short: Vec<Vector> = (0..at.s.len())
                .map(|c| from_fn(|r| moved[c][r] + at.s[c][r] - self.bound[c][r]))
                .collect();
            let uneven = &at.w + self.transposed(&at.z);
            let infeasible = short.iter().flatten().fold(0.0, |a: f64, x| a.max(x.abs()));
            let size = at.w.norm_squared().max(f64::MIN_POSITIVE);
            let error = (gap / size)
                .max(infeasible * infeasible / size)
                .max(uneven.norm_squared() / size);
            if error < best.0 {
                best = (error, at.clone());
            }
            if error.is_nan() || error < GAP {
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
        let scalings = (0..cones)
            .map(|c| Scaling::new(&at.s[c], &at.z[c]))
            .collect::<Option<Vec<_>>>()?;
        // W⁻¹ rows
        let mut scaled = self.rows.clone();
        for (&(first, count), scaling) in self.spans.iter().zip(&scalings) {
            for mut column in scaled.column_iter_mut() {
                let v: Vector = from_fn(|r| if r < count { column[first + r] } else { 0.0 });
                let v = scaling.divide(&v);
                column.rows_mut(first, count).copy_from_slice(&v[..count]);
            }
        }
        let system = Weighted::new(&scaled)?;
        let direction = |wanted: &[Vector]| -> (DVector<f64>, Vec<Vector>, Vec<Vector>) {
            // W⁻¹ (short − W (λ \ wanted))
            let rest: Vec<Vector> = (0..cones)
                .map(|c| {
                    let back = quotient(&scalings[c].lambda, &wanted[c]);
                    let short = scalings[c].divide(&short[c]);
                    from_fn(|r| short[r] - back[r])
                })
                .collect();
            let (w, left) = system.solve(&self.flat(&rest), uneven);
            let left = self.cut(&left);
            let along = self.times(&w);
            let z = (0..cones).map(|c| scalings[c].divide(&left[c])).collect();
            let s = (0..cones)
                .map(|c| from_fn(|r| -short[c][r] - along[c][r]))
                .collect();
            (w, s, z)
        };
        let squared = |c: usize| product(&scalings[c].lambda, &scalings[c].lambda);
        let affine: Vec<Vector> = (0..cones).map(squared).collect();
        let (_, s, z) = direction(&affine);
        let reach = reach(&at.s, &s).min(reach(&at.z, &z)).min(1.0);
        let left: f64 = (0..cones)
            .map(|c| {
                let s: Vector = from_fn(|r| at.s[c][r] + reach * s[c][r]);
                let z: Vector = from_fn(|r| at.z[c][r] + reach * z[c][r]);
                dot(&s, &z)
            })
            .sum();
        let centre = (left / gap).clamp(0.0, 1.0).powi(3) * gap / cones as f64;
        let corrected: Vec<Vector> = (0..cones)
            .map(|c| {
                let second = product(&scalings[c].divide(&s[c]), &scalings[c].times(&z[c]));
                let mut all: Vector = from_fn(|r| affine[c][r] + second[r]);
                all[0] -= centre;
                all
            })
            .collect();
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

/// `min ‖B w + b‖² + ‖w + a‖²` by the Cholesky factor of `I + BᵀB`. Rows of cones that hold the answer are larger than the
/// others by many digits, which the factor loses and refinement of `w` and `y = B w + b` together brings back (Björck 1967).
struct Weighted<'a> {
    rows: &'a DMatrix<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl<'a> Weighted<'a> {
    fn new(rows: &'a DMatrix<f64>) -> Option<Self> {
        let n = rows.ncols();
        let mut gram = DMatrix::identity(n, n);
        gram.gemm_tr(1.0, rows, rows, 1.0);
        let factor = gram.cholesky()?;
        Some(Self { rows, factor })
    }

    /// `w` and `y`.
    fn solve(&self, b: &DVector<f64>, a: &DVector<f64>) -> (DVector<f64>, DVector<f64>) {
        let mut w = DVector::zeros(a.len());
        let mut y = DVector::zeros(b.len());
        let mut before = f64::INFINITY;
        for _ in 0..=REFINEMENTS {
            let first = -a - &w - self.rows.tr_mul(&y);
            let second = &y - b - self.rows * &w;
            let left = first.norm_squared() + second.norm_squared();
            if left == 0.0 || left > 0.1 * before {
                break;
            }
            before = left;
            let by = self.factor.solve(&(first + self.rows.tr_mul(&second)));
            y += self.rows * &by - second;
            w += by;
        }
        (w, y)
    }
}

/// Nesterov and Todd's scaling `W` with `W z = W⁻¹ s = λ`.
struct Scaling {
    size: f64,
    w: Vector,
    lambda: Vector,
}

impl Scaling {
    fn new(s: &Vector, z: &Vector) -> Option<Self> {
        let (of_s, of_z) = (determinant(s).sqrt(), determinant(z).sqrt());
        let s_bar = s.map(|x| x / of_s);
        let z_bar = z.map(|x| x / of_z);
        let half = (0.5 * (1.0 + dot(&s_bar, &z_bar))).sqrt();
        let w = [
            0.5 * (s_bar[0] + z_bar[0]) / half,
            0.5 * (s_bar[1] - z_bar[1]) / half,
            0.5 * (s_bar[2] - z_bar[2]) / half,
        ];
        let mut scaling = Self {
            size: (of_s / of_z).sqrt(),
            w,
            lambda: [0.0; 3],
        };
        scaling.lambda = scaling.times(z);
        let finite = scaling.lambda.iter().chain(&w).all(|x| x.is_finite());
        (finite && scaling.size > 0.0).then_some(scaling)
    }

    /// `W v`.
    fn times(&self, v: &Vector) -> Vector {
        reflect(&self.w, v).map(|x| x * self.size)
    }

    /// `W⁻¹ v`.
    fn divide(&self, v: &Vector) -> Vector {
        let inverse = [self.w[0], -self.w[1], -self.w[2]];
        reflect(&inverse, v).map(|x| x / self.size)
    }
}

/// `[w₀ w₁ᵀ; w₁ I + w₁w₁ᵀ/(1 + w₀)] v`.
fn reflect(w: &Vector, v: &Vector) -> Vector {
    let along = w[1] * v[1] + w[2] * v[2];
    let share = v[0] + along / (1.0 + w[0]);
    [
        w[0] * v[0] + along,
        v[1] + w[1] * share,
        v[2] + w[2] * share,
    ]
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn tail(v: &Vector) -> f64 {
    (v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// `t² − x² − y²`, without loss near the boundary.
fn determinant(v: &Vector) -> f64 {
    let tail = tail(v);
    (v[0] - tail) * (v[0] + tail)
}

/// Jordan product.
fn product(a: &Vector, b: &Vector) -> Vector {
    [
        dot(a, b),
        a[0] * b[1] + b[0] * a[1],
        a[0] * b[2] + b[0] * a[2],
    ]
}

/// The `q` with `product(a, q) = d`.
fn quotient(a: &Vector, d: &Vector) -> Vector {
    let first = (a[0] * d[0] - a[1] * d[1] - a[2] * d[2]) / determinant(a);
    [
        first,
        (d[1] - first * a[1]) / a[0],
        (d[2] - first * a[2]) / a[0],
    ]
}

/// How many times `by` fits between `from` and the boundaries of the cones.
fn reach(from: &[Vector], by: &[Vector]) -> f64 {
    let one = |(v, d): (&Vector, &Vector)| {
        let a = d[0] * d[0] - d[1] * d[1] - d[2] * d[2];
        let b = v[0] * d[0] - v[1] * d[1] - v[2] * d[2];
        let c = determinant(v);
        let under = b * b - a * c;
        let mut least = f64::INFINITY;
        if under >= 0.0 {
            // the roots of a x² + 2 b x + c, each without cancellation
            let q = -(b + under.sqrt().copysign(b));
            for root in [q / a, c / q] {
                if root > 0.0 && root < least {
                    least = root;
                }
            }
        }
        // the apex of the cone
        if d[0] < 0.0 {
            least = least.min(-v[0] / d[0]);
        }
        least
    };
    from.iter().zip(by).map(one).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vector(x: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(x)
    }

    /// A corner, an edge and an inequality that does not bind, by hand.
    #[test]
    fn shortest_vectors_are_those_of_geometry() {
        let x = Cone::half_space(vector(&[-2.0, 0.0]), -2.0);
        let y = Cone::half_space(vector(&[0.0, -1.0]), -2.0);
        let sum = Cone::half_space(vector(&[-1.0, -1.0]), -1.0);
        let found = shortest(&[x, y, sum.clone()], 2).unwrap();
        assert!((found.w - vector(&[1.0, 2.0])).amax() < 1e-12);
        assert_eq!(found.holds, [true, true, false]);
        let found = shortest(std::slice::from_ref(&sum), 2).unwrap();
        assert!((found.w - vector(&[0.5, 0.5])).amax() < 1e-12);
        let found = shortest(&[Cone::half_space(vector(&[1.0, 0.0]), 3.0)], 2).unwrap();
        assert!(found.w.amax() == 0.0 && found.holds == [false]);
        // 1e-7 in size: as exact as at one
        let tiny = [
            Cone::half_space(vector(&[-2.0, 0.0]), -2e-7),
            Cone::half_space(vector(&[0.0, -1.0]), -2e-7),
        ];
        let found = shortest(&tiny, 2).unwrap();
        assert!((found.w - vector(&[1e-7, 2e-7])).amax() < 1e-19);
    }

    /// The symmetric matrix nearest to a given one with no positive eigenvalue is its negative part (Higham 1988).
    #[test]
    fn nearest_matrices_are_their_negative_parts() {
        let one =
            |i: usize| vector(&[0.0, 1.0, 2.0].map(|k: f64| f64::from(u8::from(k as usize == i))));
        for given in [[2.0, -1.0, 0.7], [3.0, 1.0, -0.2], [-1.0, 1.0, 2.0]] {
            // unknowns a, b, c with A = given + [a, c/√2; c/√2, b], of length the Frobenius norm
            let root = std::f64::consts::FRAC_1_SQRT_2;
            let cone = Cone::matrix(
                [one(0), one(1), one(2) * root],
                [-given[0], -given[1], -given[2]],
            );
            let w = shortest(&[cone], 3).unwrap().w;
            let matrix = DMatrix::from_row_slice(2, 2, &[given[0], given[2], given[2], given[1]]);
            let mut eigen = matrix.symmetric_eigen();
            eigen.eigenvalues.apply(|x| *x = x.min(0.0));
            let nearest = eigen.recompose();
            assert!((w[0] + given[0] - nearest[(0, 0)]).abs() < 1e-10);
            assert!((w[1] + given[1] - nearest[(1, 1)]).abs() < 1e-10);
            assert!((w[2] * root + given[2] - nearest[(0, 1)]).abs() < 1e-10);
        }
    }

    #[test]
    fn contradictions_are_refused() {
        let both = [
            Cone::half_space(vector(&[1.0, 0.0]), -1.0),
            Cone::half_space(vector(&[-1.0, 0.0]), -1.0),
        ];
        assert!(shortest(&both, 2).is_err());
        assert!(shortest(&[Cone::half_space(vector(&[0.0, 0.0]), -1.0)], 2).is_err());
    }
}
