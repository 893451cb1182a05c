//! Poles of fits to tables: of every group of entries that shares them, by itself and under constraints.

use super::joint::Joint;
use crate::error::{Result, ensure};
use crate::identification::basis::Basis;
use crate::identification::form::Form;
use crate::identification::form::PoleSearch;
use crate::identification::frequency_options::FrequencyFit;
use crate::identification::own::{EntryForm, search_for, searched_together};
use crate::identification::report::SearchReport;
use crate::identification::samples::{EntrySamples, shares};
use crate::identification::search::{Bounds, PoleResiduals, search_poles};
use crate::units::ReducedFrequencyRange;
use nalgebra::DVector;

/// Forms with the lags that are given, and the groups of entries whose poles are searched.
fn searched(forms: &[EntryForm], fit: &FrequencyFit) -> Result<(Vec<EntryForm>, Vec<Vec<usize>>)> {
    let mut forms = forms.to_vec();
    let mut groups = searched_together(&forms);
    if fit.form.poles_per_force() {
        let n = forms.len().isqrt();
        state_lags_of_forces(&mut forms, fit, n)?;
        groups = (0..n).map(|i| (i * n..(i + 1) * n).collect()).collect();
        groups.retain(|group: &Vec<usize>| forms[group[0]].fixed.is_none());
    }
    Ok((forms, groups))
}

/// Poles of every entry, one per filter, and how they were found.
pub(super) fn choose_poles(
    entries: &[EntrySamples],
    forms: &[EntryForm],
    fit: &FrequencyFit,
    tested: ReducedFrequencyRange,
) -> Result<(Vec<Vec<f64>>, Vec<SearchReport>)> {
    let (forms, groups) = searched(forms, fit)?;
    let stated = |f: &EntryForm| f.fixed.as_ref().map(|fixed| f.form.expand(fixed));
    let mut poles: Vec<Vec<f64>> = forms
        .iter()
        .map(|f| stated(f).unwrap_or_default())
        .collect();
    let mut reports = Vec::new();
    for members in groups {
        let form = &forms[members[0]].form;
        let group: Vec<&EntrySamples> = members.iter().map(|&e| &entries[e]).collect();
        let residuals = |free: &[f64]| relative_residuals(&group, form, &form.expand(free));
        let options = search_for(&fit.poles, form);
        reports.push(search_group(
            &group,
            &forms[members[0]],
            &options,
            tested,
            &residuals,
        )?);
        for e in members {
            poles[e] = form.expand(&reports[reports.len() - 1].chosen.poles);
        }
    }
    Ok((poles, reports))
}

/// The same over the residuals of all entries under their constraints. Groups are searched one after the other, each
/// from where it is best without constraints, and twice.
pub(super) fn choose_poles_together(
    joint: &Joint<'_>,
    forms: &[EntryForm],
    fit: &FrequencyFit,
    tested: ReducedFrequencyRange,
    mut poles: Vec<Vec<f64>>,
) -> Result<(Vec<Vec<f64>>, Vec<SearchReport>)> {
    let (forms, groups) = searched(forms, fit)?;
    let rounds = if groups.len() > 1 { 2 } else { 1 };
    let mut reports = Vec::new();
    for _ in 0..rounds {
        reports.clear();
        for members in &groups {
            let form = &forms[members[0]].form;
            let group: Vec<&EntrySamples> = members.iter().map(|&e| &joint.entries[e]).collect();
            let at = |free: &[f64]| {
                let mut all = poles.clone();
                for &e in members {
                    all[e] = form.expand(free);
                }
                all
            };
            let residuals = |free: &[f64]| joint.residuals(&at(free));
            let mut options = search_for(&fit.poles, form);
            if groups.len() > 1 {
                options.start = Some(form.collapse(&poles[members[0]]));
            }
            let first = &forms[members[0]];
            let report = search_group(&group, first, &options, tested, &residuals)?;
            poles = at(&report.chosen.poles);
            reports.push(report);
        }
    }
    Ok((poles, reports))
}

/// Searches the poles that a group of entries shares.
fn search_group(
    group: &[&EntrySamples],
    of: &EntryForm,
    options: &PoleSearch,
    tested: ReducedFrequencyRange,
    residuals: PoleResiduals<'_>,
) -> Result<SearchReport> {
    let form = &of.form;
    let bounds = Bounds::resolve(options, tested, form)?;
    let name = of.alone.then(|| (group[0].force, group[0].motion));
    let mut report = search_poles(form.free_poles(), options, bounds, name, residuals)?;
    report.force = form.poles_per_force().then_some(group[0].force);
    Ok(report)
}

/// Lags that are given: one list for all forces, or those of the forces one after the other.
fn state_lags_of_forces(forms: &mut [EntryForm], fit: &FrequencyFit, n: usize) -> Result<()> {
    let Some(fixed) = &fit.poles.fixed else {
        return Ok(());
    };
    let count = fit.form.free_poles();
    let lists: Vec<&[f64]> = fixed.chunks(count).collect();
    ensure(
        lists.len() == 1 || lists.len() == n,
        "poles.fixed",
        format_args!("{count} number(s), or {} for the {n} forces", n * count),
        fixed.len(),
    )?;
    for (e, form) in forms.iter_mut().enumerate() {
        let list = lists[if lists.len() == 1 { 0 } else { e / n }];
        form.fixed = Some(list.to_vec());
    }
    Ok(())
}

/// Weighted residuals of all entries with the best coefficients for these poles, each entry relative to its weighted
/// data: whatever the weights, the poles do not follow the largest entry alone. The norm is the objective.
fn relative_residuals(
    entries: &[&EntrySamples],
    form: &Form,
    poles: &[f64],
) -> Result<DVector<f64>> {
    let mut all = Vec::new();
    for (entry, scale) in entries.iter().zip(shares(entries)) {
        // a ridge weighs the terms of the model themselves, else only the space counts
        let basis = if entry.ridge > 0.0 {
            Basis::new(form, poles)?
        } else {
            Basis::orthonormal(form, poles)?
        };
        let fit = entry.fit(&basis)?;
        all.extend(entry.weighted_residuals(&basis, &fit.coefficients, scale));
        all.extend(fit.penalty(&fit.coefficients).map(|r| r * scale));
    }
    Ok(DVector::from_vec(all))
}
