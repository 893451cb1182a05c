//! One chain of orthonormal filters with real poles, continuous in dimensionless time.

use crate::error::{Error, Result, ensure, positive};
use nalgebra::{Complex, DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Takenaka–Malmquist filters `Λ_l(p) = √(2p_l)/(p + p_l) Π_{j<l} (p − p_j)/(p + p_j)`; equal poles give the
/// Laguerre filters.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::FilterBank;
///
/// assert_eq!(FilterBank::new(vec![0.4; 3])?.count(), 3);
/// assert!(FilterBank::new(vec![0.4, -1.0]).is_err());
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct FilterBank {
    poles: Vec<f64>,
}

impl TryFrom<Vec<f64>> for FilterBank {
    type Error = Error;

    fn try_from(poles: Vec<f64>) -> Result<Self> {
        Self::new(poles)
    }
}

impl From<FilterBank> for Vec<f64> {
    fn from(bank: FilterBank) -> Self {
        bank.poles
    }
}

impl FilterBank {
    /// Filters with the poles `p_l > 0` (dimensionless), in the order of the chain.
    ///
    /// # Errors
    /// [`Error::Input`] when a pole is not positive or there is none.
    pub fn new(poles: Vec<f64>) -> Result<Self> {
        let place = "filter bank: poles";
        ensure(!poles.is_empty(), place, "at least one", "none")?;
        for p in &poles {
            positive(place, *p)?;
        }
        Ok(Self { poles })
    }

    /// `count` Laguerre filters with one pole.
    ///
    /// # Errors
    /// [`Error::Input`] when the pole is not positive or `count` is zero.
    pub fn laguerre(pole: f64, count: usize) -> Result<Self> {
        Self::new(vec![pole; count])
    }

    /// Poles in the order of the chain.
    pub fn poles(&self) -> &[f64] {
        &self.poles
    }

    /// Number of filters `L`.
    pub fn count(&self) -> usize {
        self.poles.len()
    }

    /// `Λ_0(p) … Λ_{L−1}(p)` in closed form at the complex frequency `p` (on the axis, `p = iK`).
    pub fn response(&self, p: Complex<f64>) -> Vec<Complex<f64>> {
        let mut all_pass = Complex::new(1.0, 0.0);
        self.poles
            .iter()
            .map(|&pole| {
                let filter = all_pass * (2.0 * pole).sqrt() / (p + pole);
                all_pass *= (p - pole) / (p + pole);
                filter
            })
            .collect()
    }

    /// `x' = A x + b v` whose states are the filter outputs: `x_0' = −p_0 x_0 + √(2p_0) v` and
    /// `√(2p_{l−1}) (x_l' + p_l x_l) = √(2p_l) (x_{l−1}' − p_{l−1} x_{l−1})`.
    pub fn matrices(&self) -> (DMatrix<f64>, DVector<f64>) {
        let n = self.count();
        let mut a = DMatrix::zeros(n, n);
        let mut b = DVector::zeros(n);
        for l in 0..n {
            let pole = self.poles[l];
            if l == 0 {
                b[0] = (2.0 * pole).sqrt();
            } else {
                let before = self.poles[l - 1];
                let ratio = (pole / before).sqrt();
                for j in 0..l {
                    a[(l, j)] = ratio * a[(l - 1, j)];
                }
                a[(l, l - 1)] -= ratio * before;
                b[l] = ratio * b[l - 1];
            }
            a[(l, l)] = -pole;
        }
        (a, b)
    }
}

/// Chains of filters side by side: `A`, `B`, `C` of terms that each drive one chain, `(a, b)`, from one motion and read it
/// with an n×L matrix of coefficients.
pub(super) fn side_by_side<'a>(
    n: usize,
    terms: impl Iterator<Item = (usize, (DMatrix<f64>, DVector<f64>), &'a DMatrix<f64>)>,
) -> [DMatrix<f64>; 3] {
    let terms: Vec<_> = terms.collect();
    let states = terms.iter().map(|(_, (_, drive), _)| drive.len()).sum();
    let mut a = DMatrix::zeros(states, states);
    let mut b = DMatrix::zeros(states, n);
    let mut c = DMatrix::zeros(n, states);
    let mut at = 0;
    for (input, (chain, drive), coefficients) in terms {
        let l = drive.len();
        a.view_mut((at, at), (l, l)).copy_from(&chain);
        b.view_mut((at, input), (l, 1)).copy_from(&drive);
        c.view_mut((0, at), (n, l)).copy_from(coefficients);
        at += l;
    }
    [a, b, c]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state_space::complex;

    #[test]
    fn poles_of_a_file_are_checked() {
        assert!(serde_json::from_str::<FilterBank>("[0.3, 0.5]").is_ok());
        for text in ["[0.3, -0.5]", "[0.0]", "[]"] {
            let message = serde_json::from_str::<FilterBank>(text).unwrap_err();
            assert!(message.to_string().contains("filter bank"), "{message}");
        }
    }

    #[test]
    fn state_equations_realise_the_closed_form() {
        for poles in [vec![0.3; 5], vec![0.149, 0.538, 0.9]] {
            let bank = FilterBank::new(poles).unwrap();
            let (a, b) = bank.matrices();
            for k in [0.05, 0.4, 2.0] {
                let p = Complex::new(0.0, k);
                let n = bank.count();
                let states = (DMatrix::identity(n, n) * p - complex(&a))
                    .lu()
                    .solve(&b.map(|x| Complex::new(x, 0.0)))
                    .unwrap();
                for (x, closed) in states.iter().zip(bank.response(p)) {
                    assert!((x - closed).norm() < 1e-13);
                }
            }
        }
    }

    /// Orthonormal: the Gramian of the states under a white input solves `A P + P Aᵀ + b bᵀ = 0` with `P = I`.
    #[test]
    fn filters_are_orthonormal() {
        let (a, b) = FilterBank::new(vec![0.2, 0.2, 0.7, 1.3])
            .unwrap()
            .matrices();
        let residual = &a + a.transpose() + &b * b.transpose();
        assert!(residual.amax() < 1e-14, "{residual}");
    }
}
