//! The dynamic stiffness `D(λ, V) = λ²M + λR + K − ½ρV²B² G(λB/V)` of up to three degrees of freedom, without allocation:
//! its structural part and its determinant, each with derivatives. Whoever brings `G` subtracts it.

use crate::section::Suspension;
use crate::state_space::Complex64;
use nalgebra::DVector;

/// The leading n×n block counts.
pub(super) type Small<const M: usize> = [[Complex64; M]; M];

pub(super) const ZERO: Complex64 = Complex64::new(0.0, 0.0);

/// One entry of `λ²M + λR + K`, and its derivative with respect to `λ`.
pub(super) fn oscillator(lambda: Complex64, s: Suspension) -> (Complex64, Complex64) {
    (
        (lambda * s.mass + s.damping) * lambda + s.stiffness,
        lambda * (2.0 * s.mass) + s.damping,
    )
}

/// Zero of a function of one complex number next to `start` by Newton's method; `step` is value over derivative. `None` where so many
/// steps do not end with one of at most `tolerance` of the number; the next would be its square.
#[inline(always)]
pub(super) fn newton(
    start: Complex64,
    steps: usize,
    tolerance: f64,
    mut step: impl FnMut(Complex64) -> Complex64,
) -> Option<Complex64> {
    let mut at = start;
    for _ in 0..steps {
        let step = step(at);
        at -= step;
        if step.norm_sqr() <= tolerance * tolerance * at.norm_sqr() {
            return at.re.is_finite().then_some(at);
        }
    }
    None
}

/// Determinant of the leading n×n block of a matrix, n ≤ 3, with its adjugate: `D adj(D) = det(D) I`.
pub(super) struct Determinant<const M: usize> {
    pub(super) value: Complex64,
    adjugate: Small<M>,
    n: usize,
}

impl<const M: usize> Determinant<M> {
    pub(super) fn new(d: &Small<M>, n: usize) -> Self {
        let mut adjugate = [[ZERO; M]; M];
        match n {
            1 => adjugate[0][0] = Complex64::new(1.0, 0.0),
            2 => {
                adjugate[0][0] = d[1][1];
                adjugate[0][1] = -d[0][1];
                adjugate[1][0] = -d[1][0];
                adjugate[1][1] = d[0][0];
            }
            _ => {
                for (i, row) in adjugate.iter_mut().enumerate() {
                    for (j, x) in row.iter_mut().enumerate() {
                        // cofactor of entry (j, i), indices cyclic so that the sign comes by itself
                        let (r1, r2) = ((j + 1) % 3, (j + 2) % 3);
                        let (c1, c2) = ((i + 1) % 3, (i + 2) % 3);
                        *x = d[r1][c1] * d[r2][c2] - d[r1][c2] * d[r2][c1];
                    }
                }
            }
        }
        let value = (0..n).map(|k| d[0][k] * adjugate[k][0]).sum();
        Self { value, adjugate, n }
    }

    /// The derivative of the determinant along that of the matrix, `tr(adj(D) D')`.
    pub(super) fn along(&self, derivative: &Small<M>) -> Complex64 {
        (0..self.n)
            .flat_map(|i| (0..self.n).map(move |k| (i, k)))
            .map(|(i, k)| self.adjugate[i][k] * derivative[k][i])
            .sum()
    }

    /// Where the determinant is zero, the motion that meets no resistance: a column of the adjugate.
    pub(super) fn null_vector(&self) -> DVector<Complex64> {
        let (m, n) = (&self.adjugate, self.n);
        let size = |j: &usize| (0..n).map(|i| m[i][*j].norm_sqr()).sum::<f64>();
        let j = (0..n)
            .max_by(|a, b| size(a).total_cmp(&size(b)))
            .unwrap_or(0);
        DVector::from_fn(n, |i, _| m[i][j])
    }
}
