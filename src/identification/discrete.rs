//! The thesis's discrete Laguerre model fitted to records (2.30–2.33, 3.2–3.6).

use super::least_squares::Factor;
use super::options::DiscreteFit;
use super::records::{OnProgress, Progress, describe, tested_range};
use super::report::{AlphaGuideline, EntryReport, FitReport, OrderReport, enough_rows, variance};
use super::time::accumulate::{Factored, Layout, Plan, accumulate};
use super::time::filters::DiscreteColumns;
use super::time::slices::{Scaled, scale_all};
use crate::aerodynamics::DiscreteLaguerre;
use crate::aerodynamics::laguerre::alpha_lower_bound;
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use crate::wind_tunnel::RecordSource;
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Fits the discrete Laguerre model: records of lower speeds are resampled to the longest `Δs = VΔt/B` (3.2), the filters
/// run recursively (2.33), a constant column takes the static term, least squares gives the coefficients.
///
/// # Errors
/// [`Error::Input`] for impossible options and for records as in [`super::fit_records`].
pub fn fit_discrete(
    records: &[&dyn RecordSource],
    fit: &DiscreteFit,
    progress: OnProgress<'_>,
) -> Result<(Model, FitReport)> {
    fit.validate()?;
    let (dofs, scaled) = scale_all(records)?;
    let tested = tested_range(&scaled)?;
    let delta_s = scaled.iter().map(Scaled::delta_s).fold(0.0, f64::max);
    let system = one_pass(&scaled, &dofs, fit, delta_s, progress)?;
    check(&system, &dofs)?;
    let coefficients = (0..dofs.len())
        .map(|i| system.whole[i].solve(system.whole[i].columns()))
        .collect::<Result<Vec<_>>>()?;
    let model = DiscreteLaguerre {
        dofs: dofs.clone(),
        alpha: fit.alpha,
        delta_s,
        coefficients: (0..dofs.len())
            .map(|j| {
                DMatrix::from_fn(dofs.len(), fit.filters, |i, l| {
                    coefficients[i][system.layout.index(l, j)]
                })
            })
            .collect(),
        static_term: coefficients.iter().map(|c| c[0]).collect(),
    };
    model.validate()?;
    let entries = reports(&system, &dofs, &coefficients)?;
    let report = FitReport {
        method: format!(
            "discrete Laguerre as in the thesis, L = {}, α = {}, Δs = {delta_s:.6}, fitted to {} record(s)",
            fit.filters,
            fit.alpha,
            records.len()
        ),
        weights: describe(fit.weights).into(),
        samples: system.whole[0].rows(),
        tested_range: tested,
        condition: entries.iter().map(|e| e.condition).fold(1.0, f64::max),
        entries,
        search: Vec::new(),
        orders: (1..=fit.filters)
            .map(|filters| OrderReport {
                filters,
                objective: system.objective(filters),
            })
            .collect(),
        alpha_guideline: Some(guideline(fit.alpha, tested, delta_s, &scaled)),
        covariance_assumption: "white residuals, exact motions".into(),
        notes: Vec::new(),
    };
    Ok((Model::DiscreteLaguerre(model), with_notes(report)))
}

fn one_pass(
    records: &[Scaled<'_>],
    dofs: &[Dof],
    fit: &DiscreteFit,
    delta_s: f64,
    progress: OnProgress<'_>,
) -> Result<Factored> {
    let plan = Plan {
        layout: Layout {
            inputs: dofs.len(),
            per_input: fit.filters,
            constant: true,
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
    let make = |_: &Scaled<'_>| Ok(DiscreteColumns::new(dofs.len(), fit.filters, fit.alpha));
    accumulate(records, &plan, &make, &done)?
        .pop()
        .ok_or_else(|| Error::Numerical("discrete fit: no system".into()))
}

fn check(system: &Factored, dofs: &[Dof]) -> Result<()> {
    let factor = &system.whole[0];
    enough_rows("records", factor.rows(), factor.columns())?;
    match factor.undetermined(factor.columns()) {
        None => Ok(()),
        Some(column) => {
            let dof = dofs[(column.max(1) - 1) % dofs.len()];
            Err(Error::input(
                "records",
                format!("a {} motion rich enough for the filters", dof.name()),
                "none that determines its coefficients",
            ))
        }
    }
}

fn reports(
    system: &Factored,
    dofs: &[Dof],
    coefficients: &[DMatrix<f64>],
) -> Result<Vec<EntryReport>> {
    let per_input = system.layout.per_input;
    let names: Vec<String> = (0..per_input).map(|l| format!("c{l}")).collect();
    let mut reports = Vec::new();
    for (i, all) in coefficients.iter().enumerate() {
        let whole = &system.whole[i];
        let columns = whole.columns();
        let gram = whole.inverse_gram(columns)?;
        let residual = variance(whole.residual_sum(columns, 0), whole.rows(), columns);
        for (j, &motion) in dofs.iter().enumerate() {
            let at = |l: usize| system.layout.index(l, j);
            let values: Vec<f64> = (0..per_input).map(|l| all[at(l)]).collect();
            let covariance = residual
                .map(|v| DMatrix::from_fn(per_input, per_input, |a, b| v * gram[(at(a), at(b))]));
            // the constant belongs to the rows of every motion
            let with_constant: Vec<f64> = [all[0]].into_iter().chain(values.clone()).collect();
            let own = system.alone(i, j).filter(|_| system.single_motions());
            let relative =
                |f: &Factor| (f.residual_sum_of(&with_constant, 0) / f.total_sum(0)).sqrt();
            reports.push(
                EntryReport {
                    force: dofs[i],
                    motion,
                    relative_rms: own.filter(|f| f.total_sum(0) > 0.0).map(relative),
                    worst_relative: None,
                    poles: Vec::new(),
                    coefficients: Vec::new(),
                    covariance: Vec::new(),
                    condition: own
                        .unwrap_or(whole)
                        .condition(own.unwrap_or(whole).columns()),
                    cancellation: match own {
                        Some(f) => f.cancellation(&with_constant, 0),
                        None => whole.cancellation(all.as_slice(), 0),
                    },
                }
                .with_coefficients(names.clone(), &values, covariance),
            );
        }
    }
    Ok(reports)
}

/// (2.36) at the highest reduced frequency: `f_max/f_s = K Δs/2π`, whatever the speed.
fn guideline(
    alpha: f64,
    tested: ReducedFrequencyRange,
    delta_s: f64,
    records: &[Scaled<'_>],
) -> AlphaGuideline {
    let rate = records.iter().map(|r| r.rate).fold(0.0, f64::max);
    let sampling_hz = rate / delta_s;
    let highest_frequency_hz = tested.max.full_width() * rate / TAU;
    AlphaGuideline {
        alpha,
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
