//! What a fit is asked to do. The fields are keys of a study file; units are in their names, the rest is
//! dimensionless.

use super::dissipative::{Constraints, FitRequirements};
use super::form::{Form, PoleSearch};
use super::frequency_options::{QuasiSteadyLimit, limits_by_entry, validate_limits};
use super::own::{OwnFilters, StaticTerm, validate_own};
use super::time::record::Records;
use crate::error::{Result, non_negative, positive};
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
/// assert_eq!(fit_records(&records, &fit, &|_| ())?.model.kind(), "rational functions");
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
        let rows = if self.own.is_empty() {
            records.rows_of_tests()
        } else {
            0
        };
        let most = match records.dofs.contains(&Dof::Lateral) {
            // shapes that mix sway with the others are not held: with five filters those of records of LN21-6100 feed one
            true => self.constraints.most_filters().min(MOST_WITH_SWAY),
            false => self.constraints.most_filters(),
        };
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
            dofs: dofs.to_vec(),
            k_max: tested.max.full_width(),
            constraints: self.constraints,
            limits: limits_by_entry(dofs, &self.limits)?,
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
