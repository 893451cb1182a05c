//! Karpel's minimum-state form, `G = a₁ + a₂ p + a₃ p² + D (pI − R)⁻¹ E p` with `R = −diag(d)`.
//!
//! M. Karpel, Design for active flutter suppression and gust alleviation using state-space aeroelastic modeling,
//! J. Aircraft 19 (1982). One state per lag instead of n: Roger's form in which every `a_{l+3}` is the product of a column
//! of `D` and a row of `E`.

use super::{RationalModel, check_square};
use crate::aerodynamics::{
    ContinuousRealization, Realizable, Realization, Transfer, TransferMatrix, check_matrix,
};
use crate::error::{Result, positive};
use crate::section::Dof;
use crate::state_space::complex;
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Rational functions with m lag states that all forces and motions share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MinimumStateModel {
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
    /// Lags `d_l`, dimensionless, positive, one per state; several may be equal.
    pub lags: Vec<f64>,
    /// Forces of the states, n×m.
    #[serde(with = "crate::state_space::rows")]
    pub d: DMatrix<f64>,
    /// What drives the states, m×n.
    #[serde(with = "crate::state_space::rows")]
    pub e: DMatrix<f64>,
}

impl MinimumStateModel {
    /// Checks that shapes agree and lags are positive.
    pub fn validate(&self) -> Result<()> {
        const PLACE: &str = "minimum-state model";
        let (n, m) = (self.dofs.len(), self.lags.len());
        check_square(PLACE, n, &[&self.a1, &self.a2, &self.a3])?;
        check_matrix(format_args!("{PLACE}: d"), &self.d, n, m)?;
        check_matrix(format_args!("{PLACE}: e"), &self.e, m, n)?;
        for d in &self.lags {
            positive(format!("{PLACE}: lags"), *d)?;
        }
        Ok(())
    }

    /// The same as a function in Roger's form, with n states per lag: `a_{l+3} = D_l E_l`.
    pub fn to_roger(&self) -> RationalModel {
        let pairs = self.d.column_iter().zip(self.e.row_iter());
        RationalModel {
            dofs: self.dofs.clone(),
            a1: self.a1.clone(),
            a2: self.a2.clone(),
            a3: self.a3.clone(),
            lags: super::Lags::Shared(self.lags.clone()),
            lag_terms: pairs.map(|(d, e)| d * e).collect(),
        }
    }
}

impl Transfer for MinimumStateModel {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let p = Complex::new(0.0, k.full_width());
        let filters: Vec<_> = self.lags.iter().map(|d| p / (p + d)).collect();
        let filters = DMatrix::from_diagonal(&filters.into());
        let feed = complex(&self.a1) + complex(&self.a2) * p + complex(&self.a3) * (p * p);
        Ok(feed + complex(&self.d) * filters * complex(&self.e))
    }

    fn realizable(&self) -> Option<&dyn Realizable> {
        Some(self)
    }
}

impl Realizable for MinimumStateModel {
    /// `x' = −d x + d E r`, `q = … + D (E r − x)`: one state per lag.
    fn realize(&self) -> Realization {
        let lags = DMatrix::from_diagonal(&DVector::from_column_slice(&self.lags));
        Realization::Continuous(ContinuousRealization {
            b: &lags * &self.e,
            a: -lags,
            c: -&self.d,
            e0: &self.a1 + &self.d * &self.e,
            e1: self.a2.clone(),
            e2: self.a3.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Jones's two lag matrices have rank one, so two states carry the whole flat plate.
    fn jones() -> MinimumStateModel {
        let roger = RationalModel::jones_flat_plate();
        let row = |l: usize| roger.lag_terms[l].row(0).into_owned();
        MinimumStateModel {
            dofs: roger.dofs.clone(),
            a1: roger.a1.clone(),
            a2: roger.a2.clone(),
            a3: roger.a3.clone(),
            lags: vec![0.091, 0.6],
            // the moment is a quarter of the lift: the circulatory force acts at the quarter point
            d: DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 0.25, 0.25]),
            e: DMatrix::from_rows(&[row(0), row(1)]),
        }
    }

    #[test]
    fn two_states_are_jones() {
        let model = jones();
        model.validate().unwrap();
        let roger = RationalModel::jones_flat_plate();
        let realization = model.realize();
        assert_eq!(realization.states(), 2);
        for k in [0.0, 0.05, 0.4, 3.0].map(ReducedFrequency::from_full_width) {
            let expected = roger.transfer(k).unwrap();
            // sums of ten numbers below 30: rounding
            for g in [
                model.transfer(k),
                realization.transfer(k),
                model.to_roger().transfer(k),
            ] {
                assert!((g.unwrap() - &expected).camax() < 1e-13);
            }
        }
    }

    #[test]
    fn shapes_are_checked() {
        let mut model = jones();
        model.e = DMatrix::zeros(3, 2);
        assert_eq!(
            model.validate().unwrap_err().to_string(),
            "minimum-state model: e: expected a finite 2x2 matrix, found 3x2, or a number that is not finite"
        );
    }
}
