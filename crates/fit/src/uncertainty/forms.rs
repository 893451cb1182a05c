//! What the form of a model does not know: the onsets of other forms that explain the same table as well.
//!
//! The scatter of the data under one form says nothing of what another form would have made of them between the tests and beyond. A table
//! is therefore fitted by a set of dissipative forms, banks of 2 to 8 fixed poles spread logarithmically from half the lowest to six times
//! the highest tested `K` (and 4 over a narrower range), rational functions with one and two lags, and read by several ways of
//! interpolation. Those whose variance of residuals per degree of freedom is within 1.25 of the best are admissible, and the spread of
//! their onsets belongs into the interval. Where tests surround the onset they agree to a per cent; where all tests lie beside it they do
//! not, and nothing else would say so.

use crate::aerodynamics::derivatives::{
    Derivative, DerivativePoint, DerivativeTable, Extrapolation, InterpolatedTable, Interpolation,
    TableHeader, TransferSample,
};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, counted};
use crate::flutter::{FlutterSearch, OnsetSearch, determinant_onset, find_onset};
use crate::identification::derivatives::{DerivativeOptions, identify_derivatives};
use crate::identification::{
    Constraints, EntryReport, FitReport, Fitted, Form, FrequencyFit, FrequencyWeights, PoleSearch,
    fit_table,
};
use crate::section::{Dof, Structure};
use crate::signal::mean_and_deviation;
use crate::trained_model::Model;
use crate::units::{ReducedFrequencyRange, in_equal_ratios};
use crate::wind_tunnel::RecordSource;
use aerodeck_core::threads;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Numbers of poles of the banks over the wide range.
const BANKS: std::ops::RangeInclusive<usize> = 2..=8;
/// Ends of a wide bank over the lowest and the highest tested `K`.
const WIDE: [f64; 2] = [0.5, 6.0];
/// Number of poles of the narrow bank, and its ends.
const NARROW: (usize, [f64; 2]) = (4, [1.0, 3.0]);
/// Numbers of lags of the rational functions, whose poles are searched.
const LAGS: [usize; 2] = [1, 2];
/// Ways of reading the table without a fit.
const INTERPOLATIONS: [Interpolation; 3] = [
    Interpolation::ModifiedAkima,
    Interpolation::PchipVHat,
    Interpolation::LinearVHat,
];
/// Variance of the residuals per degree of freedom over that of the best form, at most.
const ADMISSIBLE: f64 = 1.25;
/// Residuals below this part of the data (root mean square) are no better than each other: no table is known so well.
const AS_GOOD: f64 = 0.005;

/// The onset by one admissible form.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FormOnset {
    /// The form.
    pub form: String,
    /// Variance of its residuals per degree of freedom over that of the best form; none where the table is interpolated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub residual_ratio: Option<f64>,
    /// Its onset, or the speed at or below which it grows already, m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub onset_m_s: Option<f64>,
    /// Highest speed up to which it was judged and has no onset, m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stable_up_to_m_s: Option<f64>,
}

/// Onsets of all admissible forms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FormSpread {
    /// The admissible forms.
    pub forms: Vec<FormOnset>,
    /// Half the difference between the highest and the lowest onset, m/s; none without onsets.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half_range_m_s: Option<f64>,
    /// Standard deviation of the onsets about their mean, m/s; none with fewer than two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub standard_deviation_m_s: Option<f64>,
    /// Whether every form has one; an interpolated table that ends below the others' onsets is not counted.
    pub all_have_onset: bool,
}

/// The forms that explain one table as well as the best of them, for any section.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FormEnsemble {
    /// Fits, each with its model.
    pub fits: Vec<AdmissibleForm>,
    /// Reduced frequencies of the tests.
    pub tested: ReducedFrequencyRange,
    /// Ways to read the table without a fit; a file of an older version has none.
    #[serde(default)]
    read: Vec<InterpolatedTable>,
}

/// One form with its model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AdmissibleForm {
    /// The form, in words.
    pub form: String,
    /// Variance of its residuals per degree of freedom over that of the best form.
    pub residual_ratio: f64,
    /// The model.
    pub model: Model,
}

impl FormEnsemble {
    /// Fits all forms to samples of a transfer matrix and keeps the admissible ones; `known` are fits to these samples that need
    /// not be done again.
    ///
    /// # Errors
    /// [`Error::Input`] for samples without the forces of heave and rotation; [`Error::Numerical`] when no form can be fitted.
    pub fn new(
        samples: &[TransferSample],
        dofs: &[Dof],
        known: &(dyn Fn(&FrequencyFit) -> Option<Fitted> + Sync),
    ) -> Result<Self> {
        let tested = ReducedFrequencyRange::spanning(samples.iter().map(|s| s.k))
            .ok_or_else(|| Error::input("samples", "at least one", "none"))?;
        let table = table_of(samples, dofs)?;
        // where it was tested is said with every search; a bridge asks at the ends in other widths, off by a rounding
        let by = |by| InterpolatedTable::by(by, &table, dofs, Extrapolation::Hold);
        let read = INTERPOLATIONS.into_iter().map(by).collect::<Result<_>>()?;
        let numbers = samples.len() as f64;
        let fitted = threads::each(&fitted_forms(tested), true, |(form, fit)| {
            let fitted = known(fit).or_else(|| fit_table(samples, dofs, fit).ok())?;
            let variances = variances(fit, &fitted.report, numbers)?;
            let fitted = AdmissibleForm {
                form: form.clone(),
                residual_ratio: 1.0,
                model: fitted.model,
            };
            Some((fitted, variances))
        });
        let fitted: Vec<_> = fitted.into_iter().flatten().collect();
        Ok(Self {
            fits: admissible(fitted)?,
            tested,
            read,
        })
    }

    /// Those for the derivatives that records show.
    ///
    /// # Errors
    /// As [`Self::new`], and those of [`identify_derivatives`].
    pub fn of_records(records: &[&dyn RecordSource], dofs: &[Dof]) -> Result<Self> {
        let found = identify_derivatives(records, &DerivativeOptions::default())?;
        let table = found.table("records", TableHeader::default())?;
        Self::new(&table.samples(dofs), dofs, &|_| None)
    }

    /// The ensemble; one that cannot be made is noted, and an interval holds the scatter alone.
    ///
    /// # Errors
    /// [`Error::Numerical`], as of fewer tests than coefficients, of which the scatter shows nothing either.
    pub fn or_noted(found: Result<Option<Self>>, report: &mut FitReport) -> Result<Option<Self>> {
        match found {
            Err(error) if !matches!(error, Error::Numerical(_)) => {
                let what = "what the form of the model leaves open is not in its interval";
                report.notes.push(format!("{what}: {error}"));
                Ok(None)
            }
            other => other,
        }
    }

    /// Checks what was read from a file.
    ///
    /// # Errors
    /// [`Error::Input`] for a model or table that is none.
    pub(super) fn validate(&self) -> Result<()> {
        self.fits.iter().try_for_each(|f| f.model.validate())?;
        self.read.iter().try_for_each(InterpolatedTable::validate)
    }

    /// Onsets of a section by every form.
    ///
    /// # Errors
    /// [`Error::Input`] for a search range that is none and other motions; [`Error::Numerical`] without eigenvalues.
    pub fn spread(&self, structure: &Structure, search: &OnsetSearch) -> Result<FormSpread> {
        let of_fit = |f: &AdmissibleForm| {
            let section = CoupledSection::with_model(structure, &f.model)?;
            let found = find_onset(&f.form, &section, search, Some(self.tested))?;
            Ok(FormOnset::new(&f.form, Some(f.residual_ratio), &found))
        };
        self.spread_by(of_fit, |by, table| {
            let (range, highest) = (table.tested_range(), search.speed_max_m_s);
            let found = determinant_onset(by, structure, table, range, highest)?;
            Ok(FormOnset::new(by, None, &found))
        })
    }

    /// Onsets of whatever these forces are part of, by every fit and by the table as it is read.
    ///
    /// # Errors
    /// Those of the search by a fit.
    pub fn spread_by(
        &self,
        of_fit: impl Fn(&AdmissibleForm) -> Result<FormOnset> + Sync + Send,
        of_table: impl Fn(&str, &InterpolatedTable) -> Result<FormOnset> + Sync,
    ) -> Result<FormSpread> {
        let forms = threads::each(&self.fits, true, of_fit).into_iter();
        let mut forms = forms.collect::<Result<Vec<_>>>()?;
        let read: Vec<_> = INTERPOLATIONS.iter().zip(&self.read).collect();
        let read = threads::each(&read, true, |(by, table)| of_table(by.title(), table));
        // a table whose roots cannot be told apart says nothing
        forms.extend(told(read.into_iter().flatten().collect(), &forms));
        Ok(FormSpread::new(forms))
    }
}

/// Interpolated tables that say something of the onset: those that have one, and those that are stable where others flutter.
fn told(read: Vec<FormOnset>, fits: &[FormOnset]) -> Vec<FormOnset> {
    let lowest = lowest(fits).unwrap_or(f64::INFINITY);
    let contradicts = |f: &FormOnset| f.stable_up_to_m_s.is_some_and(|to| to > lowest);
    let says = |f: &FormOnset| f.onset_m_s.is_some() || contradicts(f);
    read.into_iter().filter(says).collect()
}

fn lowest(forms: &[FormOnset]) -> Option<f64> {
    forms.iter().filter_map(|f| f.onset_m_s).reduce(f64::min)
}

impl FormSpread {
    fn new(forms: Vec<FormOnset>) -> Self {
        let onsets: Vec<f64> = forms.iter().filter_map(|f| f.onset_m_s).collect();
        let low = lowest(&forms);
        let high = onsets.iter().copied().reduce(f64::max);
        Self {
            half_range_m_s: low.zip(high).map(|(low, high)| 0.5 * (high - low)),
            standard_deviation_m_s: (onsets.len() > 1)
                .then(|| mean_and_deviation(onsets.iter().copied()).1),
            all_have_onset: !forms.is_empty() && onsets.len() == forms.len(),
            forms,
        }
    }

    /// The lowest onset of all admissible forms, m/s.
    pub fn lowest_onset_m_s(&self) -> Option<f64> {
        lowest(&self.forms)
    }

    /// Why not every form has an onset, if so.
    pub fn missing(&self) -> Option<String> {
        if self.all_have_onset {
            return None;
        }
        let without = self.forms.iter().filter(|f| f.onset_m_s.is_none());
        let names: Vec<&str> = without.map(|f| f.form.as_str()).collect();
        Some(format!(
            "{} of {} forms that explain the data as well have no onset ({})",
            names.len(),
            self.forms.len(),
            names.join(", ")
        ))
    }

    /// Root mean square distance of the onsets from one of them, m/s: what the choice of that form leaves open.
    pub fn deviation_from_m_s(&self, onset_m_s: f64) -> Option<f64> {
        let square = |f: &FormOnset| Some((f.onset_m_s? - onset_m_s).powi(2));
        let squares: Vec<f64> = self.forms.iter().filter_map(square).collect();
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        (!squares.is_empty()).then(|| mean.sqrt())
    }
}

/// All forms that are fitted.
fn fitted_forms(tested: ReducedFrequencyRange) -> Vec<(String, FrequencyFit)> {
    let ends = [tested.min.full_width(), tested.max.full_width()];
    let bank = |count: usize, reach: [f64; 2]| {
        let (low, high) = (reach[0] * ends[0], reach[1] * ends[1]);
        let poles: Vec<f64> = in_equal_ratios(low, high, count).collect();
        let form = Form::takenaka_malmquist(count);
        let name = format!("{count} poles from K {low:.3} to {high:.2}");
        (name, form, PoleSearch::fixed(&poles))
    };
    let lags = |lags: usize| {
        let form = Form::Rational {
            lags,
            added_mass: true,
        };
        (counted(lags, "lag"), form, PoleSearch::default())
    };
    let banks = BANKS.map(|count| bank(count, WIDE));
    let banks = banks.chain([bank(NARROW.0, NARROW.1)]);
    let fit = |(name, form, poles)| {
        let fit = FrequencyFit {
            form,
            poles,
            weights: FrequencyWeights::Relative,
            constraints: Constraints::Dissipative,
            ..FrequencyFit::default()
        };
        (name, fit)
    };
    banks.chain(LAGS.map(lags)).map(fit).collect()
}

/// Variance of the residuals of each transfer function of a fit to so many numbers per degree of freedom, over its mean square; none
/// without degrees of freedom.
fn variances(fit: &FrequencyFit, report: &FitReport, numbers: f64) -> Option<Vec<f64>> {
    let searched = match fit.poles.fixed {
        Some(_) => 0.0,
        None => fit.form.filters() as f64,
    };
    let count = report.entries.len() as f64;
    let numbers = numbers / count;
    let of = |entry: &EntryReport| {
        let free = numbers - entry.coefficients.len() as f64 - searched / count;
        let variance = entry.relative_rms.unwrap_or(0.0).powi(2) * numbers / free;
        (free > 0.0).then_some(variance)
    };
    report.entries.iter().map(of).collect()
}

impl FormOnset {
    /// What a search found with one form.
    pub fn new(form: &str, residual_ratio: Option<f64>, found: &FlutterSearch) -> Self {
        Self {
            form: form.to_owned(),
            residual_ratio,
            onset_m_s: found.critical_speed_m_s(),
            stable_up_to_m_s: match found {
                FlutterSearch::StableUpTo(range) => Some(range.to_m_s),
                FlutterSearch::Onset(_) | FlutterSearch::UnstableAtOrBelow(_) => None,
            },
        }
    }
}

/// Forms that explain the samples as well as the best of them, of all with the variances of their residuals.
fn admissible(all: Vec<(AdmissibleForm, Vec<f64>)>) -> Result<Vec<AdmissibleForm>> {
    let sum = |variances: &Vec<f64>| -> f64 { variances.iter().sum() };
    let each = all.iter().map(|(_, variances)| variances.clone());
    let best = each.min_by(|a, b| sum(a).total_cmp(&sum(b)));
    let none = || Error::Numerical("no form can be fitted to these samples".into());
    let best = best.ok_or_else(none)?;
    let floor = AS_GOOD.powi(2);
    // the mean over the transfer functions
    let ratio = |own: &[f64]| {
        let both = own.iter().zip(&best);
        let ratios = both.map(|(own, best)| (own + floor) / (best + floor));
        ratios.sum::<f64>() / own.len() as f64
    };
    let rated = all.into_iter().map(|(form, own)| AdmissibleForm {
        residual_ratio: ratio(&own),
        ..form
    });
    Ok(rated.filter(|f| f.residual_ratio <= ADMISSIBLE).collect())
}

/// The table that these are the samples of.
fn table_of(samples: &[TransferSample], dofs: &[Dof]) -> Result<DerivativeTable> {
    let mut points = BTreeMap::<Derivative, Vec<DerivativePoint>>::new();
    for sample in samples {
        if !(dofs.contains(&sample.force) && dofs.contains(&sample.motion)) {
            continue;
        }
        let derivative = Derivative::from_entry(sample.force, sample.motion, sample.part);
        let v_hat = sample.k.v_hat();
        points.entry(derivative).or_default().push(DerivativePoint {
            mean_speed_m_s: sample.mean_speed_m_s,
            v_hat,
            value: sample.value * v_hat * v_hat,
        });
    }
    // dimensionless throughout: any width does
    DerivativeTable::new("samples", 1.0, TableHeader::default(), points)
}
