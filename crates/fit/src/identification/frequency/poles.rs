//! Poles of fits to tables: of every group of entries that shares them, by itself and under constraints.

use crate::error::{Result, counted, ensure};
use crate::identification::basis::Basis;
use crate::identification::form::Form;
use crate::identification::options::FrequencyFit;
use crate::identification::own::{EntryForm, search_for, searched_together};
use crate::identification::report::SearchReport;
use crate::identification::samples::{EntrySamples, shares};
use crate::identification::search::{Bounds, search_poles};
use crate::units::ReducedFrequencyRange;
use nalgebra::DVector;

/// Weighted residuals of all entries under their constraints, from the poles of each.
pub(super) type JointResiduals<'a> = &'a (dyn Fn(&[Vec<f64>]) -> Result<DVector<f64>> + Sync);

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

/// Poles of every entry, one per filter, and how they were found: of every group of entries for itself, or, `together` at given
/// poles, over the residuals of all entries under their constraints. Groups are then searched one after the other, each from where
/// it is best without constraints, and twice.
pub(super) fn choose_poles(
    entries: &[EntrySamples],
    forms: &[EntryForm],
    fit: &FrequencyFit,
    tested: ReducedFrequencyRange,
    together: Option<(JointResiduals<'_>, Vec<Vec<f64>>)>,
) -> Result<(Vec<Vec<f64>>, Vec<SearchReport>)> {
    let (forms, groups) = searched(forms, fit)?;
    let stated = |f: &EntryForm| f.fixed.as_ref().map(|fixed| f.form.expand(fixed));
    let stated = || forms.iter().map(|f| stated(f).unwrap_or_default());
    let (joint, poles) = together.unzip();
    let mut poles = poles.unwrap_or_else(|| stated().collect());
    let in_turn = joint.is_some() && groups.len() > 1;
    let mut reports = Vec::new();
    for _ in 0..=usize::from(in_turn) {
        reports.clear();
        for members in &groups {
            let of = &forms[members[0]];
            let form = &of.form;
            let group: Vec<&EntrySamples> = members.iter().map(|&e| &entries[e]).collect();
            let at = |free: &[f64]| {
                let mut all = poles.clone();
                for &e in members {
                    all[e] = form.expand(free);
                }
                all
            };
            let residuals = |free: &[f64]| match joint {
                Some(joint) => joint(&at(free)),
                None => relative_residuals(&group, form, &form.expand(free)),
            };
            let mut options = search_for(&fit.poles, form);
            if in_turn {
                options.start = Some(form.collapse(&poles[members[0]]));
            }
            let bounds = Bounds::resolve(&options, tested, form)?;
            let name = of.alone.then(|| (group[0].force, group[0].motion));
            let count = form.free_poles();
            let mut report = search_poles(count, &options, bounds, name, &residuals)?;
            report.force = form.poles_per_force().then_some(group[0].force);
            poles = at(&report.chosen.poles);
            reports.push(report);
        }
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
    let (fits, one) = (
        lists.len() == 1 || lists.len() == n,
        counted(count, "number"),
    );
    let expected = format_args!("{one}, or {} for the {n} forces", n * count);
    ensure(fits, "poles.fixed", expected, fixed.len())?;
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
