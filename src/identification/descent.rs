//! Levenberg–Marquardt on residuals that are known as a function only.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, Owned};

/// Step of the central differences of the residuals, in variables of order one; error about its square.
const DIFFERENCE_STEP: f64 = 1e-5;

/// Residuals at a point; `None` where there are none.
pub(crate) type Residuals<'a> = &'a dyn Fn(&[f64]) -> Option<DVector<f64>>;

/// The point that a descent from `start` ends at; whatever the reason it stopped for, the caller judges it by its
/// residuals.
pub(crate) fn descend(start: DVector<f64>, residuals: Residuals<'_>) -> DVector<f64> {
    let problem = Descent {
        at: start,
        residuals,
    };
    LevenbergMarquardt::new().minimize(problem).0.at
}

struct Descent<'a> {
    at: DVector<f64>,
    residuals: Residuals<'a>,
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Descent<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, x: &DVector<f64>) {
        self.at.copy_from(x);
    }

    fn params(&self) -> DVector<f64> {
        self.at.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        (self.residuals)(self.at.as_slice())
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let columns: Option<Vec<_>> = (0..self.at.len())
            .map(|c| {
                let mut x = self.at.clone();
                x[c] += DIFFERENCE_STEP;
                let ahead = (self.residuals)(x.as_slice())?;
                x[c] -= 2.0 * DIFFERENCE_STEP;
                Some((ahead - (self.residuals)(x.as_slice())?) / (2.0 * DIFFERENCE_STEP))
            })
            .collect();
        Some(DMatrix::from_columns(&columns?))
    }
}
