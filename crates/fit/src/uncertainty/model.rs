//! All that is known of the uncertainty of one trained model, as it is saved beside it.

use super::coefficients::{CoefficientUncertainty, spread_over};
use super::forms::{FormEnsemble, FormSpread};
use super::onset::{
    CONFIDENCE, OnsetError, ResampledOnset, Resampling, onset_error, resample_onset,
    speed_and_omega,
};
use super::speed_onsets::{Contradiction, SpeedOnsets, speed_onsets};
use super::statistics::two_sided_quantile;
use crate::aerodynamics::derivatives::{Derivative, Part};
use crate::aerodynamics::{Transfer, TransferMatrix};
use crate::error::{Error, Result};
use crate::flutter::{ErrorParts, Onset, OnsetInterval, OnsetMethod, OnsetSearch};
use crate::identification::samples::part_of;
use crate::json;
use crate::section::Structure;
use crate::state_space::boundary;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use serde::{Deserialize, Serialize};
use std::convert::Infallible;

/// Replicates of each resampling.
const REPLICATES: usize = 400;
/// Onsets closer than this, relatively, are that of the section of the training.
const SAME_ONSET: f64 = 1e-9;
/// How far above the onset of a model those of other forms are looked for.
const REACH: f64 = 2.0;
/// Degrees of freedom from which on an interval is that of the normal distribution.
const MANY: f64 = 1e6;
/// Reduced frequencies at which derivatives are stated.
const DERIVATIVE_POINTS: usize = 9;

/// Uncertainty of a trained model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelUncertainty {
    /// Coefficients and their covariance.
    pub coefficients: CoefficientUncertainty,
    /// Onset of the section it was trained for, if that flutters.
    pub onset: Option<OnsetError>,
    /// The same onset by the block bootstrap.
    pub block_bootstrap: Option<ResampledOnset>,
    /// The same onset by coefficients drawn from their covariance.
    pub drawn_coefficients: Option<ResampledOnset>,
    /// Onsets by the tests at each mean speed alone.
    #[serde(default)]
    pub speeds: SpeedOnsets,
    /// Other forms that explain the data as well; none where none were fitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forms: Option<FormEnsemble>,
    /// Their onsets with the section that the model was trained for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form_spread: Option<FormSpread>,
    /// Derivatives over the tested range.
    pub derivatives: Vec<DerivativeInterval>,
}

impl ModelUncertainty {
    /// Carries the covariance of the coefficients to derivatives and onset.
    pub fn new(
        coefficients: CoefficientUncertainty,
        structure: &Structure,
        onset: Option<&Onset>,
        search: OnsetSearch,
        tested: ReducedFrequencyRange,
    ) -> Result<Self> {
        let mut uncertainty = Self::of_data(coefficients, None, tested)?;
        let Some(onset) = onset else {
            return Ok(uncertainty);
        };
        let own = &uncertainty.coefficients;
        let resampled =
            |by| resample_onset(own, structure, onset, by, REPLICATES, &search, Some(tested));
        uncertainty.onset = Some(onset_error(own, structure, speed_and_omega(onset), None)?);
        uncertainty.block_bootstrap = resampled(Resampling::Blocks)?;
        uncertainty.drawn_coefficients = resampled(Resampling::Normal)?;
        uncertainty.speeds = speed_onsets(own, structure, onset, &search, tested)?;
        Ok(uncertainty)
    }

    /// Of data alone: no section was asked yet. [`Self::interval`] gives the interval of an onset with any.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the derivatives of the model cannot be computed.
    pub fn of_data(
        coefficients: CoefficientUncertainty,
        forms: Option<FormEnsemble>,
        tested: ReducedFrequencyRange,
    ) -> Result<Self> {
        Ok(Self {
            derivatives: coefficients.derivatives(tested)?,
            coefficients,
            onset: None,
            block_bootstrap: None,
            drawn_coefficients: None,
            speeds: SpeedOnsets::default(),
            forms,
            form_spread: None,
        })
    }

    /// Adds other forms that explain the data as well, and their onsets with the section that the model was trained for.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the eigenvalues of a form cannot be computed.
    pub fn with_forms(
        mut self,
        forms: FormEnsemble,
        structure: &Structure,
        search: &OnsetSearch,
    ) -> Result<Self> {
        let onset = self.onset.as_ref().map_or(0.0, |o| REACH * o.speed_m_s);
        // a search that ends just above its onset has none of the others
        let search = OnsetSearch {
            speed_max_m_s: search.speed_max_m_s.max(onset),
            ..*search
        };
        self.form_spread = Some(forms.spread(structure, &search)?);
        self.forms = Some(forms);
        Ok(self)
    }

    /// What the choice of the form leaves open of an onset, with any section: the spread that was computed in training where its onset is
    /// asked, a new one otherwise.
    fn spread_of(&self, structure: &Structure, onset: &Onset) -> Result<Option<FormSpread>> {
        if self.is_own(onset) {
            return Ok(self.form_spread.clone());
        }
        let (forms, search) = (self.forms.as_ref(), Self::search_of(onset));
        forms.map(|f| f.spread(structure, &search)).transpose()
    }

    /// Degrees of freedom with which draws of the parameters scatter: those of the onset's variance, and where training found no
    /// onset the fewest of any derivative, which its interval shows; none where nothing here has an interval.
    pub(super) fn degrees_of_freedom_of_draws(&self) -> Option<f64> {
        if let Some(onset) = &self.onset {
            return Some(onset.degrees_of_freedom);
        }
        let known = self.derivatives.iter().filter(|d| d.standard_error > 0.0);
        let widest = known.map(|d| 0.5 * (d.high - d.low) / d.standard_error);
        let widest = widest.filter(|w| w.is_finite()).reduce(f64::max)?;
        let Ok([holds, fails]) = boundary(0.5, MANY, 0.0, |nu| {
            Ok::<_, Infallible>(two_sided_quantile(CONFIDENCE, nu) > widest)
        });
        Some(0.5 * (holds + fails))
    }

    /// Interval of an onset of `model`, on any structure.
    pub fn interval(
        &self,
        model: &dyn Transfer,
        structure: &Structure,
        onset: &Onset,
    ) -> Result<OnsetInterval> {
        if onset.at.method == OnsetMethod::Determinant {
            return Ok(OnsetInterval::none("found without the model's realisation"));
        }
        if !self.coefficients.makes(model, onset.at.reduced_frequency)? {
            let why = "the covariance on file belongs to another training";
            return Ok(OnsetInterval::none(why));
        }
        let known = self.onset.as_ref().map(|o| o.degrees_of_freedom);
        let error = onset_error(&self.coefficients, structure, speed_and_omega(onset), known)?;
        if let Some(bias) = self.coefficients.known_bias() {
            let alone = error.standard_error_m_s;
            let why = format!("{bias} (standard error of the scatter alone {alone:.3} m/s)");
            return Ok(OnsetInterval::none(why));
        }
        let spread = self.spread_of(structure, onset)?;
        Ok(interval_with_forms(&error, spread.as_slice()))
    }

    /// Reads what was saved.
    ///
    /// # Errors
    /// [`Error::Input`] for text that is not such a file, and for parameters that make no model.
    pub fn from_json(text: &str) -> Result<Self> {
        let what = "the uncertainty of a model as written by `aerodeck train`";
        let read: Self = json::read("uncertainty", text).map_err(|e| Error::json(what, &e))?;
        read.coefficients.validate()?;
        read.forms.iter().try_for_each(FormEnsemble::validate)?;
        Ok(read)
    }

    /// Indented JSON.
    pub fn to_json(&self) -> Result<String> {
        json::write("uncertainty", self)
    }

    /// What a reader must know of the onset: that the mean speeds contradict each other.
    pub fn warning(&self) -> Option<String> {
        let contradiction = self.speeds.contradiction.as_ref();
        contradiction.map(Contradiction::explain)
    }

    /// The same of an onset with any section; where the tests are not known any more, of that of the training.
    pub fn warning_of(&self, structure: &Structure, onset: &Onset) -> Option<String> {
        if self.is_own(onset) {
            return self.warning();
        }
        let (own, search) = (&self.coefficients, Self::search_of(onset));
        let found = |tested| speed_onsets(own, structure, onset, &search, tested).ok();
        let found = own.tested_range().and_then(found);
        let found = found.filter(|f| !f.each.is_empty());
        found.map_or_else(|| self.warning(), |f| f.contradiction.map(|c| c.explain()))
    }

    /// Whether an onset is that of the section of the training.
    fn is_own(&self, onset: &Onset) -> bool {
        let same = |own: &OnsetError| (own.speed_m_s / onset.at.speed_m_s - 1.0).abs() < SAME_ONSET;
        self.onset.as_ref().is_some_and(same)
    }

    /// A search as far beyond an onset as its other forms are looked for.
    fn search_of(onset: &Onset) -> OnsetSearch {
        OnsetSearch::up_to(REACH * onset.at.speed_m_s)
    }

    /// The onset's interval with its two checks, in words.
    pub fn explain(&self) -> Option<String> {
        let onset = self.onset.as_ref()?;
        let stated = interval_with_forms(onset, self.form_spread.as_slice());
        let OnsetInterval::Known(known) = stated else {
            return stated.reason().map(|reason| format!("onset {reason}"));
        };
        let other = |r: &Option<ResampledOnset>| match r {
            Some(r) => format!("{:.3} m/s", r.standard_deviation_m_s),
            None => "none (no draw has an onset)".to_owned(),
        };
        let interval = match self.coefficients.known_bias() {
            Some(bias) => format!("no 95 % interval, since {bias}"),
            None => format!(
                "95 % interval {:.3} to {:.3} ({:.1} degrees of freedom; {})",
                known.low_m_s,
                known.high_m_s,
                known.degrees_of_freedom,
                known.parts.explain()
            ),
        };
        Some(format!(
            "onset {:.3} m/s, {interval}; standard error of the scatter by sensitivities \
             {:.3} m/s, by block bootstrap {}, by drawn coefficients {}",
            onset.speed_m_s,
            onset.standard_error_m_s,
            other(&self.block_bootstrap),
            other(&self.drawn_coefficients),
        ))
    }
}

impl CoefficientUncertainty {
    /// All derivatives of the model with their intervals, at a few reduced frequencies of the tested range.
    pub fn derivatives(&self, tested: ReducedFrequencyRange) -> Result<Vec<DerivativeInterval>> {
        derivative_intervals(self, &spread_over(tested, DERIVATIVE_POINTS))
    }
}

/// One derivative at one reduced frequency.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DerivativeInterval {
    /// Which one.
    pub derivative: Derivative,
    /// Reduced frequency `K = ωB/V`.
    pub k: f64,
    /// Value of the model.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// All derivatives of the model at the reduced frequencies `ks`.
pub(crate) fn derivative_intervals(
    estimate: &CoefficientUncertainty,
    ks: &[ReducedFrequency],
) -> Result<Vec<DerivativeInterval>> {
    let mut intervals = Vec::new();
    for here in estimate.transfer_slopes(ks)? {
        for (i, &force) in estimate.dofs.iter().enumerate() {
            for (j, &motion) in estimate.dofs.iter().enumerate() {
                for part in [Part::Imaginary, Part::Real] {
                    let at = |g: &TransferMatrix| part_of(g[(i, j)], part) / here.k.powi(2);
                    let gradient: Vec<f64> = here.slopes.iter().map(at).collect();
                    let standard_error = estimate.standard_error(&gradient)?;
                    let nu = estimate.degrees_of_freedom(&gradient);
                    let nu = nu.unwrap_or(f64::INFINITY);
                    let half = two_sided_quantile(CONFIDENCE, nu.min(MANY)) * standard_error;
                    let value = at(&here.value);
                    intervals.push(DerivativeInterval {
                        derivative: Derivative::from_entry(force, motion, part),
                        k: here.k,
                        value,
                        standard_error,
                        low: value - half,
                        high: value + half,
                    });
                }
            }
        }
    }
    Ok(intervals)
}

/// The interval of an onset with what the choice of its form leaves open, of one section or of several: variances add, and degrees
/// of freedom as Satterthwaite adds them, those of the forms being one less than their number. Where not every form has an onset the data do not determine it.
pub fn interval_with_forms(error: &OnsetError, spreads: &[FormSpread]) -> OnsetInterval {
    let (mut form, mut of_forms) = (None, 0.0);
    for spread in spreads {
        let Some(part) = spread.deviation_from_m_s(error.speed_m_s) else {
            continue;
        };
        let square = part.powi(2);
        form = Some(form.unwrap_or(0.0) + square);
        of_forms += square.powi(2) / (spread.forms.len().max(2) as f64 - 1.0);
    }
    let parts = ErrorParts {
        scatter_m_s: error.standard_error_m_s,
        form_m_s: form.map(f64::sqrt),
        between_speeds: error.between_speeds,
    };
    let (scatter, total) = (error.standard_error_m_s.powi(2), parts.standard_error_m_s());
    let squares = scatter.powi(2) / error.degrees_of_freedom + of_forms;
    let freedom = if squares > 0.0 && !spreads.is_empty() {
        total.powi(4) / squares
    } else {
        error.degrees_of_freedom
    };
    let half = two_sided_quantile(CONFIDENCE, freedom) * total;
    let interval = OnsetInterval::about(error.speed_m_s, half, freedom, parts);
    match spreads.iter().find_map(FormSpread::missing) {
        Some(why) => interval.undetermined(why),
        None => interval,
    }
}
