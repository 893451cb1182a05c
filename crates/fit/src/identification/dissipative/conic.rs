//! The shortest vector under linear matrix inequalities of order one and two.
//!
//! `S = [s₁₁ s₁₂; s₁₂ s₂₂] ⪰ 0` says `t ≥ ‖(x, y)‖` for `t = (s₁₁ + s₂₂)/√2`, `x = (s₁₁ − s₂₂)/√2`, `y = √2 s₁₂`: a second-order cone,
//! of which a scalar inequality is the one without `x` and `y`. A primal–dual interior-point method with Nesterov–Todd
//! scaling and Mehrotra's corrector (Vandenberghe, *The CVXOPT linear and quadratic cone program solvers*, 2010) takes some
//! fifteen steps whatever the number of inequalities that hold the answer, each a Cholesky factor of the size of the vector.

mod interior_point;
mod second_order;

pub(super) use second_order::Cone;

use crate::error::Result;
use interior_point::{Problem, contradiction};
use nalgebra::DVector;
use second_order::{Vector, tail};

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
