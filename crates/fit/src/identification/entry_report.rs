//! What a fit says of one transfer function.

use crate::section::Dof;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// Account of one transfer function.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EntryReport {
    /// Force (row of `G`).
    pub force: Dof,
    /// Motion (column of `G`).
    pub motion: Dof,
    /// Root mean square of the residuals over that of the data, unweighted for a transfer matrix, in the weights of the
    /// fit for records; `None` when the records move several
    /// degrees of freedom at once, so that the residual belongs to no single entry.
    pub relative_rms: Option<f64>,
    /// Largest residual over the magnitude of `G` at its point; only for fits to a transfer matrix.
    pub worst_relative: Option<f64>,
    /// Poles of its filters, dimensionless.
    pub poles: Vec<f64>,
    /// Coefficients by name.
    pub coefficients: Vec<Coefficient>,
    /// Covariance of the coefficients at these poles, in their order; empty when there are no residual degrees of freedom.
    pub covariance: Vec<Vec<f64>>,
    /// Condition number of the scaled columns.
    pub condition: f64,
    /// Largest single term over the norm of the whole fit.
    pub cancellation: f64,
}

/// One coefficient.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Coefficient {
    /// Name as in the equations.
    pub name: String,
    /// Value, dimensionless.
    pub value: f64,
    /// Standard error; `None` when there are no residual degrees of freedom.
    pub standard_error: Option<f64>,
}

impl EntryReport {
    /// Values of the coefficients.
    pub(crate) fn values(&self) -> Vec<f64> {
        self.coefficients.iter().map(|c| c.value).collect()
    }

    /// `values` named, with the covariance `variance · gram`.
    pub(crate) fn with_coefficients(
        mut self,
        names: Vec<String>,
        values: &[f64],
        covariance: Option<DMatrix<f64>>,
    ) -> Self {
        let named = names.into_iter().zip(values).enumerate();
        let coefficient = |(c, (name, value)): (usize, (String, &f64))| Coefficient {
            name,
            value: *value,
            standard_error: covariance.as_ref().map(|m| m[(c, c)].max(0.0).sqrt()),
        };
        self.coefficients = named.map(coefficient).collect();
        self.covariance = covariance.map_or_else(Vec::new, |m| {
            m.row_iter().map(|r| r.iter().copied().collect()).collect()
        });
        self
    }
}
