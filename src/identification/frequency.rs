//! Continuous models fitted to samples of a transfer matrix.

use super::basis::{Basis, assemble};
use super::options::{Form, FrequencyFit, FrequencyWeights};
use super::own::{EntryForm, entry_forms, search_for, searched_together};
use super::records::describe_own;
use super::report::{EntryReport, FitReport, SearchReport, variance};
use super::samples::{Entry, sort_by_entry};
use super::search::{Bounds, search_poles};
use crate::aerodynamics::derivatives::TransferSample;
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use nalgebra::DVector;

/// Fits a continuous model to samples of `G`: real and imaginary parts, each at its own `K`.
///
/// For given poles every entry is a linear least-squares problem; the poles follow from a bounded search that
/// minimises the relative weighted residuals of all entries together, or of each entry where it has poles of its own.
///
/// # Errors
/// [`Error::Input`] for impossible options, samples that are not finite, entries without samples or with too few.
pub fn fit_table(
    samples: &[TransferSample],
    dofs: &[Dof],
    fit: &FrequencyFit,
) -> Result<(Model, FitReport)> {
    fit.validate()?;
    let (entries, notes) = sort_by_entry(samples, dofs, fit.weights)?;
    let tested_range = ReducedFrequencyRange::spanning(samples.iter().map(|s| s.k))
        .ok_or_else(|| Error::input("samples", "at least one", "none"))?;
    let forms = entry_forms(dofs, &fit.form, &fit.poles, &fit.own)?;
    let (poles, search) = choose_poles(&entries, &forms, fit, tested_range)?;
    let mut reports = Vec::with_capacity(entries.len());
    let mut coefficients = Vec::with_capacity(entries.len());
    for (entry, poles) in entries.iter().zip(&poles) {
        let (values, report) = fit_entry(entry, &fit.form, poles)?;
        coefficients.push(values);
        reports.push(report);
    }
    let by_row = |list: &[Vec<f64>]| {
        list.chunks(dofs.len())
            .map(<[_]>::to_vec)
            .collect::<Vec<_>>()
    };
    let model = assemble(&fit.form, dofs, &by_row(&poles), &by_row(&coefficients))?;
    let mut report = FitReport {
        method: format!(
            "{}{}, fitted to {} numbers of the transfer matrix",
            fit.form.describe(),
            describe_own(fit.own.len()),
            samples.len()
        ),
        weights: describe(fit.weights).into(),
        samples: samples.len(),
        tested_range,
        condition: reports.iter().map(|r| r.condition).fold(1.0, f64::max),
        entries: reports,
        search,
        orders: Vec::new(),
        alpha_guideline: None,
        static_terms: Vec::new(),
        memory: Vec::new(),
        covariance_assumption:
            "weighted residuals are independent and of one variance; the poles count as known"
                .into(),
        notes,
    };
    report.judge(&fit.poles);
    Ok((model, report))
}

fn describe(weights: FrequencyWeights) -> &'static str {
    match weights {
        FrequencyWeights::None => "none: residuals of G",
        FrequencyWeights::Derivatives => "1/K²: residuals of the aerodynamic derivatives",
        FrequencyWeights::Relative => "1/|G| of the entry at its point: relative residuals",
    }
}

/// Poles of every entry, one a filter, and how they were found.
fn choose_poles(
    entries: &[Entry],
    forms: &[EntryForm],
    fit: &FrequencyFit,
    tested: ReducedFrequencyRange,
) -> Result<(Vec<Vec<f64>>, Vec<SearchReport>)> {
    let stated = |f: &EntryForm| f.fixed.as_ref().map(|fixed| f.form.expand(fixed));
    let mut poles: Vec<Vec<f64>> = forms
        .iter()
        .map(|f| stated(f).unwrap_or_default())
        .collect();
    let mut reports = Vec::new();
    for members in searched_together(forms) {
        let EntryForm { form, alone, .. } = &forms[members[0]];
        let options = search_for(&fit.poles, form);
        let bounds = Bounds::resolve(&options, tested, form.free_poles())?;
        let group: Vec<&Entry> = members.iter().map(|&e| &entries[e]).collect();
        let name = alone.then(|| (group[0].force, group[0].motion));
        let residuals = |free: &[f64]| relative_residuals(&group, form, &form.expand(free));
        let report = search_poles(form.free_poles(), (&options, bounds), name, &residuals)?;
        for e in members {
            poles[e] = form.expand(&report.chosen.poles);
        }
        reports.push(report);
    }
    Ok((poles, reports))
}

/// Weighted residuals of all entries with the best coefficients for these poles, each entry relative to its weighted
/// data: whatever the weights, the poles do not follow the largest entry alone. The norm is the objective.
fn relative_residuals(entries: &[&Entry], form: &Form, poles: &[f64]) -> Result<DVector<f64>> {
    let basis = Basis::orthonormal(form, poles)?;
    let mut all = Vec::new();
    for entry in entries {
        let fit = entry.fit(&basis)?;
        let residuals = entry.residuals(&basis, &fit.coefficients);
        let total = entry.total();
        let size = if total > 0.0 {
            (total * entries.len() as f64).sqrt()
        } else {
            1.0
        };
        let weighted = residuals
            .iter()
            .zip(&entry.rows)
            .map(|(r, row)| r * row.weight / size);
        all.extend(weighted);
    }
    Ok(DVector::from_vec(all))
}

/// Coefficients of one entry in the columns of the model, and their account.
fn fit_entry(entry: &Entry, form: &Form, poles: &[f64]) -> Result<(Vec<f64>, EntryReport)> {
    let basis = Basis::new(form, poles)?;
    let fit = entry.fit(&basis)?;
    let residuals = entry.residuals(&basis, &fit.coefficients);
    let unknowns = fit.fitted.len();
    let covariance = variance(
        fit.factor.residual_sum(unknowns, 0),
        entry.rows.len(),
        unknowns,
    )
    .map(|v| fit.inverse_gram().map(|gram| gram * v))
    .transpose()?;
    let solved: Vec<f64> = fit.fitted.iter().map(|&c| fit.coefficients[c]).collect();
    let (relative_rms, worst) = sizes(entry, &residuals);
    let report = EntryReport {
        force: entry.force,
        motion: entry.motion,
        relative_rms: Some(relative_rms),
        worst_relative: Some(worst),
        poles: poles.to_vec(),
        coefficients: Vec::new(),
        covariance: Vec::new(),
        condition: fit.factor.condition(unknowns),
        cancellation: fit.factor.cancellation(&solved, 0),
    }
    .with_coefficients(basis.names(), &fit.coefficients, covariance);
    Ok((fit.coefficients, report))
}

/// Relative root mean square and worst relative size of unweighted residuals.
fn sizes(entry: &Entry, residuals: &[f64]) -> (f64, f64) {
    let sum: f64 = residuals.iter().map(|r| r * r).sum();
    let total: f64 = entry.rows.iter().map(|r| r.value * r.value).sum();
    let relative = residuals
        .iter()
        .zip(&entry.rows)
        .filter(|(_, row)| row.magnitude > 0.0);
    let worst = relative
        .map(|(r, row)| r.abs() / row.magnitude)
        .fold(0.0, f64::max);
    let rms = if total > 0.0 {
        (sum / total).sqrt()
    } else {
        0.0
    };
    (rms, worst)
}

#[cfg(test)]
mod tests;
