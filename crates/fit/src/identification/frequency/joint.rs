//! All transfer functions of a table at given poles, each by itself and together under constraints.

use crate::error::Result;
use crate::identification::basis::Basis;
use crate::identification::constrained::LinearSolution;
use crate::identification::dissipative::{FitRequirements, Solution};
use crate::identification::entry_report::EntryReport;
use crate::identification::form::Form;
use crate::identification::joint::JointFit;
use crate::identification::report::{relative_noise, variance};
use crate::identification::samples::{EntrySamples, shares};
use nalgebra::{DMatrix, DVector};

/// Share of an entry that the search leaves out (weight zero) over the largest: it is free to follow the others.
const LEAST_SHARE: f64 = 1e-6;

/// All entries at given poles: each by itself and, once they are held, together under the constraints where these bind.
pub(super) struct EntryFits<'a> {
    entries: &'a [EntrySamples],
    pub bases: Vec<Basis>,
    solutions: Vec<LinearSolution>,
    /// The entries as they are held together; none before they are.
    joint: Option<JointFit>,
}

impl<'a> EntryFits<'a> {
    /// Each entry by itself, in the columns of the model or in orthonormal ones that span the same space.
    pub(super) fn alone(
        entries: &'a [EntrySamples],
        form: &Form,
        poles: &[Vec<f64>],
        native: bool,
    ) -> Result<Self> {
        let basis = |poles: &Vec<f64>| match native {
            true => Basis::new(form, poles),
            false => Basis::orthonormal(form, poles),
        };
        let bases = poles.iter().map(basis).collect::<Result<Vec<_>>>()?;
        let each = entries.iter().zip(&bases);
        Ok(Self {
            entries,
            solutions: each.map(|(e, b)| e.fit(b)).collect::<Result<_>>()?,
            bases,
            joint: None,
        })
    }

    /// The same held together by what is asked of them; weighted residuals of each entry are multiplied with its share, see
    /// [`Self::shares_by_noise`].
    pub(super) fn held(
        mut self,
        requirements: &FitRequirements,
        shares: &[f64],
        everywhere: bool,
    ) -> Result<Self> {
        let largest = shares.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let mut joint = JointFit::default();
        for (solution, share) in self.solutions.iter().zip(shares) {
            let spread = solution.spread()? / share.max(LEAST_SHARE * largest);
            joint.add(solution.coefficients.clone(), spread, *share);
        }
        let entries = joint.parts.clone();
        self.joint = Some(joint.held(entries, &self.bases, requirements, everywhere)?);
        Ok(self)
    }

    /// Weighted residuals of all entries together, as the search of poles takes them.
    pub(super) fn residuals(&self, shares: &[f64]) -> DVector<f64> {
        let mut all = Vec::new();
        for (e, (entry, share)) in self.entries.iter().zip(shares).enumerate() {
            let values = self.coefficients(e);
            all.extend(entry.weighted_residuals(&self.bases[e], values, *share));
            all.extend(self.solutions[e].penalty(values).map(|r| r * share));
        }
        DVector::from_vec(all)
    }

    /// Shares of the entries by their own scatter instead of their own size: under constraints the poles and the coefficients of
    /// one entry depend on those of others, and an entry that scatters by half of its size is no reason to bend one that is known to
    /// a hundredth. The scatter is that of this fit, without constraints; of its residuals all shares together say as much as
    /// those by size do.
    pub(super) fn shares_by_noise(&self) -> Vec<f64> {
        let by_size = shares(&self.entries.iter().collect::<Vec<_>>());
        let mut noisy = by_size.clone();
        let (mut before, mut after) = (0.0, 0.0);
        for (e, (entry, fit)) in self.entries.iter().zip(&self.solutions).enumerate() {
            let residual = fit.factor.residual_sum(fit.unknowns, 0);
            noisy[e] /= relative_noise(residual, entry.total(), entry.rows.len(), fit.unknowns);
            before += by_size[e].powi(2) * residual;
            after += noisy[e].powi(2) * residual;
        }
        if after > 0.0 {
            let scale = (before / after).sqrt();
            noisy.iter_mut().for_each(|share| *share *= scale);
        }
        noisy
    }

    /// What holds the entries together; none where nothing does.
    pub(super) fn solution(&self) -> Option<&Solution> {
        self.joint.as_ref()?.constrained.as_ref()
    }

    /// Coefficients of an entry.
    fn coefficients(&self, e: usize) -> &[f64] {
        match &self.joint {
            Some(joint) => joint.values(e),
            None => &self.solutions[e].coefficients,
        }
    }

    /// Accounts of all entries.
    ///
    /// # Errors
    /// Coefficients that are not determined.
    pub(super) fn reports(&self) -> Result<Vec<EntryReport>> {
        let (mut reports, mut variances) = (Vec::new(), Vec::new());
        for (e, entry) in self.entries.iter().enumerate() {
            let (values, fit) = (self.coefficients(e), &self.solutions[e]);
            let residuals = entry.residuals(&self.bases[e], values);
            reports.push(entry.report(&residuals, self.bases[e].poles(), fit));
            let rows = residuals.iter().zip(&entry.rows);
            let weighted = rows.map(|(r, row)| r * row.weight);
            let sum = match self.solution() {
                Some(_) => weighted.chain(fit.penalty(values)).map(|r| r * r).sum(),
                None => fit.factor.residual_sum(fit.unknowns, 0),
            };
            variances.push(variance(sum, entry.rows.len(), fit.unknowns));
        }
        let finished = |(e, report): (usize, EntryReport)| {
            let covariance = self.covariance(e, &variances)?;
            Ok(report.with_coefficients(self.bases[e].names(), self.coefficients(e), covariance))
        };
        reports.into_iter().enumerate().map(finished).collect()
    }

    /// Covariance of the coefficients of an entry from the variances of the weighted residuals of all entries.
    fn covariance(&self, e: usize, variances: &[Option<f64>]) -> Result<Option<DMatrix<f64>>> {
        let Some(own) = variances[e] else {
            return Ok(None);
        };
        match &self.joint {
            Some(joint) => Ok(joint.covariance(e, |part| variances[part].unwrap_or(0.0))),
            None => Ok(Some(self.solutions[e].inverse_gram()? * own)),
        }
    }
}
