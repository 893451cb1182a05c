//! The last pass of a fit to records: coefficients, their accounts, and the memory of the filters.

use super::{Joint, Task};
use crate::aerodynamics::FilterBank;
use crate::error::{Error, Result};
use crate::identification::basis::{Basis, assemble};
use crate::identification::dissipative::{ActiveConstraint, Wishes};
use crate::identification::least_squares::Factor;
use crate::identification::options::Form;
use crate::identification::own::StaticTerm;
use crate::identification::report::{
    EntryReport, MemoryReport, OrderReport, enough_rows, variance,
};
use crate::identification::time::search::{PASSES, padded};
use crate::identification::time::selection::Selection;
use crate::identification::time::slices::Scaled;
use crate::trained_model::Model;
use nalgebra::DMatrix;
use std::rc::Rc;

/// The last pass: systems with all rows.
pub(super) struct Fitted<'a> {
    task: &'a Task<'a>,
    /// Poles of the filters of every transfer function, row by row.
    chains: Vec<Vec<f64>>,
    pub(super) selection: Selection,
    still_samples: Vec<usize>,
    joint: Option<Joint>,
}

impl<'a> Fitted<'a> {
    /// One fit for each set of chains, from one pass.
    pub(super) fn at_poles(task: &'a Task<'a>, sets: Vec<Vec<Vec<f64>>>) -> Result<Vec<Self>> {
        let n = task.dofs.len();
        let feed = task.fit.form.feed_through().count();
        let longest = sets.iter().flatten().map(Vec::len).max().unwrap_or(0);
        let mut candidates = Vec::new();
        let mut counts = Vec::new();
        for chains in &sets {
            let mut of_force: Vec<Vec<Vec<f64>>> = chains
                .chunks(n)
                .map(|row| row.iter().map(|c| padded(c, longest)).collect())
                .collect();
            // filters that serve all forces are filtered once
            if of_force.iter().all(|row| *row == of_force[0]) {
                of_force.truncate(1);
            }
            counts.push(of_force.len());
            candidates.extend(of_force);
        }
        let pass = task.pass(&candidates, false, (PASSES, PASSES))?;
        let mut systems = pass.systems.into_iter().map(Rc::new);
        let mut all = Vec::new();
        for (chains, count) in sets.into_iter().zip(counts) {
            let fitted = Self {
                task,
                selection: Selection {
                    counts: chains.iter().map(|c| feed + c.len()).collect(),
                    systems: systems.by_ref().take(count).collect(),
                },
                chains,
                still_samples: pass.still_samples.clone(),
                joint: None,
            };
            fitted.check()?;
            all.push(fitted);
        }
        Ok(all)
    }

    /// Puts the fit under the constraints; one that satisfies them stays as it is, to the last bit.
    ///
    /// # Errors
    /// Constraints that no coefficients satisfy.
    pub(super) fn constrain(&mut self, wishes: &Wishes) -> Result<()> {
        let joint = Joint::new(&self.selection, &self.bases()?, wishes)?;
        self.joint = joint.held.is_some().then_some(joint);
        Ok(())
    }

    /// What holds the constrained fit; `None` where nothing does.
    pub(super) fn active(&self) -> Option<Vec<ActiveConstraint>> {
        Some(self.joint.as_ref()?.held.as_ref()?.active.clone())
    }

    pub(super) fn bases(&self) -> Result<Vec<Basis>> {
        let form = &self.task.fit.form;
        self.chains.iter().map(|c| Basis::new(form, c)).collect()
    }

    /// The estimated constant of force `i`.
    pub(super) fn constant(&self, i: usize) -> Option<f64> {
        Some(self.joint.as_ref()?.constant(i))
    }

    /// Coefficients of all columns of force `i`.
    fn all(&self, i: usize) -> Result<Vec<f64>> {
        let whole = self.selection.whole(i);
        let mut all = whole.solve(whole.columns())?.as_slice().to_vec();
        if let Some(joint) = &self.joint {
            let n = self.task.dofs.len();
            if self.selection.of_force(i).layout.constant {
                all[0] = joint.constant(i);
            }
            for j in 0..n {
                let values = joint.values(i * n + j);
                for (p, value) in self.selection.places(i, j).into_iter().zip(values) {
                    all[p] = *value;
                }
            }
        }
        Ok(all)
    }

    /// Sum of squares of the weighted residuals of force `i`.
    fn residual_sum(&self, i: usize) -> Result<f64> {
        let whole = self.selection.whole(i);
        Ok(match self.joint {
            Some(_) => whole.residual_sum_of(&self.all(i)?, 0),
            None => whole.residual_sum(whole.columns(), 0),
        })
    }

    /// Variance of the noise of force `i`; none without residual degrees of freedom.
    fn variance(&self, i: usize) -> Result<Option<f64>> {
        let whole = self.selection.whole(i);
        let found = variance(self.residual_sum(i)?, whole.rows(), whole.columns());
        Ok(found.map(|v| v * self.task.noise_ratio()))
    }

    /// Covariance of the coefficients of a transfer function.
    fn covariance(&self, i: usize, j: usize) -> Result<Option<DMatrix<f64>>> {
        let n = self.task.dofs.len();
        if let Some(joint) = &self.joint {
            let all: Option<Vec<f64>> = (0..n).map(|i| self.variance(i)).collect::<Result<_>>()?;
            if let Some(covariance) = all.and_then(|v| joint.covariance(i * n + j, &v)) {
                return Ok(Some(covariance));
            }
        }
        let Some(variance) = self.variance(i)? else {
            return Ok(None);
        };
        let whole = self.selection.whole(i);
        let gram = whole.inverse_gram(whole.columns())?;
        let places = self.selection.places(i, j);
        Ok(Some(DMatrix::from_fn(
            places.len(),
            places.len(),
            |a, b| gram[(places[a], places[b])] * variance,
        )))
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

    pub(super) fn model(&self) -> Result<Model> {
        let task = self.task;
        assemble(
            &task.fit.form,
            task.dofs,
            &self.poles(),
            &self.coefficients()?,
        )
    }

    fn poles(&self) -> Vec<Vec<Vec<f64>>> {
        self.each(|i, j| self.chain(i, j).clone())
    }

    fn coefficients(&self) -> Result<Vec<Vec<Vec<f64>>>> {
        let solve = |i: usize| {
            let all = self.all(i)?;
            let of = |j| {
                let places = self.selection.places(i, j).into_iter();
                places.map(|p| all[p]).collect()
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
        let all = self.all(i)?;
        // with single motions the entry has rows of its own, to which the constant belongs as well
        let own = self.selection.alone(i, j);
        let constant = self.task.fit.static_term == StaticTerm::Estimated;
        let of_rows: Vec<f64> = constant
            .then_some(all[0])
            .into_iter()
            .chain(values.iter().copied())
            .collect();
        let relative = |f: &Factor| (f.residual_sum_of(&of_rows, 0) / f.total_sum(0)).sqrt();
        let (condition, cancellation) = match own.as_deref() {
            Some(f) => (f.condition(f.columns()), f.cancellation(&of_rows, 0)),
            None => (whole.condition(columns), whole.cancellation(&all, 0)),
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
        .with_coefficients(basis.names(), values, self.covariance(i, j)?))
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
