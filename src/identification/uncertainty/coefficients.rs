//! Estimated parameters of a model, their covariance, and the model as a function of them.

use super::columns::LinearModel;
use super::design::Design;
use crate::aerodynamics::DiscreteLaguerre;
use crate::error::{Error, Result};
use crate::identification::basis::assemble;
use crate::identification::options::Form;
use crate::identification::report::FitReport;
use crate::section::Dof;
use crate::trained_model::Model;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// One estimated number of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// Name as in the equations; `pole 0` and so on for poles that were searched.
    pub name: String,
    /// Force it belongs to; none for poles that all transfer functions share.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<Dof>,
    /// Motion it belongs to; none for shared poles and static terms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<Dof>,
    /// Estimate, dimensionless.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// A pole among the parameters.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchedPole {
    /// Row and column of its transfer function; `None` when all share it.
    pub entry: Option<(usize, usize)>,
    /// Place among the free poles.
    pub index: usize,
}

/// How parameters make a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Coordinates {
    /// Coefficients of every transfer function row by row, each in the order of its columns; then the searched poles.
    Continuous {
        /// Form of the model.
        form: Form,
        /// Poles of every transfer function, one a filter, row by row.
        chains: Vec<Vec<Vec<f64>>>,
        /// Poles that are parameters.
        searched: Vec<SearchedPole>,
    },
    /// For each force its static term, then the coefficients of every motion.
    Discrete {
        /// Decay factor.
        alpha: f64,
        /// Step `Δs`.
        delta_s: f64,
        /// Number of filters.
        filters: usize,
    },
}

/// Estimates with their covariance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoefficientUncertainty {
    /// What the covariance means and under which assumption it holds.
    pub assumption: String,
    /// Degrees of freedom of rows and columns.
    pub dofs: Vec<Dof>,
    /// How the parameters make the model.
    pub coordinates: Coordinates,
    /// The estimates.
    pub parameters: Vec<Parameter>,
    /// Covariance of the estimates, P×P, in their order.
    #[serde(with = "crate::state_space::rows")]
    pub covariance: DMatrix<f64>,
    /// The independent blocks of data.
    pub blocks: Vec<String>,
    #[serde(skip)]
    design: Option<Design>,
}

impl CoefficientUncertainty {
    pub(super) fn new(
        assumption: String,
        dofs: Vec<Dof>,
        coordinates: Coordinates,
        mut parameters: Vec<Parameter>,
        design: Design,
    ) -> Self {
        let contributions = design.contributions();
        let covariance = &contributions * contributions.transpose();
        for (i, parameter) in parameters.iter_mut().enumerate() {
            parameter.standard_error = covariance[(i, i)].max(0.0).sqrt();
        }
        Self {
            assumption,
            dofs,
            coordinates,
            parameters,
            covariance,
            blocks: design.names(),
            design: Some(design),
        }
    }

    /// The estimates.
    pub fn values(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.value).collect()
    }

    /// The model with other parameters.
    ///
    /// # Errors
    /// [`Error::Input`] for another number of parameters or a pole that is not positive.
    pub fn model_at(&self, values: &[f64]) -> Result<Model> {
        let n = self.dofs.len();
        let expected = self.parameters.len();
        if values.len() != expected {
            let found = values.len().to_string();
            return Err(Error::input("parameters", expected.to_string(), found));
        }
        match &self.coordinates {
            Coordinates::Continuous {
                form,
                chains,
                searched,
            } => {
                let mut chains = chains.clone();
                let first_pole = expected.saturating_sub(searched.len());
                for (pole, value) in searched.iter().zip(&values[first_pole..]) {
                    for (i, row) in chains.iter_mut().enumerate() {
                        for (j, chain) in row.iter_mut().enumerate() {
                            if pole.entry.is_none_or(|entry| entry == (i, j)) {
                                let mut free = form.collapse(chain);
                                free[pole.index] = *value;
                                *chain = form.expand(&free);
                            }
                        }
                    }
                }
                let mut rest = values.iter().copied();
                let coefficients: Vec<Vec<Vec<f64>>> = chains
                    .iter()
                    .map(|row| {
                        row.iter()
                            .map(|chain| {
                                let count = form.feed_through().count() + chain.len();
                                rest.by_ref().take(count).collect()
                            })
                            .collect()
                    })
                    .collect();
                assemble(form, &self.dofs, &chains, &coefficients)
            }
            Coordinates::Discrete {
                alpha,
                delta_s,
                filters,
            } => {
                let each = 1 + n * filters;
                let of_motion = |j| {
                    DMatrix::from_fn(n, *filters, |i, l| values[i * each + 1 + j * filters + l])
                };
                let model = DiscreteLaguerre::shared(
                    self.dofs.clone(),
                    *alpha,
                    *delta_s,
                    (0..n).map(of_motion).collect(),
                    (0..n).map(|i| values[i * each]).collect(),
                );
                model.validate()?;
                Ok(Model::DiscreteLaguerre(model))
            }
        }
    }

    /// The model as a linear function of its parameters, where poles are among them.
    ///
    /// # Errors
    /// Chains whose columns cannot be told apart.
    pub fn linear(&self) -> Result<Option<LinearModel>> {
        match &self.coordinates {
            Coordinates::Continuous {
                form,
                chains,
                searched,
            } if !searched.is_empty() => {
                let of = (form, self.dofs.as_slice());
                LinearModel::new(of, chains, searched, self.values()).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// Standard error of `gradient · parameters`.
    ///
    /// # Errors
    /// [`Error::Input`] for a gradient of another length.
    pub fn standard_error(&self, gradient: &[f64]) -> Result<f64> {
        if gradient.len() != self.parameters.len() {
            return Err(Error::input(
                "gradient",
                self.parameters.len().to_string(),
                gradient.len().to_string(),
            ));
        }
        let g = DVector::from_column_slice(gradient);
        Ok(g.dot(&(&self.covariance * &g)).max(0.0).sqrt())
    }

    /// Degrees of freedom of that standard error; `None` for an estimate that was read from a file, which no longer knows
    /// its data.
    pub fn degrees_of_freedom(&self, gradient: &[f64]) -> Option<f64> {
        let design = self.design.as_ref()?;
        Some(design.degrees_of_freedom(&DVector::from_column_slice(gradient)))
    }

    /// Parameters of the fit in which each block counts as often as its weight says: exact for coefficients, one
    /// Gauss–Newton step for searched poles. `None` for an estimate that was read from a file.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the weighted blocks do not determine all parameters.
    pub fn reweighted(&self, weights: &[f64]) -> Result<Option<Vec<f64>>> {
        let Some(design) = &self.design else {
            return Ok(None);
        };
        let step = design.reweighted(weights)?;
        let moved = self.parameters.iter().zip(step.iter());
        Ok(Some(moved.map(|(p, d)| p.value + d).collect()))
    }

    /// Puts these standard errors and covariances in the place of those of a fit that took residuals for independent.
    ///
    /// Standard errors hold the scatter of searched poles. The covariance of an entry is that of its coefficients at
    /// the poles it is written with, `C_cc − C_cp C_pp⁻¹ C_pc`: with a pole, the coefficients move together, and drawn
    /// without it they would be another model.
    pub fn enter(&self, report: &mut FitReport) {
        let own: Vec<Vec<usize>> = report
            .entries
            .iter()
            .map(|entry| {
                let is_own = |&p: &usize| {
                    let q = &self.parameters[p];
                    (q.force, q.motion) == (Some(entry.force), Some(entry.motion))
                };
                let all = (0..self.parameters.len()).filter(is_own);
                all.take(entry.coefficients.len()).collect()
            })
            .collect();
        let is_pole = |p: &usize| !own.iter().any(|list| list.contains(p));
        let poles: Vec<usize> = (0..self.parameters.len()).filter(is_pole).collect();
        let covariance = self.covariance_given(&poles);
        for (entry, own) in report.entries.iter_mut().zip(&own) {
            if own.len() != entry.coefficients.len() {
                continue;
            }
            for (coefficient, &p) in entry.coefficients.iter_mut().zip(own) {
                coefficient.standard_error = Some(self.parameters[p].standard_error);
            }
            let row = |&p: &usize| own.iter().map(|&q| covariance[(p, q)]).collect();
            entry.covariance = own.iter().map(row).collect();
        }
        report.covariance_assumption.clone_from(&self.assumption);
    }

    /// The covariance of all parameters when those of `held` are known.
    fn covariance_given(&self, held: &[usize]) -> DMatrix<f64> {
        let Some(inverse) = self
            .covariance
            .select_rows(held)
            .select_columns(held)
            .try_inverse()
        else {
            return self.covariance.clone();
        };
        let across = self.covariance.select_columns(held);
        &self.covariance - &across * inverse * across.transpose()
    }
}
