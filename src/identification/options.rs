//! What a fit is asked to do. The fields are keys of a study file; units are in their names, the rest is
//! dimensionless.

use super::dissipative::{Constraints, Wishes};
use super::form::Form;
use super::frequency_options::{QuasiSteadyLimit, limits_by_entry, validate_limits};
use super::own::{OwnFilters, StaticTerm, validate_own};
use crate::error::{Error, Result, positive};
use crate::section::Dof;
use crate::units::ReducedFrequencyRange;
use serde::{Deserialize, Serialize};

/// Where the poles (lags) come from: fixed, or searched for within bounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PoleSearch {
    /// Poles to be used as they are; one for Laguerre filters, else one a filter. For lags of each force either one list
    /// for all of them, or the lists of the forces one after the other.
    pub fixed: Option<Vec<f64>>,
    /// Where the nonlinear step starts; left out, the best point of a grid.
    pub start: Option<Vec<f64>>,
    /// Lower bound; left out, half the lowest tested `K`.
    pub min: Option<f64>,
    /// Upper bound; left out, twice the highest tested `K`.
    pub max: Option<f64>,
    /// Least ratio of neighbouring poles when there are several: closer ones have nearly equal columns, whose
    /// coefficients grow and cancel.
    pub min_ratio: f64,
    /// Points of the first, logarithmic grid (one pole; fewer an axis for several).
    pub grid_points: usize,
}

impl Default for PoleSearch {
    fn default() -> Self {
        Self {
            fixed: None,
            start: None,
            min: None,
            max: None,
            min_ratio: 1.5,
            grid_points: 41,
        }
    }
}

impl PoleSearch {
    /// No search: these poles.
    pub fn fixed(poles: &[f64]) -> Self {
        Self {
            fixed: Some(poles.to_vec()),
            ..Self::default()
        }
    }

    pub(crate) fn validate(&self, form: &Form) -> Result<()> {
        for (key, list) in [("fixed", &self.fixed), ("start", &self.start)] {
            let Some(list) = list else { continue };
            let place = format!("poles.{key}");
            let several = key == "fixed" && form.poles_per_force();
            let fits = if several {
                !list.is_empty() && list.len().is_multiple_of(form.free_poles())
            } else {
                list.len() == form.free_poles()
            };
            if !fits {
                let expected = format!("{} number(s) for {}", form.free_poles(), form.describe());
                return Err(Error::input(place, expected, list.len().to_string()));
            }
            for p in list {
                positive(&place, *p)?;
            }
        }
        for (key, bound) in [("poles.min", self.min), ("poles.max", self.max)] {
            if let Some(bound) = bound {
                positive(key, bound)?;
            }
        }
        if let (Some(min), Some(max)) = (self.min, self.max)
            && min >= max
        {
            return Err(Error::input(
                "poles.max",
                "more than poles.min",
                max.to_string(),
            ));
        }
        if !(self.min_ratio > 1.0 && self.min_ratio.is_finite()) {
            return Err(Error::input(
                "poles.min_ratio",
                "more than 1",
                self.min_ratio.to_string(),
            ));
        }
        if self.grid_points < 5 {
            return Err(Error::input(
                "poles.grid_points",
                "at least 5",
                self.grid_points.to_string(),
            ));
        }
        Ok(())
    }
}

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
    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::Input`] naming the key.
    pub(crate) fn validate(&self) -> Result<()> {
        self.form.validate_for_records()?;
        self.poles.validate(&self.form)?;
        validate_own(&self.form, &self.own)?;
        validate_limits(&self.limits)?;
        if let Some(cutoff) = self.low_pass_hz {
            positive("low_pass_hz", cutoff)?;
        }
        crate::error::non_negative("discard_s", self.discard_s).map(|_| ())
    }
}

/// Filters or lags of one chain at most: ten times what any measured deck supports, and still fitted in seconds.
pub(crate) const MOST_FILTERS: usize = 100;

/// Checks a number of filters or lags.
///
/// # Errors
/// [`Error::Input`] naming `place` for none, and for more than any data could support.
pub(crate) fn number_of_filters(place: &str, count: usize) -> Result<()> {
    if (1..=MOST_FILTERS).contains(&count) {
        return Ok(());
    }
    let expected = if count == 0 {
        "at least 1".into()
    } else {
        format!("at most {MOST_FILTERS}")
    };
    Err(Error::input(place, expected, count.to_string()))
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

impl TimeFit {
    /// What the fit is asked for besides least squares.
    ///
    /// # Errors
    /// [`Error::Input`] for limits of degrees of freedom that are not there.
    pub(crate) fn wishes(&self, dofs: &[Dof], tested: ReducedFrequencyRange) -> Result<Wishes> {
        Ok(Wishes {
            dofs: dofs.to_vec(),
            k_max: tested.max.full_width(),
            constraints: self.constraints,
            limits: limits_by_entry(dofs, &self.limits)?,
        })
    }
}
