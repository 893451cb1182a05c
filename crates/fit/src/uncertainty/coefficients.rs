//! Estimated parameters of a model, their covariance, and the model as a function of them.

use super::design::{Design, Effect};
use super::parameters::{Coordinates, Parameter, per_chain};
use super::speed_groups::speed_groups;
use super::speed_prior::SpeedPrior;
use super::speed_scatter::{self, POINTS, Slopes, SpeedScatter};
use crate::aerodynamics::{DiscreteLaguerre, Transfer};
use crate::error::{Result, ensure};
use crate::identification::basis::assemble;
use crate::identification::report::FitReport;
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::{ReducedFrequency, ReducedFrequencyRange, in_equal_ratios};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Relative step of the differences with respect to the parameters.
const STEP: f64 = 1e-5;
/// A model whose transfer matrix differs by more than this, relatively, is another one.
const SAME_MODEL: f64 = 1e-6;

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
    /// Scatter between mean speeds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speeds: Option<SpeedScatter>,
    /// The data it was made from; files leave them out.
    #[serde(skip)]
    pub data: Option<Design>,
}

impl CoefficientUncertainty {
    /// The estimates of a fit with the blocks it was made from, and the scatter between mean speeds over `tested` reduced frequencies
    /// where that is asked: without what the embedded measured `deck` says of it, for that deck itself.
    pub(super) fn new(
        assumption: String,
        tested: Option<ReducedFrequencyRange>,
        deck: Option<&str>,
        dofs: Vec<Dof>,
        coordinates: Coordinates,
        parameters: Vec<Parameter>,
        mut design: Design,
    ) -> Result<Self> {
        let contributions = design.contributions();
        let mut estimate = Self {
            assumption,
            dofs,
            coordinates,
            parameters,
            covariance: &contributions * contributions.transpose(),
            blocks: design.names(),
            speeds: None,
            data: None,
        };
        if let Some(tested) = tested {
            let prior = SpeedPrior::measured(deck);
            design.effects = estimate.add_speeds(&design, tested, prior)?;
        }
        for (i, parameter) in estimate.parameters.iter_mut().enumerate() {
            parameter.standard_error = estimate.covariance[(i, i)].max(0.0).sqrt();
        }
        estimate.data = Some(design);
        Ok(estimate)
    }

    /// Adds the scatter between mean speeds.
    fn add_speeds(
        &mut self,
        design: &Design,
        tested: ReducedFrequencyRange,
        prior: SpeedPrior,
    ) -> Result<Vec<Effect>> {
        let at = self.transfer_slopes(&spread_over(tested, POINTS))?;
        let values = DVector::from_vec(self.values());
        let own = self.own_coefficients();
        let (scatter, effects) =
            speed_scatter::between_speeds(design, prior, &self.dofs, &values, &own, &at)?;
        self.assumption = format!("{}; {}", self.assumption, scatter.describe());
        for effect in &effects {
            self.covariance += &effect.columns * effect.columns.transpose();
        }
        self.speeds = Some(scatter);
        Ok(effects)
    }

    /// The transfer matrix at every `K`, and its derivatives with respect to the parameters, by central differences.
    pub(super) fn transfer_slopes(&self, ks: &[ReducedFrequency]) -> Result<Vec<Slopes>> {
        let values = self.values();
        let model = self.model_at(&values)?;
        let mut pairs = Vec::with_capacity(values.len());
        for p in 0..values.len() {
            let step = STEP * values[p].abs().max(1e-2);
            let moved = |by: f64| {
                let mut moved = values.clone();
                moved[p] += by;
                self.model_at(&moved)
            };
            pairs.push((moved(step)?, moved(-step)?, 2.0 * step));
        }
        let at = |&k: &ReducedFrequency| {
            let slope = |(up, down, step): &(Model, Model, f64)| {
                Ok((up.transfer(k)? - down.transfer(k)?).unscale(*step))
            };
            let slopes = pairs.iter().map(slope).collect::<Result<_>>()?;
            Ok(Slopes {
                k: k.full_width(),
                value: model.transfer(k)?,
                slopes,
            })
        };
        ks.iter().map(at).collect()
    }

    /// Places of the coefficients of every transfer function, row by row; poles and static terms are nobody's.
    pub(crate) fn own_coefficients(&self) -> Vec<Vec<usize>> {
        let coefficients = match &self.coordinates {
            Coordinates::Continuous { searched, .. } => self.parameters.len() - searched.len(),
            Coordinates::Discrete { .. } => self.parameters.len(),
        };
        let of = |(force, motion): (Dof, Dof)| -> Vec<usize> {
            let is_own = |p: &usize| {
                let q = &self.parameters[*p];
                (q.force, q.motion) == (Some(force), Some(motion))
            };
            (0..coefficients).filter(is_own).collect()
        };
        let dofs = &self.dofs;
        let pairs = dofs.iter().flat_map(|f| dofs.iter().map(|m| (*f, *m)));
        pairs.map(of).collect()
    }

    /// What is wrong with the form of the model whatever the data, if anything: its onset is biased, and no scatter shows it.
    pub(crate) fn known_bias(&self) -> Option<&'static str> {
        match &self.coordinates {
            Coordinates::Continuous { .. } => None,
            Coordinates::Discrete { .. } => Some(
                "the sampled model has no feed-through and holds its force over a step: its bias is known to be there, and \
                 not in the scatter",
            ),
        }
    }

    /// Checks what was read from a file: that there are as many parameters and covariances as the coordinates say.
    pub(super) fn validate(&self) -> Result<()> {
        let n = self.dofs.len();
        ensure(n > 0, "dofs", "at least one", "none")?;
        let parameters = self.coordinates.parameters(n)?;
        let found = self.parameters.len();
        ensure(found == parameters, "parameters", parameters, found)?;
        let (rows, columns) = self.covariance.shape();
        let expected = format_args!("{parameters}×{parameters} numbers");
        let found = format_args!("{rows}×{columns}");
        let square = [rows, columns] == [parameters; 2];
        ensure(square, "covariance", expected, found)
    }

    /// The estimates.
    pub fn values(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.value).collect()
    }

    /// The model with other parameters.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for another number of parameters or a pole that is not positive.
    pub fn model_at(&self, values: &[f64]) -> Result<Model> {
        let n = self.dofs.len();
        let (expected, found) = (self.parameters.len(), values.len());
        ensure(found == expected, "parameters", expected, found)?;
        match &self.coordinates {
            Coordinates::Continuous {
                form,
                chains,
                searched,
            } => {
                let first_pole = expected.saturating_sub(searched.len());
                let mut chains = chains.concat();
                for (pole, value) in searched.iter().zip(&values[first_pole..]) {
                    pole.move_to(*value, form, &mut chains);
                }
                let coefficients = per_chain(form, &chains, values);
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

    /// Standard error of `gradient · parameters`.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for a gradient of another length.
    pub fn standard_error(&self, gradient: &[f64]) -> Result<f64> {
        let (expected, found) = (self.parameters.len(), gradient.len());
        ensure(found == expected, "gradient", expected, found)?;
        let g = DVector::from_column_slice(gradient);
        Ok(g.dot(&(&self.covariance * &g)).max(0.0).sqrt())
    }

    /// Degrees of freedom of that standard error; `None` for an estimate that was read from a file, which no longer knows
    /// its data.
    pub fn degrees_of_freedom(&self, gradient: &[f64]) -> Option<f64> {
        let gradient = DVector::from_column_slice(gradient);
        let design = self.data.as_ref()?;
        Some(speed_scatter::degrees_of_freedom(design, &gradient))
    }

    /// The estimates and a step from them.
    pub(super) fn moved_by(&self, step: &DVector<f64>) -> Vec<f64> {
        let moved = self.parameters.iter().zip(step.iter());
        moved.map(|(p, d)| p.value + d).collect()
    }

    /// Whether these coefficients make `model`, as its transfer matrix at one `K` tells.
    pub(super) fn makes(&self, model: &dyn Transfer, k: ReducedFrequency) -> Result<bool> {
        let own = self.model_at(&self.values())?;
        if own.dofs() != model.dofs() {
            return Ok(false);
        }
        let (a, b) = (own.transfer(k)?, model.transfer(k)?);
        Ok((a - &b).norm() <= SAME_MODEL * b.norm())
    }

    /// The fit to the tests at each mean speed alone, with the poles of the fit to all; empty for tests at one speed and
    /// for an estimate that was read from a file.
    ///
    /// The second value is why a speed alone does not tell.
    pub(crate) fn at_each_speed(&self) -> Vec<(f64, Result<Self>)> {
        let Some(design) = &self.data else {
            return Vec::new();
        };
        let Some((groups, speeds_m_s)) = speed_groups(&design.blocks) else {
            return Vec::new();
        };
        let alone = |(g, speed): (usize, f64)| (speed, self.alone(design, &groups, g));
        speeds_m_s.into_iter().enumerate().map(alone).collect()
    }

    /// Reduced frequencies of the blocks, where they have one and are known.
    pub(crate) fn tested_range(&self) -> Option<ReducedFrequencyRange> {
        let ks = self.data.as_ref()?.blocks.iter().filter_map(|b| b.k);
        ReducedFrequencyRange::spanning(ks.map(ReducedFrequency::from_full_width))
    }

    fn alone(&self, design: &Design, groups: &[usize], group: usize) -> Result<Self> {
        let mut coordinates = self.coordinates.clone();
        let mut kept = self.parameters.len();
        if let Coordinates::Continuous { searched, .. } = &mut coordinates {
            kept -= searched.len();
            searched.clear();
        }
        let (own, step) = design.alone(groups, group, kept)?;
        let mut moved = self.parameters[..kept].to_vec();
        for (parameter, change) in moved.iter_mut().zip(step.iter()) {
            parameter.value += change;
        }
        let (assumption, dofs) = ("blocks of one mean speed".into(), self.dofs.clone());
        Self::new(assumption, None, None, dofs, coordinates, moved, own)
    }

    /// Puts these standard errors and covariances in the place of those of a fit that took residuals for independent.
    ///
    /// The covariance of an entry is its block of the covariance of all parameters, so that standard errors are the roots of
    /// its diagonal. Coefficients move with the searched poles: whoever draws models needs all parameters.
    pub fn enter(&self, report: &mut FitReport) {
        let own = self.own_coefficients();
        for (entry, own) in report.entries.iter_mut().zip(&own) {
            if own.len() != entry.coefficients.len() {
                continue;
            }
            for (coefficient, &p) in entry.coefficients.iter_mut().zip(own) {
                coefficient.standard_error = Some(self.parameters[p].standard_error);
            }
            let row = |&p: &usize| own.iter().map(|&q| self.covariance[(p, q)]).collect();
            entry.covariance = own.iter().map(row).collect();
        }
        report.covariance_assumption.clone_from(&self.assumption);
    }
}

/// `points` reduced frequencies from one end of a range to the other, logarithmic.
pub(super) fn spread_over(range: ReducedFrequencyRange, points: usize) -> Vec<ReducedFrequency> {
    let [low, high] = [range.min, range.max].map(ReducedFrequency::full_width);
    let all = in_equal_ratios(low, high, points);
    all.map(ReducedFrequency::from_full_width).collect()
}
