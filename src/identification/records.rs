//! Continuous models fitted to forced-vibration records.

use super::basis::{Basis, assemble};
use super::degenerate::note_lags;
use super::least_squares::Factor;
use super::options::{Form, TimeFit, TimeWeights};
use super::report::{EntryReport, FitReport, OrderReport, enough_rows, variance};
use super::time::accumulate::{Factored, Layout, Plan, accumulate};
use super::time::filters::{ContinuousColumns, NOISE_BANDWIDTH};
use super::time::search::choose_poles;
use super::time::slices::{Scaled, scale_all};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use crate::wind_tunnel::RecordSource;

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
    let (dofs, scaled) = scale_all(records)?;
    let tested = tested_range(&scaled)?;
    let task = Task {
        fit,
        dofs: &dofs,
        records: &scaled,
        progress,
    };
    let (poles, search) = choose_poles(&task, tested)?;
    let chains: Vec<Vec<f64>> = poles.iter().map(|free| fit.form.expand(free)).collect();
    let fitted = Fitted::new(&task, chains)?;
    let model = assemble(&fit.form, &dofs, &fitted.poles(), &fitted.coefficients()?)?;
    let factored = &fitted.systems[0];
    let mut report = FitReport {
        method: format!(
            "{}, fitted to {} record(s) in the time domain",
            fit.form.describe(),
            records.len()
        ),
        weights: describe(fit.weights).into(),
        samples: factored.whole[0].rows(),
        tested_range: tested,
        condition: 1.0,
        entries: fitted.reports()?,
        search,
        orders: fitted.orders(),
        alpha_guideline: None,
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
    pub progress: OnProgress<'a>,
}

impl Task<'_> {
    /// Cut-off of the low-pass, Hz.
    pub fn cutoff_hz(&self, record: &Scaled<'_>) -> f64 {
        self.fit
            .low_pass_hz
            .unwrap_or(CUTOFF_OVER_SAMPLING / record.step_s)
    }

    /// One pass with the given chains; `thinned` takes only as many rows as the low-passed signals need.
    pub fn pass(
        &self,
        chains: &[Vec<f64>],
        thinned: bool,
        (pass, passes): (usize, usize),
    ) -> Result<Vec<Factored>> {
        let bases = chains
            .iter()
            .map(|poles| {
                if thinned {
                    Basis::orthonormal(&self.fit.form, poles)
                } else {
                    Basis::new(&self.fit.form, poles)
                }
            })
            .collect::<Result<Vec<_>>>()?;
        let per_input = bases.first().map_or(0, Basis::len);
        let plan = Plan {
            layout: Layout {
                inputs: self.dofs.len(),
                per_input,
                constant: false,
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
            &|record| {
                ContinuousColumns::new(record, self.dofs.len(), &bases, self.cutoff_hz(record))
            },
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

/// The last pass: systems with all rows, one a chain of poles.
struct Fitted<'a> {
    task: &'a Task<'a>,
    /// Chains in use: one, or one a transfer function, row by row.
    chains: Vec<Vec<f64>>,
    systems: Vec<Factored>,
}

impl<'a> Fitted<'a> {
    fn new(task: &'a Task<'a>, chains: Vec<Vec<f64>>) -> Result<Self> {
        let systems = task.pass(
            &chains,
            false,
            (super::time::search::PASSES, super::time::search::PASSES),
        )?;
        let fitted = Self {
            task,
            chains,
            systems,
        };
        fitted.check()?;
        Ok(fitted)
    }

    /// Every column must be determined: an input that never moves is told by its name.
    fn check(&self) -> Result<()> {
        for system in &self.systems {
            let factor = &system.whole[0];
            enough_rows("records", factor.rows(), factor.columns())?;
            if let Some(column) = factor.undetermined(factor.columns()) {
                let dof = self.task.dofs[column % self.task.dofs.len()];
                return Err(Error::input(
                    "records",
                    format!(
                        "a {} motion rich enough for {}",
                        dof.name(),
                        self.task.fit.form.describe()
                    ),
                    "none that determines its coefficients",
                ));
            }
        }
        Ok(())
    }

    fn of_entry(&self, i: usize, j: usize) -> usize {
        if self.chains.len() == 1 {
            0
        } else {
            i * self.task.dofs.len() + j
        }
    }

    fn each<T>(&self, f: impl Fn(usize, usize) -> T) -> Vec<Vec<T>> {
        let n = self.task.dofs.len();
        (0..n).map(|i| (0..n).map(|j| f(i, j)).collect()).collect()
    }

    fn poles(&self) -> Vec<Vec<Vec<f64>>> {
        self.each(|i, j| self.chains[self.of_entry(i, j)].clone())
    }

    fn coefficients(&self) -> Result<Vec<Vec<Vec<f64>>>> {
        self.each(|i, j| {
            let system = &self.systems[self.of_entry(i, j)];
            let factor = &system.whole[i];
            let all = factor.solve(factor.columns())?;
            Ok((0..system.layout.per_input)
                .map(|c| all[(system.layout.index(c, j), 0)])
                .collect())
        })
        .into_iter()
        .map(|row| row.into_iter().collect())
        .collect()
    }

    fn reports(&self) -> Result<Vec<EntryReport>> {
        let coefficients = self.coefficients()?;
        let mut reports = Vec::new();
        for (i, row) in coefficients.iter().enumerate() {
            for (j, values) in row.iter().enumerate() {
                reports.push(self.report(i, j, values)?);
            }
        }
        Ok(reports)
    }

    fn report(&self, i: usize, j: usize, values: &[f64]) -> Result<EntryReport> {
        let which = self.of_entry(i, j);
        let system = &self.systems[which];
        let basis = Basis::new(&self.task.fit.form, &self.chains[which])?;
        // with single motions the entry has rows of its own
        let own = system.alone(i, j).filter(|_| system.single_motions());
        let whole = &system.whole[i];
        let columns = whole.columns();
        let residual = variance(whole.residual_sum(columns, 0), whole.rows(), columns);
        let covariance = residual
            .map(|v| {
                let gram = whole.inverse_gram(columns)?;
                let n = values.len();
                Ok::<_, Error>(nalgebra::DMatrix::from_fn(n, n, |a, b| {
                    let at = (system.layout.index(a, j), system.layout.index(b, j));
                    gram[at] * v * self.task.noise_ratio()
                }))
            })
            .transpose()?;
        let relative = |f: &Factor| (f.residual_sum_of(values, 0) / f.total_sum(0)).sqrt();
        let (condition, cancellation) = match own {
            Some(f) => (f.condition(f.columns()), f.cancellation(values, 0)),
            None => {
                let all = whole.solve(columns)?;
                (
                    whole.condition(columns),
                    whole.cancellation(all.as_slice(), 0),
                )
            }
        };
        Ok(EntryReport {
            force: self.task.dofs[i],
            motion: self.task.dofs[j],
            relative_rms: own.filter(|f| f.total_sum(0) > 0.0).map(relative),
            worst_relative: None,
            poles: self.chains[which].clone(),
            coefficients: Vec::new(),
            covariance: Vec::new(),
            condition,
            cancellation,
        }
        .with_coefficients(basis.names(), values, covariance))
    }

    /// Fewer filters, from the same factorisation (shared poles only).
    fn orders(&self) -> Vec<OrderReport> {
        let form = &self.task.fit.form;
        if self.chains.len() > 1 || matches!(form, Form::Rational { .. }) {
            return Vec::new();
        }
        let feed = form.feed_through().count();
        (1..=form.filters())
            .map(|filters| OrderReport {
                filters,
                objective: self.systems[0].objective(feed + filters),
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
