//! Parts of a least-squares problem at given poles, each solved by itself, and held together by what is asked of them all.

use super::affine::AffineMap;
use super::basis::Basis;
use super::dissipative::{FitRequirements, Solution, constrained};
use crate::error::Result;
use nalgebra::DMatrix;

/// Parts, and the fit of all of them together where what is asked of them binds.
#[derive(Default)]
pub(crate) struct JointFit {
    /// Transfer functions, or forces with all of theirs.
    pub parts: Vec<AffineMap>,
    /// Scale of the weighted residual of each part in the objective.
    pub shares: Vec<f64>,
    /// Transfer functions, row by row.
    entries: Vec<AffineMap>,
    pub constrained: Option<Solution>,
}

impl JointFit {
    /// Adds a part with the coefficients of its own solution, and what they become in units of the objective.
    pub(crate) fn add(&mut self, values: Vec<f64>, spread: DMatrix<f64>, share: f64) -> &AffineMap {
        let at = self.parts.last().map_or(0, AffineMap::end);
        self.shares.push(share);
        self.parts.push(AffineMap { values, spread, at });
        &self.parts[self.parts.len() - 1]
    }

    /// The same held together: the transfer functions, which are made of the parts, have these bases.
    ///
    /// # Errors
    /// Constraints that no coefficients satisfy.
    pub(crate) fn held(
        mut self,
        entries: Vec<AffineMap>,
        bases: &[Basis],
        requirements: &FitRequirements,
        everywhere: bool,
    ) -> Result<Self> {
        self.constrained = constrained(&entries, bases, requirements, everywhere)?;
        self.entries = entries;
        Ok(self)
    }

    /// Coefficients of a transfer function.
    pub(crate) fn values(&self, e: usize) -> &[f64] {
        match &self.constrained {
            Some(constrained) => &constrained.coefficients[e],
            None => &self.entries[e].values,
        }
    }

    /// Coefficients of a part.
    pub(crate) fn of_part(&self, part: usize) -> Vec<f64> {
        match &self.constrained {
            Some(constrained) => self.parts[part].coefficients(&constrained.free),
            None => self.parts[part].values.clone(),
        }
    }

    /// What the constraints add to the sum of the squares of the weighted residuals of a part.
    pub(crate) fn added(&self, part: usize) -> f64 {
        let (own, share) = (&self.parts[part], self.shares[part]);
        let moved = |constrained: &Solution| {
            let own = constrained.free.rows(own.at, own.spread.ncols());
            own.norm_squared() / (share * share)
        };
        self.constrained.as_ref().map_or(0.0, moved)
    }

    /// Covariance of the coefficients of a transfer function, from the variances of the weighted residuals of all parts: what the
    /// active constraints take is known. None where nothing holds the fit.
    pub(crate) fn covariance(
        &self,
        e: usize,
        variance: impl Fn(usize) -> f64,
    ) -> Option<DMatrix<f64>> {
        let space = &self.constrained.as_ref()?.space;
        let all = self.parts.iter().zip(&self.shares).enumerate();
        let free = all.map(|(p, (part, share))| (part.spread.ncols(), variance(p) * share * share));
        Some(space.covariance(&self.entries[e], free))
    }
}
