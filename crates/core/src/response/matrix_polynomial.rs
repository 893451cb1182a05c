//! A matrix that is a polynomial of one number: output equations of the wind speed, steps of a structure of their duration.

use super::packed::{Packed, set_polynomial};
use crate::state_space::StateEquation;
use nalgebra::DMatrix;

/// Terms of an exponential at most: 3³²/32! = 7e-21.
const MOST_TERMS: usize = 33;

/// Terms of an exponential of this norm (3 at most) beyond which nothing is left but rounding.
pub(super) fn terms_of_exponential(norm: f64) -> usize {
    // the size of a term over what may be left out, without a division for each
    let (mut terms, mut size, mut least) = (1, norm, f64::EPSILON / 8.0);
    while size > least && terms < MOST_TERMS {
        terms += 1;
        size *= norm;
        least *= terms as f64;
    }
    terms
}

/// A matrix as a polynomial of one number, such as the wind speed or the duration of a step.
#[derive(Debug, Clone)]
pub(super) struct MatrixPolynomial {
    /// By the power, from the lowest on.
    powers: Vec<Packed>,
    /// That of the number that was asked for last.
    now: Packed,
    at: f64,
}

impl MatrixPolynomial {
    /// `Σ Wₖ xᵏ`, all of one shape.
    pub(super) fn new(powers: &[DMatrix<f64>]) -> Self {
        let powers: Vec<_> = powers.iter().map(Packed::new).collect();
        Self {
            now: powers[0].clone(),
            powers,
            at: 0.0,
        }
    }

    /// The rows of `e^(A t)` that step `ẋ = A x + B u`, `[Φ, Γ₀, Γ₁]`, as a series of `t`.
    pub(super) fn exponential(StateEquation { a, b }: &StateEquation) -> Self {
        let (n, m) = b.shape();
        let mut all = DMatrix::zeros(n + 2 * m, n + 2 * m);
        all.view_mut((0, 0), (n, n)).copy_from(a);
        all.view_mut((0, n), (n, m)).copy_from(b);
        all.view_mut((n, n + m), (m, m)).fill_with_identity();
        let mut power = DMatrix::identity(n, n + 2 * m);
        let mut powers = vec![power.clone()];
        for k in 1..MOST_TERMS {
            power = power * &all / k as f64;
            powers.push(power.clone());
        }
        Self::new(&powers)
    }

    /// The matrix for `x` by so many terms.
    #[inline]
    pub(super) fn at(&mut self, x: f64, terms: usize) -> &Packed {
        if x.to_bits() != self.at.to_bits() {
            let powers = &self.powers[..terms.min(self.powers.len())];
            set_polynomial(&mut self.now, powers, x);
            self.at = x;
        }
        &self.now
    }
}
