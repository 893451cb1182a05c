//! Continuous models fitted to forced-vibration records.

mod fitted;
mod joint;

use super::basis::Basis;
use super::degenerate::note_lags;
use super::dissipative::{ConstraintReport, Wishes};
use super::frequency_options::limits_by_entry;
use super::options::{TimeFit, TimeWeights};
use super::own::{EntryForm, StaticTerm, entry_forms};
use super::report::{FitReport, SearchReport, StaticReport, variance};
use super::time::accumulate::{Accumulated, Plan, accumulate};
use super::time::filters::{ContinuousColumns, NOISE_BANDWIDTH};
use super::time::layout::Layout;
use super::time::search::{Choice, choose_poles};
use super::time::selection::Selection;
use super::time::slices::{Scaled, scale_all};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use crate::wind_tunnel::RecordSource;
use fitted::Fitted;
pub(crate) use joint::Joint;

/// Default cut-off of the low-pass over the sampling frequency.
const CUTOFF_OVER_SAMPLING: f64 = 1.0 / 20.0;

/// How far a fit to records has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Pass over the records, from 1.
    pub pass: usize,
    /// Number of passes.
    pub passes: usize,
    /// Records done in this pass.
    pub records_done: usize,
    /// Number of records.
    pub records: usize,
}

/// Called after every record of every pass, from any thread.
pub type OnProgress<'a> = &'a (dyn Fn(Progress) + Sync);

/// Fits a continuous model to records of any speeds and sampling frequencies, in bounded memory.
///
/// The poles follow from a few passes over the records, each of which evaluates a whole grid of candidates; the last
/// pass fits the chosen ones to every sample.
///
/// # Errors
/// [`Error::Input`] for impossible options, records that do not fit together, are too short, contain numbers that are
/// not finite or do not move a degree of freedom; for poles per transfer function, records that move two at once.
pub fn fit_records(
    records: &[&dyn RecordSource],
    fit: &TimeFit,
    progress: OnProgress<'_>,
) -> Result<(Model, FitReport)> {
    fit.validate()?;
    let (dofs, mut scaled) = scale_all(records)?;
    let means = removed_means(fit.static_term, &dofs, &mut scaled)?;
    let tested = tested_range(&scaled)?;
    let entries = entry_forms(&dofs, &fit.form, &fit.poles, &fit.own)?;
    let task = Task {
        fit,
        dofs: &dofs,
        records: &scaled,
        entries: &entries,
        progress,
    };
    let wishes = wishes(fit, &dofs, tested)?;
    let (alone, held) = choose_poles(&task, tested, &wishes)?;
    let Found {
        fitted,
        search,
        constraints,
    } = task.fit_at(alone, held, &wishes)?;
    let model = fitted.model()?;
    let mut report = FitReport {
        method: format!(
            "{}{}, fitted to {} record(s) in the time domain",
            fit.form.describe(),
            describe_own(fit.own.len()),
            records.len()
        ),
        weights: describe(fit.weights).into(),
        samples: fitted.selection.whole(0).rows(),
        tested_range: tested,
        condition: 1.0,
        entries: fitted.reports()?,
        search,
        orders: fitted.orders(),
        alpha_guideline: None,
        static_terms: if fit.static_term == StaticTerm::Estimated {
            let mut constants = estimated_constants(&fitted.selection, &dofs, task.noise_ratio())?;
            for (i, report) in constants.iter_mut().enumerate() {
                report.value = fitted.constant(i).unwrap_or(report.value);
            }
            constants
        } else {
            means
        },
        memory: fitted.memory()?,
        constraints,
        covariance_assumption:
            "noise of the forces is white before the low-pass, motions are exact, the poles count \
                                as known"
                .into(),
        notes: Vec::new(),
    };
    report.condition = report
        .entries
        .iter()
        .map(|e| e.condition)
        .fold(1.0, f64::max);
    report.judge(&fit.poles);
    note_lags(&model, &mut report.notes);
    Ok((model, report))
}

/// Removes the means where that is asked for, and reports them.
///
/// # Errors
/// Those of reading.
pub(crate) fn removed_means(
    wanted: StaticTerm,
    dofs: &[Dof],
    records: &mut [Scaled<'_>],
) -> Result<Vec<StaticReport>> {
    let mut reports = Vec::new();
    if wanted == StaticTerm::Removed {
        for record in records {
            for (value, &force) in record.remove_means()?.into_iter().zip(dofs) {
                reports.push(StaticReport {
                    force,
                    record: Some(record.name().to_owned()),
                    value,
                    standard_error: None,
                });
            }
        }
    }
    Ok(reports)
}

/// The constants in front of the other columns; `noise_ratio` takes the variance of the residuals to that of white noise.
///
/// # Errors
/// Systems without a solution.
pub(crate) fn estimated_constants(
    selection: &Selection,
    dofs: &[Dof],
    noise_ratio: f64,
) -> Result<Vec<StaticReport>> {
    let constant = |(i, &force): (usize, &Dof)| {
        let whole = selection.whole(i);
        let columns = whole.columns();
        let residual = variance(whole.residual_sum(columns, 0), whole.rows(), columns);
        let error = |v: f64| {
            let gram = whole.inverse_gram(columns)?;
            Ok::<_, Error>((v * noise_ratio * gram[(0, 0)]).sqrt())
        };
        Ok(StaticReport {
            force,
            record: None,
            value: whole.solve(columns)?[(0, 0)],
            standard_error: residual.map(error).transpose()?,
        })
    };
    dofs.iter().enumerate().map(constant).collect()
}

pub(crate) fn describe_own(count: usize) -> String {
    match count {
        0 => String::new(),
        n => format!(", filters of their own for {n} transfer function(s)"),
    }
}

/// Range of all records together.
///
/// # Errors
/// Those of reading, and records that never move.
pub(crate) fn tested_range(records: &[Scaled<'_>]) -> Result<ReducedFrequencyRange> {
    let mut ends = Vec::new();
    for record in records {
        if let Some(range) = record.tested_range()? {
            ends.extend([range.min, range.max]);
        }
    }
    ReducedFrequencyRange::spanning(ends)
        .ok_or_else(|| Error::input("records", "a motion", "none that moves"))
}

pub(crate) fn describe(weights: TimeWeights) -> &'static str {
    match weights {
        TimeWeights::None => "none: residuals of the dimensionless forces",
        TimeWeights::PerRecord => "1/RMS of each force in each record",
        TimeWeights::PerSegment => "1/RMS of each force in each segment",
    }
}

/// What stays the same over all passes.
pub(crate) struct Task<'a> {
    pub fit: &'a TimeFit,
    pub dofs: &'a [Dof],
    pub records: &'a [Scaled<'a>],
    /// Form and poles of every transfer function, row by row.
    pub entries: &'a [EntryForm],
    pub progress: OnProgress<'a>,
}

/// What a fit is asked for besides least squares.
///
/// # Errors
/// [`Error::Input`] for limits of degrees of freedom that are not there.
pub(crate) fn wishes(fit: &TimeFit, dofs: &[Dof], tested: ReducedFrequencyRange) -> Result<Wishes> {
    Ok(Wishes {
        k_max: tested.max.full_width(),
        constraints: fit.constraints,
        limits: limits_by_entry(dofs, &fit.limits)?,
    })
}

/// The fit that is handed out.
struct Found<'a> {
    fitted: Fitted<'a>,
    search: Vec<SearchReport>,
    constraints: Option<ConstraintReport>,
}

impl<'a> Task<'a> {
    /// The last pass: least squares alone, and under the constraints where these are asked for and bind.
    fn fit_at(&'a self, alone: Choice, held: Option<Choice>, wishes: &Wishes) -> Result<Found<'a>> {
        let chains = |choice: &Choice| -> Vec<Vec<f64>> {
            let pairs = choice.poles.iter().zip(self.entries);
            pairs.map(|(p, e)| e.form.expand(p)).collect()
        };
        let mut sets = vec![chains(&alone)];
        if let Some(held) = &held {
            sets.push(chains(held));
        }
        sets.dedup();
        let mut fits = Fitted::at_poles(self, sets)?.into_iter();
        let none = || Error::Numerical("fit to records: no fit".into());
        let mut fitted = fits.next().ok_or_else(none)?;
        let (reports, model) = (fitted.reports()?, fitted.model()?);
        let bases = fitted.bases()?;
        if held.is_some() {
            fitted.constrain(wishes)?;
        }
        let Some(held) = held.filter(|_| fitted.active().is_some()) else {
            return Ok(Found {
                fitted,
                search: alone.search,
                constraints: None,
            });
        };
        if let Some(other) = fits.next() {
            fitted = other;
            fitted.constrain(wishes)?;
        }
        let active = fitted.active().unwrap_or_default();
        let with = fitted.reports()?;
        let compared = (reports.as_slice(), bases.as_slice());
        let constraints = ConstraintReport::new(active, self.dofs, compared, &with, model);
        Ok(Found {
            fitted,
            search: held.search,
            constraints: Some(constraints),
        })
    }
}

impl Task<'_> {
    /// Cut-off of the low-pass, Hz.
    pub fn cutoff_hz(&self, record: &Scaled<'_>) -> f64 {
        self.fit
            .low_pass_hz
            .unwrap_or(CUTOFF_OVER_SAMPLING / record.step_s)
    }

    /// Largest number of filters of a transfer function.
    pub fn most_filters(&self) -> usize {
        let all = self.entries.iter().map(|e| e.form.filters());
        all.max().unwrap_or(0)
    }

    /// One pass with the given candidates, a chain of filters for each input, all of one length; `thinned` takes only as
    /// many rows as the low-passed signals need.
    pub fn pass(
        &self,
        candidates: &[Vec<Vec<f64>>],
        thinned: bool,
        (pass, passes): (usize, usize),
    ) -> Result<Accumulated> {
        let basis = |poles: &Vec<f64>| {
            if thinned {
                Basis::orthonormal(&self.fit.form, poles)
            } else {
                Basis::new(&self.fit.form, poles)
            }
        };
        let bases = candidates
            .iter()
            .map(|chains| chains.iter().map(basis).collect())
            .collect::<Result<Vec<Vec<_>>>>()?;
        let constant = self.fit.static_term == StaticTerm::Estimated;
        let plan = Plan {
            layout: Layout {
                inputs: self.dofs.len(),
                per_input: bases.first().map_or(0, |b| b[0].len()),
                constant,
            },
            weights: self.fit.weights,
            delta_s: None,
            discard_s: self.fit.discard_s,
            stride: if thinned { self.thinning() } else { 1 },
            stretches: 0,
        };
        accumulate(
            self.records,
            &plan,
            &|record| ContinuousColumns::new(record, &bases, self.cutoff_hz(record), constant),
            &|records_done| {
                (self.progress)(Progress {
                    pass,
                    passes,
                    records_done,
                    records: self.records.len(),
                });
            },
        )
    }

    /// Every how many samples a row is enough: four rows a period of the cut-off still hold what the low-pass lets
    /// through.
    pub fn thinning(&self) -> usize {
        let stride = |r: &Scaled<'_>| (0.25 / (self.cutoff_hz(r) * r.step_s)) as usize;
        self.records.iter().map(stride).min().unwrap_or(1).max(1)
    }

    /// Variance of the noise before the low-pass over that of the residuals behind it.
    fn noise_ratio(&self) -> f64 {
        let passed = self
            .records
            .iter()
            .map(|r| 2.0 * NOISE_BANDWIDTH * self.cutoff_hz(r) * r.step_s);
        1.0 / passed.fold(0.0, f64::max).min(1.0)
    }
}

#[cfg(test)]
mod tests;
