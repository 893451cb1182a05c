//! Exact discretisation by one matrix exponential.

use crate::error::{Error, Result};
use nalgebra::DMatrix;

/// `x(t+h) = Φ x(t) + Γ₀ u(t) + Γ₁ u̇`, exact for inputs that run on a straight line over the step.
///
/// With `u̇ = 0` this is the zero-order hold; with `u̇ = (u(t+h) − u(t))/h` the first-order hold.
#[derive(Debug, Clone, PartialEq)]
pub struct StepMatrices {
    /// `Φ = e^{Ah}`, n×n.
    pub phi: DMatrix<f64>,
    /// `Γ₀ = ∫₀ʰ e^{Aτ} dτ B`, n×m.
    pub gamma_0: DMatrix<f64>,
    /// `Γ₁ = ∫₀ʰ e^{A(h−τ)} τ dτ B`, n×m.
    pub gamma_1: DMatrix<f64>,
}

/// `e^M`.
///
/// # Errors
/// [`Error::Numerical`] when an entry is not finite or so large that no digit of the result would be right (scaling and
/// squaring would take for ever), or when the result overflows.
pub(super) fn matrix_exponential(m: &DMatrix<f64>) -> Result<DMatrix<f64>> {
    let column = |c: nalgebra::DVectorView<'_, f64>| c.iter().map(|x| x.abs()).sum::<f64>();
    let norm = m.column_iter().map(column).fold(0.0, f64::max);
    // a number that is none is not greater than any
    if m.iter().all(|x| x.is_finite()) {
        if norm > f64::EPSILON.recip() {
            return Err(Error::Numerical(format!(
                "matrix exponential: a step so long or rates so fast (norm {norm:.1e}) that no digit would be right"
            )));
        }
        let e = m.exp();
        if e.iter().all(|x| x.is_finite()) {
            return Ok(e);
        }
    }
    Err(Error::Numerical(
        "matrix exponential: an entry is not finite".into(),
    ))
}

/// `[Φ, Γ₀, Γ₁]` of [`StepMatrices`] side by side, n×(n + 2m), for `ẋ = A x + B u` and the step `h`, from the exponential of
/// `[[A, B, 0], [0, 0, I], [0, 0, 0]] h` (Van Loan 1978), so that a singular `A` is no special case.
///
/// # Errors
/// [`Error::Numerical`] when an entry or the step is not finite.
pub fn step_matrix(a: &DMatrix<f64>, b: &DMatrix<f64>, h: f64) -> Result<DMatrix<f64>> {
    let (n, m) = b.shape();
    // the input block is integrated in units of h, so that e^M holds numbers of one size
    let mut augmented = DMatrix::zeros(n + 2 * m, n + 2 * m);
    augmented.view_mut((0, 0), (n, n)).copy_from(&(a * h));
    augmented.view_mut((0, n), (n, m)).copy_from(&(b * h));
    augmented
        .view_mut((n, n + m), (m, m))
        .copy_from(&DMatrix::identity(m, m));
    let mut step = matrix_exponential(&augmented)?.rows(0, n).into_owned();
    let mut gamma_1 = step.columns_mut(n + m, m);
    gamma_1 *= h;
    Ok(step)
}

/// The parts of [`step_matrix`].
///
/// # Errors
/// As there.
pub fn c2d(a: &DMatrix<f64>, b: &DMatrix<f64>, h: f64) -> Result<StepMatrices> {
    let (n, m) = b.shape();
    let step = step_matrix(a, b, h)?;
    Ok(StepMatrices {
        phi: step.columns(0, n).into_owned(),
        gamma_0: step.columns(n, m).into_owned(),
        gamma_1: step.columns(n + m, m).into_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrators_give_the_textbook_polynomials() {
        // ẍ = u with u = u0 + u̇ t: x = u0 h²/2 + u̇ h³/6, ẋ = u0 h + u̇ h²/2
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
        let b = DMatrix::from_row_slice(2, 1, &[0.0, 1.0]);
        let h = 0.3_f64;
        let s = c2d(&a, &b, h).unwrap();
        assert!((s.gamma_0[0] - h * h / 2.0).abs() < 1e-15);
        assert!((s.gamma_0[1] - h).abs() < 1e-15);
        assert!((s.gamma_1[0] - h.powi(3) / 6.0).abs() < 1e-15);
        assert!((s.gamma_1[1] - h * h / 2.0).abs() < 1e-15);
    }

    #[test]
    fn non_finite_matrices_are_refused() {
        let a = DMatrix::from_element(2, 2, f64::NAN);
        assert!(matrix_exponential(&a).is_err());
    }

    /// Finite but huge: scaling and squaring would square 2⁶⁴ times.
    #[test]
    fn huge_matrices_are_refused_at_once() {
        for size in [1e20, 1e40, 1e300, f64::MAX] {
            let a = DMatrix::from_element(2, 2, -size);
            let message = matrix_exponential(&a).unwrap_err().to_string();
            assert!(message.contains("no digit"), "{message}");
        }
    }
}
