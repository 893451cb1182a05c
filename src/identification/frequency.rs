//! Continuous models fitted to samples of a transfer matrix.

use super::basis::{Basis, assemble};
use super::degenerate::note_lags;
use super::frequency_options::{FrequencyFit, FrequencyWeights};
use super::minimum_state::fit_minimum_state;
use super::options::Form;
use super::own::{EntryForm, entry_forms, search_for, searched_together};
use super::records::describe_own;
use super::report::{EntryReport, FitReport, SearchReport, variance};
use super::samples::{Entry, sort_by_entry, state_wishes};
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
/// minimises the relative weighted residuals of all entries together, or of each entry (force) that has poles of its own.
/// In the minimum-state form the entries share everything, and one search finds all of it.
///
/// # Errors
/// [`Error::Input`] for impossible options, samples that are not finite, entries without samples or with too few.
pub fn fit_table(
    samples: &[TransferSample],
    dofs: &[Dof],
    fit: &FrequencyFit,
) -> Result<(Model, FitReport)> {
    fit.validate()?;
    let (mut entries, mut notes) = sort_by_entry(samples, dofs, fit.weights)?;
    state_wishes(&mut entries, dofs, fit)?;
    let tested_range = ReducedFrequencyRange::spanning(samples.iter().map(|s| s.k))
        .ok_or_else(|| Error::input("samples", "at least one", "none"))?;
    let fitted = if let Form::MinimumState { .. } = fit.form {
        fit_minimum_state(&entries, dofs, fit, tested_range)?
    } else {
        fit_linear(&entries, dofs, fit, tested_range)?
    };
    if fit.regularization > 0.0 {
        notes.push(format!(
            "regularised with {}: coefficients are drawn to zero, and standard errors do not hold that bias",
            fit.regularization
        ));
    }
    let Fitted {
        model,
        reports,
        search,
    } = fitted;
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
    note_lags(&model, &mut report.notes);
    Ok((model, report))
}

/// A model and the account of how it was found.
pub(super) struct Fitted {
    pub model: Model,
    pub reports: Vec<EntryReport>,
    pub search: Vec<SearchReport>,
}

/// Every form whose entries are linear in their coefficients once the poles are known.
fn fit_linear(
    entries: &[Entry],
    dofs: &[Dof],
    fit: &FrequencyFit,
    tested: ReducedFrequencyRange,
) -> Result<Fitted> {
    let forms = entry_forms(dofs, &fit.form, &fit.poles, &fit.own)?;
    let (poles, search) = choose_poles(entries, &forms, fit, tested)?;
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
    Ok(Fitted {
        model: assemble(&fit.form, dofs, &by_row(&poles), &by_row(&coefficients))?,
        reports,
        search,
    })
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
    let mut forms = forms.to_vec();
    let mut groups = searched_together(&forms);
    if fit.form.poles_per_force() {
        let n = (1..=entries.len())
            .find(|n| n * n == entries.len())
            .unwrap_or(1);
        state_lags_of_forces(&mut forms, fit, n)?;
        groups = (0..n).map(|i| (i * n..(i + 1) * n).collect()).collect();
        groups.retain(|group: &Vec<usize>| forms[group[0]].fixed.is_none());
    }
    let stated = |f: &EntryForm| f.fixed.as_ref().map(|fixed| f.form.expand(fixed));
    let mut poles: Vec<Vec<f64>> = forms
        .iter()
        .map(|f| stated(f).unwrap_or_default())
        .collect();
    let mut reports = Vec::new();
    for members in groups {
        let EntryForm { form, alone, .. } = &forms[members[0]];
        let options = search_for(&fit.poles, form);
        let bounds = Bounds::resolve(&options, tested, form.free_poles())?;
        let group: Vec<&Entry> = members.iter().map(|&e| &entries[e]).collect();
        let name = alone.then(|| (group[0].force, group[0].motion));
        let residuals = |free: &[f64]| relative_residuals(&group, form, &form.expand(free));
        let mut report = search_poles(form.free_poles(), (&options, bounds), name, &residuals)?;
        report.force = form.poles_per_force().then_some(group[0].force);
        for e in members {
            poles[e] = form.expand(&report.chosen.poles);
        }
        reports.push(report);
    }
    Ok((poles, reports))
}

/// Lags that are given: one list for all forces, or those of the forces one after the other.
fn state_lags_of_forces(forms: &mut [EntryForm], fit: &FrequencyFit, n: usize) -> Result<()> {
    let Some(fixed) = &fit.poles.fixed else {
        return Ok(());
    };
    let count = fit.form.free_poles();
    let lists: Vec<&[f64]> = fixed.chunks(count).collect();
    if lists.len() != 1 && lists.len() != n {
        return Err(Error::input(
            "poles.fixed",
            format!("{count} number(s), or {} for the {n} forces", n * count),
            fixed.len().to_string(),
        ));
    }
    for (e, form) in forms.iter_mut().enumerate() {
        let list = lists[if lists.len() == 1 { 0 } else { e / n }];
        form.fixed = Some(list.to_vec());
    }
    Ok(())
}

/// Weighted residuals of all entries with the best coefficients for these poles, each entry relative to its weighted
/// data: whatever the weights, the poles do not follow the largest entry alone. The norm is the objective.
fn relative_residuals(entries: &[&Entry], form: &Form, poles: &[f64]) -> Result<DVector<f64>> {
    let mut all = Vec::new();
    for (entry, scale) in entries.iter().zip(shares(entries)) {
        // a ridge weighs the terms of the model themselves, else only the space counts
        let basis = if entry.ridge > 0.0 {
            Basis::new(form, poles)?
        } else {
            Basis::orthonormal(form, poles)?
        };
        let fit = entry.fit(&basis)?;
        let residuals = entry.residuals(&basis, &fit.coefficients);
        let weighted = residuals.iter().zip(&entry.rows);
        all.extend(weighted.map(|(r, row)| r * row.weight * scale));
        all.extend(fit.penalty.iter().map(|r| r * scale));
    }
    Ok(DVector::from_vec(all))
}

/// What the weighted residuals of each entry are multiplied with where entries share something: its weight over its
/// weighted size.
pub(super) fn shares(entries: &[&Entry]) -> Vec<f64> {
    let share = |entry: &&Entry| {
        let total = entry.total();
        let size = if total > 0.0 {
            (total * entries.len() as f64).sqrt()
        } else {
            1.0
        };
        entry.weight / size
    };
    entries.iter().map(share).collect()
}

/// Coefficients of one entry in the columns of the model, and their account.
fn fit_entry(entry: &Entry, form: &Form, poles: &[f64]) -> Result<(Vec<f64>, EntryReport)> {
    let basis = Basis::new(form, poles)?;
    let fit = entry.fit(&basis)?;
    let residuals = entry.residuals(&basis, &fit.coefficients);
    let unknowns = fit.unknowns;
    let covariance = variance(
        fit.factor.residual_sum(unknowns, 0),
        entry.rows.len(),
        unknowns,
    )
    .map(|v| fit.inverse_gram().map(|gram| gram * v))
    .transpose()?;
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
        cancellation: fit.cancellation,
    }
    .with_coefficients(basis.names(), &fit.coefficients, covariance);
    Ok((fit.coefficients, report))
}

/// Relative root mean square and worst relative size of unweighted residuals.
pub(super) fn sizes(entry: &Entry, residuals: &[f64]) -> (f64, f64) {
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
mod constrained_tests;
#[cfg(test)]
mod form_tests;
#[cfg(test)]
mod tests;
