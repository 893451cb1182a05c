//! What a fit to a transfer matrix is asked to do.

use super::basis::index_of;
use super::dissipative::{Constraints, FitRequirements};
use super::form::Form;
use super::form::PoleSearch;
use super::own::{OwnFilters, validate_own};
use crate::error::{Error, Result, ensure, non_negative};
use crate::section::Dof;
use crate::units::ReducedFrequencyRange;
use serde::{Deserialize, Serialize};

/// What one entry of `G` has to be in slow motion: `G → value + slope·iK` for K → 0, as quasi-steady theory gives it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuasiSteadyLimit {
    /// Force (row of `G`).
    pub force: Dof,
    /// Motion (column of `G`).
    pub motion: Dof,
    /// `G(0)`, dimensionless; left out, free.
    pub value: Option<f64>,
    /// `dG/d(iK)` at 0, dimensionless; left out, free.
    pub slope: Option<f64>,
}

/// Checks what can be checked without the data.
pub(super) fn validate_limits(limits: &[QuasiSteadyLimit]) -> Result<()> {
    for (i, limit) in limits.iter().enumerate() {
        let place = format_args!("limits[{i}]");
        let stated = [limit.value, limit.slope];
        ensure(
            stated.iter().any(Option::is_some),
            place,
            "a value, a slope or both",
            "neither",
        )?;
        if let Some(x) = stated.iter().flatten().find(|x| !x.is_finite()) {
            return Err(Error::input(place, "finite numbers", x.to_string()));
        }
        let same = |l: &&QuasiSteadyLimit| (l.force, l.motion) == (limit.force, limit.motion);
        ensure(
            !limits[..i].iter().any(|l| same(&l)),
            place,
            "each entry once",
            "it twice",
        )?;
    }
    Ok(())
}

/// Value and slope of every entry, row by row; empty when none is stated.
///
/// # Errors
/// [`Error::Input`] for degrees of freedom that are not there.
pub(super) fn limits_by_entry(
    dofs: &[Dof],
    limits: &[QuasiSteadyLimit],
) -> Result<Vec<[Option<f64>; 2]>> {
    if limits.is_empty() {
        return Ok(Vec::new());
    }
    let mut all = vec![[None; 2]; dofs.len() * dofs.len()];
    for (at, limit) in limits.iter().enumerate() {
        let place = format!("limits[{at}]");
        let i = index_of(dofs, limit.force, &place)?;
        let j = index_of(dofs, limit.motion, &place)?;
        all[i * dofs.len() + j] = [limit.value, limit.slope];
    }
    Ok(all)
}

/// What the residuals of a fit to a transfer matrix are divided by. In the search of poles that several entries share,
/// each entry counts in proportion to its own weighted size besides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FrequencyWeights {
    /// Nothing: residuals of `G`; large entries at high `K` dominate.
    None,
    /// `K²`: residuals of the derivatives themselves; low `K` dominates.
    Derivatives,
    /// `|G|` of that entry at that point: relative errors.
    #[default]
    Relative,
}

/// Fit of a continuous model to a table or any other transfer matrix.
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_fit::*; pub use aerodeck_lab::*; }
/// use aerodeck::files::derivatives::embedded;
/// use aerodeck::identification::{FrequencyFit, FrequencyWeights, fit_table};
/// use aerodeck::section::Dof;
///
/// let table = embedded::deck("LN21-5200")?;
/// let fit = FrequencyFit { weights: FrequencyWeights::Derivatives, ..FrequencyFit::default() };
/// let fitted = fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &fit)?;
/// assert!(fitted.report.weights.contains("derivatives"), "{}", fitted.report.weights);
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FrequencyFit {
    /// Form of the model.
    pub form: Form,
    /// Its poles.
    pub poles: PoleSearch,
    /// Weighting of the points of an entry.
    pub weights: FrequencyWeights,
    /// What the model has to be above the tested range.
    pub constraints: Constraints,
    /// Transfer functions with a number of filters or poles of their own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub own: Vec<OwnFilters>,
    /// Weight of each entry besides, rows and columns in the order of the degrees of freedom; left out, one. It matters
    /// where entries share something: poles, or the states of the minimum-state form.
    pub entry_weights: Option<Vec<Vec<f64>>>,
    /// Regularisation `λ ≥ 0` of lag terms (filters): a term as large as the data counts as much as a relative residual
    /// of `λ`. Zero for none.
    pub regularization: f64,
    /// What `G` has to be at K → 0, exactly.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub limits: Vec<QuasiSteadyLimit>,
}

impl FrequencyFit {
    /// The same with a number of filters, where it is left to the data: `rows` samples of the entry that has fewest.
    pub(super) fn with_filters_for(&self, rows: usize) -> Self {
        let rows = if self.own.is_empty() { rows } else { 0 };
        let most = self.constraints.most_filters();
        Self {
            form: self.form.for_rows(rows, most),
            ..self.clone()
        }
    }

    /// What the fit is asked for besides least squares, but for the limits: every entry or force meets its own.
    pub(super) fn requirements(
        &self,
        dofs: &[Dof],
        tested: ReducedFrequencyRange,
    ) -> FitRequirements {
        FitRequirements {
            dofs: dofs.to_vec(),
            k_max: tested.max.full_width(),
            constraints: self.constraints,
            limits: Vec::new(),
        }
    }

    /// Checks every value.
    pub fn validate(&self) -> Result<()> {
        self.form.validate()?;
        self.poles.validate(&self.form)?;
        validate_own(&self.form, &self.own)?;
        non_negative("regularization", self.regularization)?;
        for row in self.entry_weights.iter().flatten() {
            for weight in row {
                non_negative("entry_weights", *weight)?;
            }
        }
        validate_limits(&self.limits)
    }

    /// Whether every entry is an unconstrained linear fit whose poles are shared by all or its own.
    pub(crate) fn is_plain(&self) -> bool {
        let rational_only = matches!(
            self.form,
            Form::RationalPerForce { .. } | Form::MinimumState { .. }
        );
        let weighted = self.entry_weights.is_some() || self.regularization > 0.0;
        !rational_only && !weighted && self.limits.is_empty()
    }

    /// The weight of entry `(i, j)` of an n×n matrix.
    pub(super) fn entry_weight(&self, n: usize, i: usize, j: usize) -> Result<f64> {
        let Some(rows) = &self.entry_weights else {
            return Ok(1.0);
        };
        let lengths: Vec<usize> = rows.iter().map(Vec::len).collect();
        ensure(
            lengths.len() == n && lengths.iter().all(|length| *length == n),
            "entry_weights",
            format_args!("{n} rows of {n} numbers"),
            format_args!("rows of {lengths:?}"),
        )?;
        Ok(rows[i][j])
    }
}
