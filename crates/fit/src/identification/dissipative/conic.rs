//! The shortest vector under linear matrix inequalities of order one and two.
//!
//! `S = [s₁₁ s₁₂; s₁₂ s₂₂] ⪰ 0` says `t ≥ ‖(x, y)‖` for `t = (s₁₁ + s₂₂)/√2`, `x = (s₁₁ − s₂₂)/√2`, `y = √2 s₁₂`: a second-order cone,
//! of which a scalar inequality is the one without `x` and `y`. A primal–dual interior-point method with Nesterov–Todd
//! scaling and Mehrotra's corrector (Vandenberghe, *The CVXOPT linear and quadratic cone program solvers*, 2010) takes some
//! fifteen steps whatever the number of inequalities that hold the answer, each a Cholesky factor of the size of the vector.

mod interior_point;

use crate::error::Result;
use interior_point::{Problem, contradiction};
use nalgebra::DVector;

/// The shortest `w` of `size` numbers in all cones, and which of them hold it.
///
/// # Errors
/// [`Error::Numerical`](crate::Error::Numerical) for cones that have nothing in common.
pub(super) fn shortest(cones: &[Cone], size: usize) -> Result<(DVector<f64>, Vec<bool>)> {
    let unit = |c: &Cone| c.scaled(c.size().max(f64::MIN_POSITIVE).recip());
    let unit: Vec<Cone> = cones.iter().map(unit).collect();
    // distances of the order of one
    let distances = unit.iter().map(|c| tail(&c.bound) - c.bound[0]);
    let furthest = distances.fold(0.0, f64::max);
    if !furthest.is_finite() {
        return Err(contradiction());
    }
    if furthest == 0.0 {
        return Ok((DVector::zeros(size), vec![false; cones.len()]));
    }
    // numbers that no cone looks at stay zero
    let is_seen = |&c: &usize| unit.iter().any(|u| u.rows.iter().any(|r| r[c] != 0.0));
    let seen: Vec<usize> = (0..size).filter(is_seen).collect();
    let point = Problem::new(&unit, &seen, furthest).solve()?;
    let mut w = DVector::zeros(size);
    for (&c, x) in seen.iter().zip(&point.w) {
        w[c] = x * furthest;
    }
    let holds = |(s, z): (&Vector, &Vector)| s[0] - tail(s) < z[0] + tail(z);
    let holds = point.s.iter().zip(&point.z).map(holds).collect();
    Ok((w, holds))
}

/// `(t, x, y)`.
type Vector = [f64; 3];

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
        let z_bar = [z_bar[0], -z_bar[1], -z_bar[2]];
        let w: Vector = std::array::from_fn(|r| 0.5 * (s_bar[r] + z_bar[r]) / half);
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

/// `bound − rows · w` is in the cone.
#[derive(Debug, Clone)]
pub(super) struct Cone {
    rows: Vec<DVector<f64>>,
    bound: Vector,
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
        let squares = self.rows.iter().map(DVector::norm_squared);
        squares.sum::<f64>().sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

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
        assert!((found.0 - vector(&[1.0, 2.0])).amax() < 1e-12);
        assert_eq!(found.1, [true, true, false]);
        let found = shortest(std::slice::from_ref(&sum), 2).unwrap();
        assert!((found.0 - vector(&[0.5, 0.5])).amax() < 1e-12);
        let found = shortest(&[Cone::half_space(vector(&[1.0, 0.0]), 3.0)], 2).unwrap();
        assert!(found.0.amax() == 0.0 && found.1 == [false]);
        // 1e-7 in size: as exact as at one
        let tiny = [
            Cone::half_space(vector(&[-2.0, 0.0]), -2e-7),
            Cone::half_space(vector(&[0.0, -1.0]), -2e-7),
        ];
        let found = shortest(&tiny, 2).unwrap();
        assert!((found.0 - vector(&[1e-7, 2e-7])).amax() < 1e-19);
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
            let w = shortest(&[cone], 3).unwrap().0;
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
