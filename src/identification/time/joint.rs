//! All transfer functions of records at once, held together by constraints.

use super::systems::ForceSystems;
use crate::error::{Error, Result};
use crate::identification::basis::Basis;
use crate::identification::dissipative::{Dissipation, LinearEntry, Solution, Wishes};
use crate::identification::least_squares::Factor;
use nalgebra::{DMatrix, DVector};

/// All transfer functions at given poles, each force by itself and together under the constraints.
pub(crate) struct Joint {
    /// One a transfer function where each has rows of its own, else one a force, constant included.
    whole: Vec<LinearEntry>,
    /// One a transfer function.
    entries: Vec<LinearEntry>,
    /// Scale of the weighted residual of each of `whole` in the objective.
    shares: Vec<f64>,
    /// Relative objective without constraints, squared.
    least: f64,
    pub held: Option<Solution>,
}

impl Joint {
    /// The constrained fit in the columns of `bases`, row by row. As in the search of poles, the weighted residuals of
    /// every transfer function that has rows of its own count relative to its weighted data, else those of every force.
    ///
    /// # Errors
    /// Rows that do not determine the coefficients, and constraints that no coefficients satisfy.
    pub(crate) fn new(systems: &ForceSystems, bases: &[Basis], wishes: &Wishes) -> Result<Self> {
        let n = bases.len().isqrt();
        let apart = (0..n).all(|i| (0..n).all(|j| systems.alone(i, j).is_some()))
            && !systems.of_force(0).order.constant;
        let mut joint = Self {
            whole: Vec::new(),
            entries: Vec::new(),
            shares: Vec::new(),
            least: 0.0,
            held: None,
        };
        let count = if apart { n * n } else { n } as f64;
        let mut at = 0;
        for i in 0..n {
            if !apart {
                let linear = joint.add(&systems.whole(i), count, at)?;
                at += linear.spread.ncols();
                for j in 0..n {
                    let places = systems.places(i, j);
                    joint.entries.push(LinearEntry {
                        values: places.iter().map(|&p| linear.values[p]).collect(),
                        spread: linear.spread.select_rows(&places),
                        at: linear.at,
                    });
                }
                joint.whole.push(linear);
            }
            for j in (0..n).filter(|_| apart) {
                let factor = systems.alone(i, j).ok_or_else(no_rows)?;
                let linear = joint.add(&factor, count, at)?;
                at += linear.spread.ncols();
                joint.entries.push(linear.clone());
                joint.whole.push(linear);
            }
        }
        joint.held = Dissipation::new(bases, wishes).solve(&joint.entries)?;
        Ok(joint)
    }

    fn add(&mut self, factor: &Factor, count: f64, at: usize) -> Result<LinearEntry> {
        let columns = factor.columns();
        let total = factor.total_sum(0);
        let share = if total > 0.0 {
            (total * count).sqrt().recip()
        } else {
            1.0
        };
        self.least += share * share * factor.residual_sum(columns, 0);
        self.shares.push(share);
        Ok(LinearEntry {
            values: factor.solve(columns)?.as_slice().to_vec(),
            spread: factor.inverse_upper(columns)? / share,
            at,
        })
    }

    /// Root mean square of the relative weighted residuals, with the constraints.
    pub(crate) fn objective(&self) -> f64 {
        let added = self.held.as_ref().map_or(0.0, |h| h.free.norm_squared());
        (self.least + added).sqrt()
    }

    /// Coefficients of a transfer function.
    pub(crate) fn values(&self, e: usize) -> &[f64] {
        match &self.held {
            Some(held) => &held.coefficients[e],
            None => &self.entries[e].values,
        }
    }

    /// The constant of force `i` where one is estimated along with the coefficients.
    pub(crate) fn constant(&self, i: usize) -> f64 {
        match &self.held {
            Some(held) => self.whole[i].coefficients(&held.free)[0],
            None => self.whole[i].values[0],
        }
    }

    /// Covariance of the coefficients of a transfer function, from the variances of the weighted residuals of all forces.
    pub(crate) fn covariance(&self, e: usize, variances: &[f64]) -> Option<DMatrix<f64>> {
        let held = self.held.as_ref()?;
        let per_force = self.whole.len() / variances.len();
        let mut each = Vec::new();
        for (w, (linear, share)) in self.whole.iter().zip(&self.shares).enumerate() {
            let variance = variances[w / per_force] * share * share;
            each.extend(vec![variance; linear.spread.ncols()]);
        }
        Some(
            held.tangent
                .covariance(&self.entries[e], &DVector::from_vec(each)),
        )
    }
}

fn no_rows() -> Error {
    Error::Numerical("constraints of the fit: a transfer function without rows".into())
}
