//! The last pass of a fit to records: coefficients, their accounts, and the memory of the filters.

use super::Task;
use crate::aerodynamics::FilterBank;
use crate::error::{Error, Result};
use crate::identification::basis::Basis;
use crate::identification::least_squares::Factor;
use crate::identification::options::Form;
use crate::identification::own::StaticTerm;
use crate::identification::report::{
    EntryReport, MemoryReport, OrderReport, enough_rows, variance,
};
use crate::identification::time::search::{PASSES, padded};
use crate::identification::time::selection::Selection;
use crate::identification::time::slices::Scaled;

/// The last pass: systems with all rows.
pub(super) struct Fitted<'a> {
    task: &'a Task<'a>,
    /// Poles of the filters of every transfer function, row by row.
    chains: Vec<Vec<f64>>,
    pub(super) selection: Selection,
    still_samples: Vec<usize>,
}

impl<'a> Fitted<'a> {
    pub(super) fn new(task: &'a Task<'a>, chains: Vec<Vec<f64>>) -> Result<Self> {
        let n = task.dofs.len();
        let feed = task.fit.form.feed_through().count();
        let longest = chains.iter().map(Vec::len).max().unwrap_or(0);
        let mut of_force: Vec<Vec<Vec<f64>>> = chains
            .chunks(n)
            .map(|row| row.iter().map(|c| padded(c, longest)).collect())
            .collect();
        // filters that serve all forces are filtered once
        if of_force.iter().all(|row| *row == of_force[0]) {
            of_force.truncate(1);
        }
        let pass = task.pass(&of_force, false, (PASSES, PASSES))?;
        let fitted = Self {
            task,
            selection: Selection {
                counts: chains.iter().map(|c| feed + c.len()).collect(),
                systems: pass.systems,
            },
            chains,
            still_samples: pass.still_samples,
        };
        fitted.check()?;
        Ok(fitted)
    }

    /// Every column must be determined: an input that never moves is told by its name.
    fn check(&self) -> Result<()> {
        let dofs = self.task.dofs;
        for i in 0..dofs.len() {
            let factor = self.selection.whole(i);
            enough_rows("records", factor.rows(), factor.columns())?;
            let Some(column) = factor.undetermined(factor.columns()) else {
                continue;
            };
            let holds = |j: &usize| self.selection.places(i, *j).contains(&column);
            let silent = (0..dofs.len()).find(holds);
            return Err(Error::input(
                "records",
                format!(
                    "a {} motion rich enough for {}",
                    silent.map_or("", |j| dofs[j].name()),
                    self.task.fit.form.describe()
                ),
                "none that determines its coefficients",
            ));
        }
        Ok(())
    }

    fn chain(&self, i: usize, j: usize) -> &Vec<f64> {
        &self.chains[i * self.task.dofs.len() + j]
    }

    fn each<T>(&self, f: impl Fn(usize, usize) -> T) -> Vec<Vec<T>> {
        let n = self.task.dofs.len();
        (0..n).map(|i| (0..n).map(|j| f(i, j)).collect()).collect()
    }

    pub(super) fn poles(&self) -> Vec<Vec<Vec<f64>>> {
        self.each(|i, j| self.chain(i, j).clone())
    }

    pub(super) fn coefficients(&self) -> Result<Vec<Vec<Vec<f64>>>> {
        let solve = |i: usize| {
            let factor = self.selection.whole(i);
            let all = factor.solve(factor.columns())?;
            let of = |j| {
                let places = self.selection.places(i, j).into_iter();
                places.map(|p| all[(p, 0)]).collect()
            };
            Ok((0..self.task.dofs.len()).map(of).collect())
        };
        (0..self.task.dofs.len()).map(solve).collect()
    }

    pub(super) fn reports(&self) -> Result<Vec<EntryReport>> {
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
        let basis = Basis::new(&self.task.fit.form, self.chain(i, j))?;
        let whole = self.selection.whole(i);
        let columns = whole.columns();
        let places = self.selection.places(i, j);
        let residual = variance(whole.residual_sum(columns, 0), whole.rows(), columns);
        let covariance = residual
            .map(|v| {
                let gram = whole.inverse_gram(columns)?;
                let n = values.len();
                Ok::<_, Error>(nalgebra::DMatrix::from_fn(n, n, |a, b| {
                    gram[(places[a], places[b])] * v * self.task.noise_ratio()
                }))
            })
            .transpose()?;
        let all = whole.solve(columns)?;
        // with single motions the entry has rows of its own, to which the constant belongs as well
        let own = self.selection.alone(i, j);
        let constant = self.task.fit.static_term == StaticTerm::Estimated;
        let of_rows: Vec<f64> = constant
            .then_some(all[(0, 0)])
            .into_iter()
            .chain(values.iter().copied())
            .collect();
        let relative = |f: &Factor| (f.residual_sum_of(&of_rows, 0) / f.total_sum(0)).sqrt();
        let (condition, cancellation) = match own.as_deref() {
            Some(f) => (f.condition(f.columns()), f.cancellation(&of_rows, 0)),
            None => (
                whole.condition(columns),
                whole.cancellation(all.as_slice(), 0),
            ),
        };
        Ok(EntryReport {
            force: self.task.dofs[i],
            motion: self.task.dofs[j],
            relative_rms: own
                .as_deref()
                .filter(|f| f.total_sum(0) > 0.0)
                .map(relative),
            worst_relative: None,
            poles: self.chain(i, j).clone(),
            coefficients: Vec::new(),
            covariance: Vec::new(),
            condition,
            cancellation,
        }
        .with_coefficients(basis.names(), values, covariance))
    }

    /// Memory of the slowest chain against the rest, or what is discarded, before the motion.
    pub(super) fn memory(&self) -> Result<Vec<MemoryReport>> {
        let account = |(record, still): (&Scaled<'_>, &usize)| {
            let mut memory = 0;
            for chain in &self.chains {
                memory = memory.max(FilterBank::new(chain.clone())?.memory(record.delta_s())?);
            }
            let discarded = (self.task.fit.discard_s / record.step_s).ceil() as usize;
            Ok(MemoryReport {
                record: record.name().to_owned(),
                memory_samples: memory,
                available_samples: discarded.max(*still),
                step_s: record.step_s,
            })
        };
        let each = self.task.records.iter().zip(&self.still_samples);
        each.map(account).collect()
    }

    /// Fewer filters, from the same factorisation (shared poles only).
    pub(super) fn orders(&self) -> Vec<OrderReport> {
        let form = &self.task.fit.form;
        let shared = self.chains.iter().all(|c| *c == self.chains[0]);
        if !shared || matches!(form, Form::Rational { .. }) {
            return Vec::new();
        }
        let feed = form.feed_through().count();
        (1..=self.chains[0].len())
            .map(|filters| OrderReport {
                filters,
                objective: self.selection.systems[0].objective(feed + filters, &|_, _| true),
            })
            .collect()
    }
}
