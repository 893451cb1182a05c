//! Continuous models fitted to samples of a transfer matrix.

mod joint;
mod poles;

use super::basis::model_of;
use super::degenerate::note_lags;
use super::dissipative::{ConstraintReport, Constraints, FitRequirements};
use super::form::Form;
use super::minimum_state::fit_minimum_state;
use super::options::{FrequencyFit, FrequencyWeights};
use super::own::{describe_own, entry_forms};
use super::report::{FitReport, Fitted};
use super::samples::{EntrySamples, sort_by_entry, state_requirements};
use crate::aerodynamics::derivatives::{Part, TransferSample};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use joint::EntryFits;
use poles::choose_poles;
use std::collections::BTreeMap;

/// Fits a continuous model to samples of `G`: real and imaginary parts, each at its own `K`.
///
/// For given poles every entry is a linear least-squares problem; the poles follow from a bounded search that
/// minimises the relative weighted residuals of all entries together, or of each entry (force) that has poles of its own.
/// In the minimum-state form the entries share everything, and one search finds all of it.
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_fit::*; pub use aerodeck_lab::*; }
/// use aerodeck::files::derivatives::embedded;
/// use aerodeck::identification::{FrequencyFit, fit_table};
/// use aerodeck::section::Dof;
///
/// let table = embedded::deck("LN21-5200")?;
/// let fitted = fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &FrequencyFit::default())?;
/// // as many filters as the data determine
/// assert_eq!(fitted.report.entries[0].poles.len(), 5);
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] for impossible options, samples that are not finite, entries without samples or with too few.
pub fn fit_table(samples: &[TransferSample], dofs: &[Dof], fit: &FrequencyFit) -> Result<Fitted> {
    fit.validate()?;
    let (mut entries, mut notes) = sort_by_entry(samples, dofs, fit.weights)?;
    let fewest = entries.iter().map(|e| e.rows.len()).min();
    let fit = &fit.with_filters_for(fewest.unwrap_or(0));
    state_requirements(&mut entries, dofs, fit)?;
    let spanned = ReducedFrequencyRange::spanning(samples.iter().map(|s| s.k))
        .ok_or_else(|| Error::input("samples", "at least one", "none"))?;
    let tested_range = tested_range(samples, spanned)?;
    let Fitted { model, report } = match fit.form {
        Form::MinimumState { .. } => fit_minimum_state(&entries, dofs, fit, spanned)?,
        _ => fit_linear(&entries, dofs, fit, spanned)?,
    };
    if fit.regularization > 0.0 {
        notes.push(format!(
            "regularised with {}: coefficients are drawn to zero, and standard errors do not hold that bias",
            fit.regularization
        ));
    }
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
        covariance_assumption:
            "weighted residuals are independent and of one variance; the poles count as known"
                .into(),
        notes,
        ..report
    };
    report.judge(&fit.poles);
    note_lags(&model, &mut report.notes);
    Ok(Fitted { model, report })
}

/// Reduced frequencies in which every number was tested, as those of a table.
fn tested_range(
    samples: &[TransferSample],
    spanned: ReducedFrequencyRange,
) -> Result<ReducedFrequencyRange> {
    let mut tested: BTreeMap<_, Vec<ReducedFrequency>> = BTreeMap::new();
    for s in samples {
        let number = (s.force, s.motion, s.part == Part::Real);
        tested.entry(number).or_default().push(s.k);
    }
    let ranges = tested.into_values();
    let ranges = ranges.filter_map(ReducedFrequencyRange::spanning);
    ReducedFrequencyRange::common(ranges).unwrap_or(Ok(spanned))
}

/// Every form whose entries are linear in their coefficients once the poles are known: each entry by itself, and all of
/// them again where that breaks a constraint.
fn fit_linear(
    entries: &[EntrySamples],
    dofs: &[Dof],
    fit: &FrequencyFit,
    tested: ReducedFrequencyRange,
) -> Result<Fitted> {
    let forms = entry_forms(dofs, &fit.form, &fit.poles, &fit.own)?;
    let (poles, search) = choose_poles(entries, &forms, fit, tested, None)?;
    let by_themselves = EntryFits::alone(entries, &fit.form, &poles, true)?;
    let reports = by_themselves.reports()?;
    let alone = Fitted {
        model: model_of(&fit.form, dofs, &reports)?,
        report: FitReport::new(tested, reports, search),
    };
    if fit.constraints == Constraints::None {
        return Ok(alone);
    }
    // but for the limits, which every entry or force meets by itself
    let requirements = FitRequirements::new(dofs, tested, fit.constraints);
    let shares = by_themselves.shares_by_noise();
    let bound = by_themselves.held(&requirements, &shares, true)?;
    if bound.solution().is_none() {
        return Ok(alone);
    }
    // a ridge weighs the terms of the model themselves, else only the space counts
    let native = fit.regularization > 0.0;
    let residuals = |poles: &[Vec<f64>]| {
        let alone = EntryFits::alone(entries, &fit.form, poles, native)?;
        let held = alone.held(&requirements, &shares, false)?;
        Ok(held.residuals(&shares))
    };
    let (poles, search) = choose_poles(entries, &forms, fit, tested, Some((&residuals, poles)))?;
    let together = EntryFits::alone(entries, &fit.form, &poles, true)?;
    let together = together.held(&requirements, &shares, true)?;
    let reports = together.reports()?;
    let model = model_of(&fit.form, dofs, &reports)?;
    let active = together.solution().map(|solution| solution.active.clone());
    let constraints = ConstraintReport::new(
        active.unwrap_or_default(),
        dofs,
        &alone.report.entries,
        &bound.bases,
        &reports,
        alone.model,
    );
    let report = FitReport {
        constraints: Some(constraints),
        ..FitReport::new(tested, reports, search)
    };
    Ok(Fitted { model, report })
}

fn describe(weights: FrequencyWeights) -> &'static str {
    match weights {
        FrequencyWeights::None => "none: residuals of G",
        FrequencyWeights::Derivatives => "1/K²: residuals of the aerodynamic derivatives",
        FrequencyWeights::Relative => "1/|G| of the entry at its point: relative residuals",
    }
}

#[cfg(test)]
mod tests;
