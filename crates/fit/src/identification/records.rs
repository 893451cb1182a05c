//! Continuous models fitted to forced-vibration records: [`fit_records`] has the steps. Records are read, poles chosen by
//! passes over thinned rows, every sample fitted at these poles in one more pass, the fit put under constraints where they
//! bind, and written down as model and report.

use super::basis::{Basis, model_of};
use super::degenerate::note_lags;
use super::dissipative::ConstraintReport;
use super::form::Form;
use super::options::TimeFit;
use super::own::describe_own;
use super::report::{FitReport, Fitted, MemoryReport, SearchReport, enough_rows};
use super::time::continuous::{RecordFit, padded};
use super::time::fitted::FittedSystems;
use super::time::record::{DimensionlessRecord, Records};
use super::time::search::{EntryPoles, PASSES, choose_poles};
use super::time::systems::ForceSystems;
use crate::aerodynamics::FilterBank;
use crate::error::{Error, Result, counted};
use crate::numbered::OnDone;
use crate::wind_tunnel::RecordSource;

/// Fits a continuous model to records of any speeds and sampling frequencies.
///
/// The poles follow from a few passes over the records, each of which evaluates a whole grid of candidates; the last
/// pass fits the chosen ones to every sample.
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_fit::*; pub use aerodeck_lab::*; }
/// use aerodeck::files::derivatives::embedded;
/// use aerodeck::identification::{TimeFit, fit_records};
/// use aerodeck::section::Dof;
/// use aerodeck::wind_tunnel::{RecordSource, TunnelPlan};
///
/// let plan = TunnelPlan { sampling_hz: 50.0, segment_s: 12.0, ..TunnelPlan::default() };
/// let records = plan.records_from_table(&embedded::deck("LN21-5200")?, &Dof::TWO)?;
/// let records: Vec<&dyn RecordSource> = records.iter().map(|r| r as _).collect();
/// let fitted = fit_records(&records, &TimeFit::default(), &|_, _| ())?;
/// assert!(fitted.report.method.contains("4 records in the time domain"));
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] for impossible options, records that do not fit together, are too short, contain numbers that are
/// not finite or do not move a degree of freedom; for poles per transfer function, records that move two at once.
pub fn fit_records(
    records: &[&dyn RecordSource],
    fit: &TimeFit,
    progress: OnDone<'_>,
) -> Result<Fitted> {
    fit.validate()?;
    let records = Records::read(records, fit.static_term)?;
    let fit = &fit.with_filters_for(&records);
    let spanned = records.spanned_range()?;
    let task = RecordFit {
        fit,
        records: &records,
        progress,
    };
    // what the tests do not determine fails in the search of poles, in words that say nothing of it
    let chosen = choose_poles(&task, spanned).map_err(|e| task.too_few_numbers(e))?;
    let (found, search, constraints) = task.under_constraints(chosen)?;
    let entries = found.reports()?;
    let model = model_of(&fit.form, &records.dofs, &entries)?;
    let alike = found.chains.iter().all(|c| *c == found.chains[0]);
    let mut report = FitReport {
        method: format!(
            "{}{}, fitted to {} in the time domain",
            fit.form.describe(),
            describe_own(fit.own.len()),
            counted(records.each.len(), "record")
        ),
        weights: fit.weights.describe().into(),
        samples: found.systems.whole(0).rows,
        orders: match fit.form {
            Form::Rational { .. } => Vec::new(),
            _ if !alike => Vec::new(),
            _ => found.orders(fit.form.feed_through().count()),
        },
        static_terms: [records.removed_means.clone(), found.constants()?].concat(),
        memory: task.memory(&found.chains)?,
        constraints,
        covariance_assumption:
            "noise of the forces is white before the low-pass, motions are exact, the poles count \
                                as known"
                .into(),
        notes: records.odd_air(),
        ..FitReport::new(records.tested_range()?, entries, search)
    };
    report.judge(&fit.poles);
    note_lags(&model, &mut report.notes);
    Ok(Fitted { model, report })
}

impl<'a> RecordFit<'a> {
    /// The number of filters in place of a solve that failed, where they are more than the tests determine.
    fn too_few_numbers(&self, failed: Error) -> Error {
        let form = &self.fit.form;
        let unknowns = form.feed_through().count() + form.filters();
        let alike = self.fit.own.is_empty() && matches!(failed, Error::Numerical(_));
        let counted = enough_rows("records", self.records.rows_of_tests(), unknowns);
        counted.err().filter(|_| alike).unwrap_or(failed)
    }

    /// The pass over every sample, then least squares: a fit at the unconstrained poles and, where the constrained ones
    /// are others, one at those.
    fn least_squares_at(&'a self, chosen: &[EntryPoles]) -> Result<Vec<FittedSystems<'a>>> {
        let chains = chosen.iter().map(|(chains, _)| chains.clone());
        let mut sets: Vec<Vec<Vec<f64>>> = chains.collect();
        sets.dedup();
        let feed = self.fit.form.feed_through().count();
        let longest = sets.iter().flatten().map(Vec::len).max().unwrap_or(0);
        let (mut bases, mut counts) = (Vec::new(), Vec::new());
        for chains in &sets {
            let padded_row = |row: &[Vec<f64>]| row.iter().map(|c| padded(c, longest)).collect();
            let rows = chains.chunks(self.records.dofs.len());
            let mut of_force: Vec<Vec<Vec<f64>>> = rows.map(padded_row).collect();
            // filters that serve all forces are filtered once
            if of_force.iter().all(|row| *row == of_force[0]) {
                of_force.truncate(1);
            }
            counts.push(of_force.len());
            for row in &of_force {
                bases.push(self.bases(row)?);
            }
        }
        let pass = self.pass(&bases, 1, 0, PASSES, PASSES)?;
        let mut systems = pass.systems().into_iter();
        let (dofs, filters) = (&self.records.dofs, self.fit.form.describe());
        let fit = |(chains, count): (Vec<Vec<f64>>, usize)| {
            let forces = ForceSystems {
                counts: chains.iter().map(|c| feed + c.len()).collect(),
                systems: systems.by_ref().take(count).collect(),
            };
            let names = self.bases(&chains)?.iter().map(Basis::names).collect();
            FittedSystems::new(dofs, forces, chains, names, self.noise_ratio(), &filters)
        };
        sets.into_iter().zip(counts).map(fit).collect()
    }

    /// The fit that is wanted, of those at the chosen poles: by least squares alone or, where constraints are asked for and
    /// bind, under them; with the search that led there and what the constraints cost.
    fn under_constraints(
        &'a self,
        mut chosen: Vec<EntryPoles>,
    ) -> Result<(
        FittedSystems<'a>,
        Vec<SearchReport>,
        Option<ConstraintReport>,
    )> {
        let (dofs, asked) = (&self.records.dofs, chosen.len() > 1);
        let requirements = self.fit.requirements(dofs, self.records.spanned_range()?)?;
        let mut fits = self.least_squares_at(&chosen)?.into_iter();
        let none = || Error::Numerical("fit to records: no fit".into());
        let mut found = fits.next().ok_or_else(none)?;
        let (reports, bases) = (found.reports()?, self.bases(&found.chains)?);
        let model = model_of(&self.fit.form, dofs, &reports)?;
        if asked {
            found.constrain(&bases, &requirements)?;
        }
        if found.active().is_none() {
            return Ok((found, chosen.swap_remove(0).1, None));
        }
        if let Some(other) = fits.next() {
            found = other;
            found.constrain(&self.bases(&found.chains)?, &requirements)?;
        }
        let active = found.active().unwrap_or_default();
        let with = found.reports()?;
        let constraints = ConstraintReport::new(active, dofs, &reports, &bases, &with, model);
        Ok((found, chosen.swap_remove(1).1, Some(constraints)))
    }

    fn bases(&self, chains: &[Vec<f64>]) -> Result<Vec<Basis>> {
        let form = &self.fit.form;
        chains.iter().map(|c| Basis::new(form, c)).collect()
    }

    /// Memory of the slowest chain against the rest, or what is discarded, before the motion.
    fn memory(&self, chains: &[Vec<f64>]) -> Result<Vec<MemoryReport>> {
        let memory_of = |record: &DimensionlessRecord| {
            let mut memory_samples = 0;
            for chain in chains {
                let own = FilterBank::new(chain.clone())?.memory(record.delta_s())?;
                memory_samples = memory_samples.max(own);
            }
            let discarded = (self.fit.discard_s / record.step_s).ceil() as usize;
            Ok(MemoryReport {
                record: record.header.name.to_owned(),
                memory_samples,
                available_samples: discarded.max(record.signals.still_samples()?),
                step_s: record.step_s,
            })
        };
        self.records.each.iter().map(memory_of).collect()
    }
}

#[cfg(test)]
mod tests;
