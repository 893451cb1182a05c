//! Rational functions in Roger's form, `G = a₁ + a₂ p + a₃ p² + Σ a_{l+3} p/(p + d_l)`, `p = iK` (1.23a).

use super::{AerodynamicModel, ContinuousRealization, Realization, TransferMatrix};
use crate::error::{Error, Result, positive};
use crate::section::Dof;
use crate::state_space::complex;
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Rational-function model with lags shared by all entries.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RationalModel {
    /// Degrees of freedom of rows and columns.
    pub dofs: Vec<Dof>,
    /// Quasi-static term, n×n.
    #[serde(with = "crate::state_space::rows")]
    pub a1: DMatrix<f64>,
    /// Rate term, n×n.
    #[serde(with = "crate::state_space::rows")]
    pub a2: DMatrix<f64>,
    /// Added mass, n×n; zero when the model has none.
    #[serde(with = "crate::state_space::rows")]
    pub a3: DMatrix<f64>,
    /// Lags `d_l`, dimensionless, positive.
    pub lags: Vec<f64>,
    /// Lag terms, one n×n matrix a lag.
    #[serde(with = "crate::state_space::rows::list")]
    pub lag_terms: Vec<DMatrix<f64>>,
}

impl RationalModel {
    /// Checks that shapes agree and lags are positive.
    ///
    /// # Errors
    /// [`Error::Input`] naming the field that does not fit.
    pub fn validate(&self) -> Result<()> {
        let n = self.dofs.len();
        let square = |m: &DMatrix<f64>| m.shape() == (n, n) && m.iter().all(|x| x.is_finite());
        let terms = [&self.a1, &self.a2, &self.a3];
        if !terms.into_iter().chain(&self.lag_terms).all(square) {
            return Err(Error::input(
                "rational model",
                format!("finite {n}x{n} matrices"),
                "another shape or a number that is not finite",
            ));
        }
        if self.lag_terms.len() != self.lags.len() {
            return Err(Error::input(
                "rational model: lag_terms",
                format!("one matrix for each of the {} lags", self.lags.len()),
                self.lag_terms.len().to_string(),
            ));
        }
        for d in &self.lags {
            positive("rational model: lags", *d)?;
        }
        Ok(())
    }

    /// The flat plate with R. T. Jones's approximation of Theodorsen's function,
    /// `C(k) ≈ 1 − 0.165 p/(p + 0.091) − 0.335 p/(p + 0.6)` (NACA Report 681, 1940): exact as a rational function.
    pub fn jones_flat_plate() -> Self {
        let m = |entries: [f64; 4]| DMatrix::from_row_slice(2, 2, &entries);
        // C multiplies p·[−2π, π/2·…]: the part p·(p/(p+d)) = p − d p/(p+d) feeds a₂ and the lag term
        let lag = |weight: f64, d: f64| {
            m([
                -2.0 * PI * d * weight,
                -2.0 * PI * weight * (1.0 - d / 4.0),
                -PI / 2.0 * d * weight,
                -PI / 2.0 * weight * (1.0 - d / 4.0),
            ])
        };
        Self {
            dofs: Dof::TWO.to_vec(),
            a1: m([0.0, 2.0 * PI, 0.0, PI / 2.0]),
            a2: m([-PI, 3.0 * PI / 4.0, -PI / 4.0, -PI / 16.0]),
            a3: m([-PI / 2.0, 0.0, 0.0, -PI / 64.0]),
            lags: vec![0.091, 0.6],
            lag_terms: vec![lag(0.165, 0.091), lag(0.335, 0.6)],
        }
    }
}

impl AerodynamicModel for RationalModel {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let p = Complex::new(0.0, k.full_width());
        let feed = complex(&self.a1) + complex(&self.a2) * p + complex(&self.a3) * (p * p);
        let lagged = self.lags.iter().zip(&self.lag_terms);
        Ok(lagged.fold(feed, |g, (d, a)| g + complex(a) * (p / (p + d))))
    }

    /// One state per lag and motion, `x' = −d x + d r`; `p/(p+d) = 1 − d/(p+d)` puts `a_{l+3}` into `e₀`.
    fn realize(&self) -> Option<Realization> {
        let n = self.dofs.len();
        let states = n * self.lags.len();
        let mut a = DMatrix::zeros(states, states);
        let mut b = DMatrix::zeros(states, n);
        let mut c = DMatrix::zeros(n, states);
        let mut e0 = self.a1.clone();
        for (l, (&d, term)) in self.lags.iter().zip(&self.lag_terms).enumerate() {
            e0 += term;
            for j in 0..n {
                let state = l * n + j;
                a[(state, state)] = -d;
                b[(state, j)] = d;
                c.column_mut(state).copy_from(&(-term.column(j)));
            }
        }
        Some(Realization::Continuous(ContinuousRealization {
            a,
            b,
            c,
            e0,
            e1: self.a2.clone(),
            e2: self.a3.clone(),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Jones's lag coefficients as printed in the reference table (six decimals).
    #[test]
    fn jones_coefficients() {
        let jones = RationalModel::jones_flat_plate();
        let printed = [
            [-0.094342, -1.013140, -0.023586, -0.253285],
            [-1.262920, -1.789137, -0.315730, -0.447284],
        ];
        for (term, expected) in jones.lag_terms.iter().zip(printed) {
            for (i, value) in expected.iter().enumerate() {
                assert!((term[(i / 2, i % 2)] - value).abs() < 5e-7);
            }
        }
    }
}
