//! What a fit to records or to a table is asked to do. The fields are keys of a study file; units are in their names, the rest is
//! dimensionless.

use super::basis::index_of;
use super::dissipative::{Constraints, FitRequirements};
use super::form::{Form, PoleSearch};
use super::own::{OwnFilters, StaticTerm, validate_own};
use super::time::record::Records;
use crate::error::{Result, ensure, non_negative, positive};
use crate::section::Dof;
use crate::units::ReducedFrequencyRange;
use serde::{Deserialize, Serialize};

/// Most filters of a fit to records that move sway too, where their number is left to the data.
const MOST_WITH_SWAY: usize = 4;

/// What the residuals of a fit to records are divided by; plain least squares lets the largest record dominate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeWeights {
    /// Nothing: residuals of the dimensionless forces.
    None,
    /// Root mean square of that force in that record.
    PerRecord,
    /// Root mean square of that force from the beginning of one segment (one frequency) to that of the next: relative
    /// errors. A record without segments is one.
    #[default]
    PerSegment,
}

/// Fit of a continuous model to forced-vibration records.
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_fit::*; pub use aerodeck_lab::*; }
/// use aerodeck::files::derivatives::embedded;
/// use aerodeck::identification::{Form, TimeFit, fit_records};
/// use aerodeck::section::Dof;
/// use aerodeck::wind_tunnel::{RecordSource, TunnelPlan};
///
/// let plan = TunnelPlan { sampling_hz: 50.0, segment_s: 12.0, ..TunnelPlan::default() };
/// let records = plan.records_from_table(&embedded::deck("LN21-5200")?, &Dof::TWO)?;
/// let records: Vec<&dyn RecordSource> = records.iter().map(|r| r as _).collect();
/// let fit = TimeFit { form: Form::Rational { lags: 1, added_mass: false }, ..TimeFit::default() };
/// assert_eq!(fit_records(&records, &fit, &|_, _| ())?.model.kind(), "rational functions");
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TimeFit {
    /// Form of the model.
    pub form: Form,
    /// Its poles.
    pub poles: PoleSearch,
    /// Weighting.
    pub weights: TimeWeights,
    /// What the model has to be above the tested range.
    pub constraints: Constraints,
    /// Cut-off of the low-pass filter that motion and force go through alike, Hz; left out, a twentieth of the
    /// sampling frequency.
    pub low_pass_hz: Option<f64>,
    /// Seconds at the start of each record that only settle the filters.
    pub discard_s: f64,
    /// What is done about a constant in the forces.
    pub static_term: StaticTerm,
    /// What `G` has to be at K → 0, exactly.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub limits: Vec<QuasiSteadyLimit>,
    /// Transfer functions with a number of filters or poles of their own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub own: Vec<OwnFilters>,
}

impl TimeFit {
    /// The same with a number of filters, where it is left to the data.
    pub(super) fn with_filters_for(&self, records: &Records) -> Self {
        let rows = match self.own.is_empty() {
            true => records.rows_of_tests(),
            false => 0,
        };
        let mut most = self.constraints.most_filters();
        if records.dofs.contains(&Dof::Lateral) {
            // shapes that mix sway with the others are not held: with five filters those of records of LN21-6100 feed one
            most = most.min(MOST_WITH_SWAY);
        }
        Self {
            form: self.form.for_rows(rows, most),
            ..self.clone()
        }
    }

    /// Checks every value.
    pub fn validate(&self) -> Result<()> {
        self.form.validate_for_records()?;
        self.poles.validate(&self.form)?;
        validate_own(&self.form, &self.own)?;
        validate_limits(&self.limits)?;
        if let Some(cutoff) = self.low_pass_hz {
            positive("low_pass_hz", cutoff)?;
        }
        non_negative("discard_s", self.discard_s).map(|_| ())
    }

    /// What the fit is asked for besides least squares.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for limits of degrees of freedom that are not there.
    pub(crate) fn requirements(
        &self,
        dofs: &[Dof],
        tested: ReducedFrequencyRange,
    ) -> Result<FitRequirements> {
        Ok(FitRequirements {
            limits: limits_by_entry(dofs, &self.limits)?,
            ..FitRequirements::new(dofs, tested, self.constraints)
        })
    }
}

impl TimeWeights {
    /// In words.
    pub(crate) fn describe(self) -> &'static str {
        match self {
            Self::None => "none: residuals of the dimensionless forces",
            Self::PerRecord => "1/RMS of each force in each record",
            Self::PerSegment => "1/RMS of each force in each segment",
        }
    }
}

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
        let any = stated.iter().any(Option::is_some);
        ensure(any, place, "a value, a slope or both", "neither")?;
        for x in stated.into_iter().flatten() {
            ensure(x.is_finite(), place, "finite numbers", x)?;
        }
        let same = |l: &QuasiSteadyLimit| (l.force, l.motion) == (limit.force, limit.motion);
        let twice = limits[..i].iter().any(same);
        ensure(!twice, place, "each entry once", "it twice")?;
    }
    Ok(())
}

/// Value and slope of every entry, row by row; empty when none is stated.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) for degrees of freedom that are not there.
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

    /// Checks every value.
    pub fn validate(&self) -> Result<()> {
        self.form.validate()?;
        self.poles.validate(&self.form)?;
        validate_own(&self.form, &self.own)?;
        non_negative("regularization", self.regularization)?;
        for weight in self.entry_weights.iter().flatten().flatten() {
            non_negative("entry_weights", *weight)?;
        }
        validate_limits(&self.limits)
    }

    /// Whether every entry is an unconstrained linear fit whose poles are shared by all or its own.
    pub(crate) fn is_plain(&self) -> bool {
        let weighted = self.entry_weights.is_some() || self.regularization > 0.0;
        !self.form.is_of_tables() && !weighted && self.limits.is_empty()
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
