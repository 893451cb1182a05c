//! Models drawn from the covariance of a fit.

use super::coefficients::CoefficientUncertainty;
use super::columns::Expansion;
use super::parameters::Coordinates;
use super::statistics::covariance_root;
use crate::error::{Error, Result};
use crate::identification::Form;
use crate::identification::basis::assemble;
use crate::trained_model::Model;
use nalgebra::{DMatrix, DVector};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Normal draws of the parameters of a fit, and the models that they make. Searched poles move the transfer function along its slope, in
/// chains that hold both: a pole far from the estimate with coefficients that were not refitted for it makes no sense; the model that is
/// linear in its parameters is what the covariance speaks of, however far it is followed. So every draw has the poles of the fit.
#[derive(Debug)]
pub struct ModelDraws<'a> {
    estimate: &'a CoefficientUncertainty,
    /// Every transfer function, row by row; none where no poles were searched.
    entries: Vec<Expansion>,
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
        let entries = match &estimate.coordinates {
            Coordinates::Continuous {
                form,
                chains,
                searched,
            } if !searched.is_empty() => {
                Expansion::each(form, &chains.concat(), &estimate.values(), searched)?
            }
            _ => Vec::new(),
        };
        Ok(Self {
            estimate,
            entries,
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
        let estimate = self.estimate;
        let (form, searched) = match &estimate.coordinates {
            Coordinates::Continuous { form, searched, .. } if !searched.is_empty() => {
                (form, searched.len())
            }
            _ => return estimate.model_at(values),
        };
        let poles = values.len() - searched;
        let moved = DVector::from_fn(searched, |m, _| {
            values[poles + m] - estimate.parameters[poles + m].value
        });
        let mut rest = values;
        let mut list = Vec::with_capacity(self.entries.len());
        for Expansion { native, slopes, .. } in &self.entries {
            let (own, others) = rest.split_at(native.ncols());
            rest = others;
            let all: DVector<f64> = native * DVector::from_column_slice(own) + slopes * &moved;
            list.push(all.as_slice().to_vec());
        }
        let chains: Vec<Vec<f64>> = self.entries.iter().map(|e| e.extended.clone()).collect();
        let form = Form::TakenakaMalmquist {
            filters: chains.first().map_or(0, Vec::len),
            feed_through: form.feed_through(),
            pole_per_transfer_function: true,
        };
        assemble(&form, &estimate.dofs, &chains, &list)
    }
}
