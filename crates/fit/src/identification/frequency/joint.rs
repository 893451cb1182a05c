//! All transfer functions of a table at once, held together by constraints.

use crate::error::Result;
use crate::identification::affine::AffineMap;
use crate::identification::basis::Basis;
use crate::identification::constrained::LinearSolution;
use crate::identification::dissipative::{Dissipation, FitRequirements, Solution, Strictness};
use crate::identification::form::Form;
use crate::identification::report::relative_noise;
use crate::identification::samples::{EntrySamples, shares};
use nalgebra::{DMatrix, DVector};

/// Share of an entry that the search leaves out (weight zero) over the largest: it is free to follow the others.
const LEAST_SHARE: f64 = 1e-6;

/// What stays the same for all poles.
pub(super) struct Joint<'a> {
    pub entries: &'a [EntrySamples],
    pub form: &'a Form,
    pub requirements: FitRequirements,
    /// What the weighted residuals of each entry are multiplied with, see [`by_noise`].
    pub shares: Vec<f64>,
}

/// All entries at given poles: each by itself, and together under the constraints where these bind.
pub(super) struct JointFit<'a> {
    entries: &'a [EntrySamples],
    shares: Vec<f64>,
    pub bases: Vec<Basis>,
    pub solutions: Vec<LinearSolution>,
    linear: Vec<AffineMap>,
    pub constrained: Option<Solution>,
}

/// Shares of the entries by their own scatter instead of their own size: under constraints the poles and the coefficients of
/// one entry depend on those of others, and an entry that scatters by half of its size is no reason to bend one that is known to
/// a hundredth. The scatter is that of the fit without constraints at `poles`; of their fit all shares together say as much as
/// those by size do.
///
/// # Errors
/// Entries that cannot be fitted.
pub(super) fn by_noise(
    entries: &[EntrySamples],
    form: &Form,
    poles: &[Vec<f64>],
) -> Result<Vec<f64>> {
    let all: Vec<&EntrySamples> = entries.iter().collect();
    let by_size = shares(&all);
    let mut noisy = by_size.clone();
    let (mut before, mut after) = (0.0, 0.0);
    for (e, entry) in entries.iter().enumerate() {
        let fit = entry.fit(&Basis::new(form, &poles[e])?)?;
        let residual = fit.factor.residual_sum(fit.unknowns, 0);
        noisy[e] /= relative_noise(residual, entry.total(), entry.rows.len(), fit.unknowns);
        before += by_size[e].powi(2) * residual;
        after += noisy[e].powi(2) * residual;
    }
    if after > 0.0 {
        let scale = (before / after).sqrt();
        noisy.iter_mut().for_each(|share| *share *= scale);
    }
    Ok(noisy)
}

impl<'a> Joint<'a> {
    /// The constrained fit in the columns of the model.
    pub(crate) fn at(&self, poles: &[Vec<f64>]) -> Result<JointFit<'a>> {
        self.fit(poles, true, Strictness::Everywhere)
    }

    /// Weighted residuals of all entries, as the search of poles takes them.
    pub(crate) fn residuals(&self, poles: &[Vec<f64>]) -> Result<DVector<f64>> {
        // a ridge weighs the terms of the model themselves, else only the space counts
        let native = self.entries.iter().any(|e| e.ridge > 0.0);
        Ok(self.fit(poles, native, Strictness::Sampled)?.residuals())
    }

    fn fit(
        &self,
        poles: &[Vec<f64>],
        native: bool,
        strictness: Strictness,
    ) -> Result<JointFit<'a>> {
        let basis = |poles: &Vec<f64>| {
            if native {
                Basis::new(self.form, poles)
            } else {
                Basis::orthonormal(self.form, poles)
            }
        };
        let bases = poles.iter().map(basis).collect::<Result<Vec<_>>>()?;
        let shares = self.shares.clone();
        let least = LEAST_SHARE * shares.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let (mut solutions, mut linear, mut at) = (Vec::new(), Vec::new(), 0);
        for ((entry, basis), share) in self.entries.iter().zip(&bases).zip(&shares) {
            let solution = entry.fit(basis)?;
            linear.push(AffineMap {
                values: solution.coefficients.clone(),
                spread: solution.spread()? / share.max(least),
                at,
            });
            at += solution.unknowns;
            solutions.push(solution);
        }
        let constrained =
            Dissipation::new(&bases, &self.requirements).solve(&linear, strictness)?;
        Ok(JointFit {
            entries: self.entries,
            shares,
            bases,
            solutions,
            linear,
            constrained,
        })
    }
}

impl JointFit<'_> {
    /// Coefficients of an entry.
    pub(crate) fn coefficients(&self, e: usize) -> &[f64] {
        match &self.constrained {
            Some(constrained) => &constrained.coefficients[e],
            None => &self.solutions[e].coefficients,
        }
    }

    fn residuals(&self) -> DVector<f64> {
        let mut all = Vec::new();
        for (e, entry) in self.entries.iter().enumerate() {
            let values = self.coefficients(e);
            let share = self.shares[e];
            all.extend(entry.weighted_residuals(&self.bases[e], values, share));
            all.extend(self.solutions[e].penalty(values).map(|r| r * share));
        }
        DVector::from_vec(all)
    }

    /// Covariance of the coefficients of an entry from the variances of the weighted residuals of all entries: what the
    /// active constraints take is known.
    pub(crate) fn covariance(&self, e: usize, variances: &[Option<f64>]) -> Option<DMatrix<f64>> {
        let constrained = self.constrained.as_ref()?;
        variances[e]?;
        let all = self.linear.iter().zip(&self.shares).zip(variances);
        let free = all.map(|((linear, share), v)| {
            let variance = v.unwrap_or(0.0) * share * share;
            (linear.spread.ncols(), variance)
        });
        Some(constrained.space.covariance(&self.linear[e], free))
    }
}
