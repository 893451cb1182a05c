//! Models drawn from the covariance of a fit.

use super::coefficients::CoefficientUncertainty;
use super::columns::LinearModel;
use super::statistics::covariance_root;
use crate::error::{Error, Result};
use crate::trained_model::Model;
use nalgebra::{DMatrix, DVector};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Normal draws of the parameters of a fit, and the models that they make. Searched poles move the transfer function along its
/// slope (see `LinearModel`), so that every draw is a model with the poles of the fit.
#[derive(Debug)]
pub struct ModelDraws<'a> {
    estimate: &'a CoefficientUncertainty,
    linear: Option<LinearModel>,
    /// Square root of the covariance.
    root: DMatrix<f64>,
}

impl<'a> ModelDraws<'a> {
    /// What all draws share.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the covariance has no square root, or columns of the basis cannot be told apart.
    pub fn new(estimate: &'a CoefficientUncertainty) -> Result<Self> {
        let (root, _) = covariance_root(estimate.covariance.clone())
            .ok_or_else(|| Error::Numerical("draws: the covariance has no square root".into()))?;
        Ok(Self {
            estimate,
            linear: estimate.linear()?,
            root,
        })
    }

    /// Parameters of one draw.
    pub(super) fn parameters(&self, random: &mut impl Rng) -> Vec<f64> {
        self.estimate.moved_by(&self.step(random))
    }

    /// From the estimates to one draw.
    fn step(&self, random: &mut impl Rng) -> DVector<f64> {
        let normal = |_, _| StandardNormal.sample(random);
        &self.root * DVector::from_fn(self.root.ncols(), normal)
    }

    /// The model that is `part` of the way from the estimates to one draw.
    ///
    /// # Errors
    /// Parameters that make no model.
    pub fn model(&self, random: &mut impl Rng, part: f64) -> Result<Model> {
        self.model_at(&self.estimate.moved_by(&(self.step(random) * part)))
    }

    /// The model of given parameters.
    pub(super) fn model_at(&self, values: &[f64]) -> Result<Model> {
        match &self.linear {
            Some(linear) => linear.model_at(values),
            None => self.estimate.model_at(values),
        }
    }
}
