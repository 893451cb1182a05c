//! The thesis's discrete Laguerre model fitted to records (2.30–2.33, 3.2–3.6).

mod options;

pub use options::DiscreteFit;

use super::least_squares::Factor;
use super::own::StaticTerm;
use super::records::{
    OnProgress, Progress, describe, describe_own, estimated_constants, removed_means, tested_range,
};
use super::report::{
    AlphaGuideline, EntryReport, FitReport, MemoryReport, OrderReport, enough_rows, variance,
};
use super::time::accumulate::{Accumulated, Plan, accumulate};
use super::time::discrete_columns::DiscreteColumns;
use super::time::layout::Layout;
use super::time::selection::Selection;
use super::time::slices::{Scaled, scale_all};
use crate::aerodynamics::DiscreteLaguerre;
use crate::aerodynamics::laguerre::{DiscreteTerm, alpha_lower_bound, discrete_memory};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use crate::wind_tunnel::RecordSource;
use nalgebra::DMatrix;
use std::f64::consts::TAU;
use std::rc::Rc;

/// Fits the discrete Laguerre model: records of lower speeds are resampled to the longest `Δs = VΔt/B` (3.2), the filters
/// run recursively (2.33), a constant column takes the static term, least squares gives the coefficients: `9L` of them
/// from three motions (3.5), with `α` and `L` of its own for any transfer function.
///
/// # Errors
/// [`Error::Input`] for impossible options and for records as in [`super::fit_records`].
pub fn fit_discrete(
    records: &[&dyn RecordSource],
    fit: &DiscreteFit,
    progress: OnProgress<'_>,
) -> Result<(Model, FitReport)> {
    fit.validate()?;
    let (dofs, mut scaled) = scale_all(records)?;
    let means = removed_means(fit.static_term, &dofs, &mut scaled)?;
    let tested = tested_range(&scaled)?;
    let delta_s = scaled.iter().map(Scaled::delta_s).fold(0.0, f64::max);
    let parameters = fit.parameters(&dofs)?;
    let pass = one_pass(&scaled, &parameters, fit, delta_s, progress)?;
    let selection = Selection {
        counts: parameters.iter().map(|(_, filters)| *filters).collect(),
        systems: pass.systems.into_iter().map(Rc::new).collect(),
    };
    let fitted = Fitted::new(&dofs, fit, &parameters, &selection)?;
    let model = fitted.model(delta_s)?;
    let entries = fitted.reports()?;
    let report = FitReport {
        method: format!(
            "discrete Laguerre as in the thesis, L = {}, α = {}{}, Δs = {delta_s:.6}, fitted to {} record(s)",
            fit.filters,
            fit.alpha,
            describe_own(fit.own.len()),
            records.len()
        ),
        weights: describe(fit.weights).into(),
        samples: selection.whole(0).rows(),
        tested_range: tested,
        condition: entries.iter().map(|e| e.condition).fold(1.0, f64::max),
        entries,
        search: Vec::new(),
        orders: fitted.orders(),
        alpha_guideline: Some(guideline(&parameters, tested, delta_s, &scaled)),
        static_terms: if fit.static_term == StaticTerm::Estimated {
            estimated_constants(&selection, &dofs, 1.0)?
        } else {
            means
        },
        memory: memory(&parameters, &scaled, delta_s, &pass.still_samples),
        constraints: None,
        covariance_assumption: "white residuals, exact motions".into(),
        notes: Vec::new(),
    };
    Ok((Model::DiscreteLaguerre(model), with_notes(report)))
}

fn one_pass(
    records: &[Scaled<'_>],
    parameters: &[(f64, usize)],
    fit: &DiscreteFit,
    delta_s: f64,
    progress: OnProgress<'_>,
) -> Result<Accumulated> {
    let inputs = parameters.len().isqrt();
    let filters = parameters.iter().map(|(_, l)| *l).max().unwrap_or(0);
    let rows = parameters.chunks(inputs);
    let mut alphas: Vec<Vec<f64>> = rows.map(|r| r.iter().map(|(a, _)| *a).collect()).collect();
    // filters that serve all forces are filtered once
    if alphas.iter().all(|row| *row == alphas[0]) {
        alphas.truncate(1);
    }
    let constant = fit.static_term == StaticTerm::Estimated;
    let plan = Plan {
        layout: Layout {
            inputs,
            per_input: filters,
            constant,
        },
        weights: fit.weights,
        delta_s: Some(delta_s),
        discard_s: 0.0,
        stride: 1,
        stretches: 0,
    };
    let done = |records_done| {
        progress(Progress {
            pass: 1,
            passes: 1,
            records_done,
            records: records.len(),
        });
    };
    let make = |_: &Scaled<'_>| Ok(DiscreteColumns::new(&alphas, filters, constant));
    accumulate(records, &plan, &make, &done)
}

/// The solved systems.
struct Fitted<'a> {
    dofs: &'a [Dof],
    /// `α` and `L` of every transfer function, row by row.
    parameters: &'a [(f64, usize)],
    selection: &'a Selection,
    /// All coefficients of each force, the constant first.
    coefficients: Vec<DMatrix<f64>>,
    constant: bool,
}

impl<'a> Fitted<'a> {
    fn new(
        dofs: &'a [Dof],
        fit: &DiscreteFit,
        parameters: &'a [(f64, usize)],
        selection: &'a Selection,
    ) -> Result<Self> {
        let solve = |i: usize| {
            let factor = selection.whole(i);
            enough_rows("records", factor.rows(), factor.columns())?;
            if let Some(column) = factor.undetermined(factor.columns()) {
                let holds = |j: &usize| selection.places(i, *j).contains(&column);
                let silent = (0..dofs.len()).find(holds);
                return Err(Error::input(
                    "records",
                    format!(
                        "a {} motion rich enough for the filters",
                        silent.map_or("", |j| dofs[j].name())
                    ),
                    "none that determines its coefficients",
                ));
            }
            factor.solve(factor.columns())
        };
        Ok(Self {
            dofs,
            parameters,
            selection,
            coefficients: (0..dofs.len()).map(solve).collect::<Result<_>>()?,
            constant: fit.static_term == StaticTerm::Estimated,
        })
    }

    fn values(&self, i: usize, j: usize) -> Vec<f64> {
        let places = self.selection.places(i, j).into_iter();
        places.map(|p| self.coefficients[i][p]).collect()
    }

    fn constants(&self) -> Vec<f64> {
        let all = self.coefficients.iter();
        all.map(|c| if self.constant { c[0] } else { 0.0 })
            .collect()
    }

    /// One chain a motion for all forces that share its parameters.
    fn model(&self, delta_s: f64) -> Result<DiscreteLaguerre> {
        let n = self.dofs.len();
        let mut terms = Vec::new();
        for input in 0..n {
            let of_force: Vec<(f64, usize)> =
                (0..n).map(|i| self.parameters[i * n + input]).collect();
            for (i, own) in of_force.iter().enumerate() {
                if of_force[..i].contains(own) {
                    continue;
                }
                let (alpha, filters) = *own;
                let mut coefficients = DMatrix::zeros(n, filters);
                for row in (0..n).filter(|r| of_force[*r] == *own) {
                    for (l, value) in self.values(row, input).into_iter().enumerate() {
                        coefficients[(row, l)] = value;
                    }
                }
                terms.push(DiscreteTerm {
                    input,
                    alpha,
                    coefficients,
                });
            }
        }
        let model = DiscreteLaguerre {
            dofs: self.dofs.to_vec(),
            delta_s,
            terms,
            static_term: self.constants(),
        };
        model.validate()?;
        Ok(model)
    }

    fn reports(&self) -> Result<Vec<EntryReport>> {
        let n = self.dofs.len();
        let each = (0..n * n).map(|e| self.report(e / n, e % n));
        each.collect()
    }

    fn report(&self, i: usize, j: usize) -> Result<EntryReport> {
        let whole = self.selection.whole(i);
        let columns = whole.columns();
        let gram = whole.inverse_gram(columns)?;
        let residual = variance(whole.residual_sum(columns, 0), whole.rows(), columns);
        let (places, values) = (self.selection.places(i, j), self.values(i, j));
        let covariance = residual.map(|v| {
            DMatrix::from_fn(values.len(), values.len(), |a, b| {
                v * gram[(places[a], places[b])]
            })
        });
        // the constant belongs to the rows of every motion
        let constant = self.constant.then_some(self.coefficients[i][0]);
        let of_rows: Vec<f64> = constant.into_iter().chain(values.clone()).collect();
        let own = self.selection.alone(i, j);
        let relative = |f: &Factor| (f.residual_sum_of(&of_rows, 0) / f.total_sum(0)).sqrt();
        let (condition, cancellation) = match own.as_deref() {
            Some(f) => (f.condition(f.columns()), f.cancellation(&of_rows, 0)),
            None => (
                whole.condition(columns),
                whole.cancellation(self.coefficients[i].as_slice(), 0),
            ),
        };
        Ok(EntryReport {
            force: self.dofs[i],
            motion: self.dofs[j],
            relative_rms: own
                .as_deref()
                .filter(|f| f.total_sum(0) > 0.0)
                .map(relative),
            worst_relative: None,
            poles: Vec::new(),
            coefficients: Vec::new(),
            covariance: Vec::new(),
            condition,
            cancellation,
        }
        .with_coefficients(
            (0..values.len()).map(|l| format!("c{l}")).collect(),
            &values,
            covariance,
        ))
    }

    /// Fewer filters, from the same factorisation (shared parameters only).
    fn orders(&self) -> Vec<OrderReport> {
        if self.parameters.iter().any(|p| *p != self.parameters[0]) {
            return Vec::new();
        }
        (1..=self.parameters[0].1)
            .map(|filters| OrderReport {
                filters,
                objective: self.selection.systems[0].objective(filters, &|_, _| true),
            })
            .collect()
    }
}

/// Memory of the slowest chain against the rest before the motion, at the step of the model.
fn memory(
    parameters: &[(f64, usize)],
    records: &[Scaled<'_>],
    delta_s: f64,
    still_samples: &[usize],
) -> Vec<MemoryReport> {
    let memories = parameters.iter().map(|(a, l)| discrete_memory(*a, *l));
    let longest = memories.max().unwrap_or(0);
    let account = |(record, still): (&Scaled<'_>, &usize)| MemoryReport {
        record: record.name().to_owned(),
        memory_samples: longest,
        available_samples: *still,
        step_s: delta_s / record.rate,
    };
    records.iter().zip(still_samples).map(account).collect()
}

/// (2.36) at the highest reduced frequency: `f_max/f_s = K Δs/2π`, whatever the speed; for the smallest `α` in use.
fn guideline(
    parameters: &[(f64, usize)],
    tested: ReducedFrequencyRange,
    delta_s: f64,
    records: &[Scaled<'_>],
) -> AlphaGuideline {
    let rate = records.iter().map(|r| r.rate).fold(0.0, f64::max);
    let sampling_hz = rate / delta_s;
    let highest_frequency_hz = tested.max.full_width() * rate / TAU;
    AlphaGuideline {
        alpha: parameters.iter().map(|(a, _)| *a).fold(1.0, f64::min),
        lower_bound: alpha_lower_bound(highest_frequency_hz, sampling_hz),
        highest_frequency_hz,
        sampling_hz,
    }
}

fn with_notes(mut report: FitReport) -> FitReport {
    report.notes.push(
        "bias of this formulation: without feed-through the lift due to vertical motion is poorly fitted at low K, and \
         in the coupled section the force is held over each step Δt = Δs·B/V, a delay of half a step; on the flat \
         plate of Table 4.1 three filters put the onset 4.5 % below the exact one"
            .into(),
    );
    if let Some(g) = &report.alpha_guideline
        && g.alpha < g.lower_bound
    {
        report.notes.push(format!(
            "α = {} is below the guideline (2.36), {:.4} for {:.2} Hz sampled at {:.0} Hz",
            g.alpha, g.lower_bound, g.highest_frequency_hz, g.sampling_hz
        ));
    }
    report.judge(&super::options::PoleSearch::default());
    report
}

#[cfg(test)]
mod tests;
