//! Continuous models fitted to forced-vibration records: [`fit_records`] has the steps.

use super::basis::{Basis, assemble};
use super::degenerate::note_lags;
use super::dissipative::{ConstraintReport, Wishes};
use super::form::Form;
use super::frequency_options::limits_by_entry;
use super::options::{TimeFit, TimeWeights};
use super::own::{EntryForm, StaticTerm, entry_forms};
use super::report::{
    EntryReport, FitReport, MemoryReport, OrderReport, SearchReport, StaticReport,
};
use super::time::filters::{ContinuousColumns, NOISE_BANDWIDTH};
use super::time::fitted::Fitted;
use super::time::pass::{ColumnOrder, OnProgress, Pass, PassPlan, pass};
use super::time::record::{DimensionlessRecord, read_all};
use super::time::search::{Choice, PASSES, choose_poles, padded};
use super::time::systems::ForceSystems;
use crate::aerodynamics::FilterBank;
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use crate::wind_tunnel::RecordSource;

/// Default cut-off of the low-pass over the sampling frequency.
const CUTOFF_OVER_SAMPLING: f64 = 1.0 / 20.0;

/// Fits a continuous model to records of any speeds and sampling frequencies.
///
/// The poles follow from a few passes over the records, each of which evaluates a whole grid of candidates; the last
/// pass fits the chosen ones to every sample.
///
/// # Errors
/// [`Error::Input`] for impossible options, records that do not fit together, are too short, contain numbers that are
/// not finite or do not move a degree of freedom; for poles per transfer function, records that move two at once.
pub fn fit_records(
    records: &[&dyn RecordSource],
    fit: &TimeFit,
    progress: OnProgress<'_>,
) -> Result<(Model, FitReport)> {
    fit.validate()?;
    let (dofs, mut records) = read_all(records)?;
    let means = removed_means(fit.static_term, &dofs, &mut records);
    let tested = tested_range(&records)?;
    let entries = entry_forms(&dofs, &fit.form, &fit.poles, &fit.own)?;
    let task = RecordFit {
        fit,
        dofs: &dofs,
        records: &records,
        entries: &entries,
        progress,
    };
    let wishes = wishes(fit, &dofs, tested)?;
    let (alone, held) = choose_poles(&task, tested, &wishes)?;
    let (at_poles, search, constraints) = task.fit_at(alone, held, &wishes)?;
    let model = at_poles.model()?;
    let mut report = FitReport {
        method: format!(
            "{}{}, fitted to {} record(s) in the time domain",
            fit.form.describe(),
            describe_own(fit.own.len()),
            records.len()
        ),
        weights: describe(fit.weights).into(),
        samples: at_poles.fitted.systems.whole(0).rows(),
        tested_range: tested,
        condition: 1.0,
        entries: at_poles.reports()?,
        search,
        orders: at_poles.orders(),
        alpha_guideline: None,
        static_terms: [means, at_poles.fitted.constants()?].concat(),
        memory: at_poles.memory()?,
        constraints,
        covariance_assumption:
            "noise of the forces is white before the low-pass, motions are exact, the poles count \
                                as known"
                .into(),
        notes: Vec::new(),
    };
    let conditions = report.entries.iter().map(|e| e.condition);
    report.condition = conditions.fold(1.0, f64::max);
    report.judge(&fit.poles);
    note_lags(&model, &mut report.notes);
    Ok((model, report))
}

/// Removes the means where that is asked for, and reports them.
pub(crate) fn removed_means(
    wanted: StaticTerm,
    dofs: &[Dof],
    records: &mut [DimensionlessRecord],
) -> Vec<StaticReport> {
    let mut reports = Vec::new();
    for record in records.iter_mut().filter(|_| wanted == StaticTerm::Removed) {
        for (value, &force) in record.remove_means().into_iter().zip(dofs) {
            reports.push(StaticReport {
                force,
                record: Some(record.name().to_owned()),
                value,
                standard_error: None,
            });
        }
    }
    reports
}

pub(crate) fn describe_own(count: usize) -> String {
    match count {
        0 => String::new(),
        n => format!(", filters of their own for {n} transfer function(s)"),
    }
}

/// Range of all records together.
///
/// # Errors
/// [`Error::Input`] for records that never move.
pub(crate) fn tested_range(records: &[DimensionlessRecord]) -> Result<ReducedFrequencyRange> {
    let ranges = records.iter().filter_map(DimensionlessRecord::tested_range);
    ReducedFrequencyRange::spanning(ranges.flat_map(|r| [r.min, r.max]))
        .ok_or_else(|| Error::input("records", "a motion", "none that moves"))
}

pub(crate) fn describe(weights: TimeWeights) -> &'static str {
    match weights {
        TimeWeights::None => "none: residuals of the dimensionless forces",
        TimeWeights::PerRecord => "1/RMS of each force in each record",
        TimeWeights::PerSegment => "1/RMS of each force in each segment",
    }
}

/// What a fit is asked for besides least squares.
///
/// # Errors
/// [`Error::Input`] for limits of degrees of freedom that are not there.
pub(crate) fn wishes(fit: &TimeFit, dofs: &[Dof], tested: ReducedFrequencyRange) -> Result<Wishes> {
    Ok(Wishes {
        dofs: dofs.to_vec(),
        k_max: tested.max.full_width(),
        constraints: fit.constraints,
        limits: limits_by_entry(dofs, &fit.limits)?,
    })
}

/// What stays the same over all passes of a fit.
pub(crate) struct RecordFit<'a> {
    pub fit: &'a TimeFit,
    pub dofs: &'a [Dof],
    pub records: &'a [DimensionlessRecord],
    /// Form and poles of every transfer function, row by row.
    pub entries: &'a [EntryForm],
    pub progress: OnProgress<'a>,
}

/// Which rows a pass makes.
#[derive(Clone, Copy)]
pub(crate) struct Rows {
    /// Columns of orthonormal filters in place of those of the model.
    pub orthonormal: bool,
    /// Only as many rows as the low-passed signals need.
    pub thinned: bool,
    /// As in [`PassPlan`].
    pub stretches: usize,
}

impl Rows {
    /// For a search of poles.
    pub(crate) const THINNED: Self = Self {
        orthonormal: true,
        thinned: true,
        stretches: 0,
    };
    /// For the fit itself.
    const ALL: Self = Self {
        orthonormal: false,
        thinned: false,
        stretches: 0,
    };
}

impl<'a> RecordFit<'a> {
    /// The last pass: least squares alone, and under the constraints where these are asked for and bind; with the search
    /// that led there and what the constraints cost.
    fn fit_at(
        &'a self,
        alone: Choice,
        held: Option<Choice>,
        wishes: &Wishes,
    ) -> Result<(AtPoles<'a>, Vec<SearchReport>, Option<ConstraintReport>)> {
        let chains = |choice: &Choice| -> Vec<Vec<f64>> {
            let pairs = choice.poles.iter().zip(self.entries);
            pairs.map(|(p, e)| e.form.expand(p)).collect()
        };
        let mut sets = vec![chains(&alone)];
        sets.extend(held.as_ref().map(chains));
        sets.dedup();
        let mut fits = self.at_poles(sets)?.into_iter();
        let none = || Error::Numerical("fit to records: no fit".into());
        let mut found = fits.next().ok_or_else(none)?;
        let (reports, model, bases) = (found.reports()?, found.model()?, found.bases()?);
        if held.is_some() {
            found.fitted.constrain(&bases, wishes)?;
        }
        let Some(held) = held.filter(|_| found.fitted.active().is_some()) else {
            return Ok((found, alone.search, None));
        };
        if let Some(other) = fits.next() {
            found = other;
            found.fitted.constrain(&found.bases()?, wishes)?;
        }
        let active = found.fitted.active().unwrap_or_default();
        let with = found.reports()?;
        let compared = (reports.as_slice(), bases.as_slice());
        let constraints = ConstraintReport::new(active, self.dofs, compared, &with, model);
        Ok((found, held.search, Some(constraints)))
    }

    /// One fit by least squares for each set of chains, from one pass.
    fn at_poles(&'a self, sets: Vec<Vec<Vec<f64>>>) -> Result<Vec<AtPoles<'a>>> {
        let feed = self.fit.form.feed_through().count();
        let longest = sets.iter().flatten().map(Vec::len).max().unwrap_or(0);
        let padded_row = |row: &[Vec<f64>]| row.iter().map(|c| padded(c, longest)).collect();
        let mut candidates: Vec<Vec<Vec<f64>>> = Vec::new();
        let mut counts = Vec::new();
        for chains in &sets {
            let mut of_force: Vec<_> = chains.chunks(self.dofs.len()).map(padded_row).collect();
            // filters that serve all forces are filtered once
            if of_force.iter().all(|row| *row == of_force[0]) {
                of_force.truncate(1);
            }
            counts.push(of_force.len());
            candidates.extend(of_force);
        }
        let pass = self.pass(&candidates, Rows::ALL, (PASSES, PASSES))?;
        let mut systems = pass.systems().into_iter();
        let fit = |(chains, count): (Vec<Vec<f64>>, usize)| {
            let systems = ForceSystems {
                counts: chains.iter().map(|c| feed + c.len()).collect(),
                systems: systems.by_ref().take(count).collect(),
            };
            let filters = self.fit.form.describe();
            Ok(AtPoles {
                task: self,
                chains,
                fitted: Fitted::new(self.dofs, systems, self.noise_ratio(), &filters)?,
                still_samples: pass.still_samples.clone(),
            })
        };
        sets.into_iter().zip(counts).map(fit).collect()
    }

    /// One pass with the given candidates, a chain of filters for each input, all of one length.
    pub(crate) fn pass(
        &self,
        candidates: &[Vec<Vec<f64>>],
        rows: Rows,
        number: (usize, usize),
    ) -> Result<Pass> {
        let basis = |poles: &Vec<f64>| {
            if rows.orthonormal {
                Basis::orthonormal(&self.fit.form, poles)
            } else {
                Basis::new(&self.fit.form, poles)
            }
        };
        let bases = candidates
            .iter()
            .map(|chains| chains.iter().map(basis).collect())
            .collect::<Result<Vec<Vec<_>>>>()?;
        let constant = self.fit.static_term == StaticTerm::Estimated;
        let plan = PassPlan {
            order: ColumnOrder {
                inputs: self.dofs.len(),
                per_input: bases.first().map_or(0, |b| b[0].len()),
                constant,
            },
            weights: self.fit.weights,
            delta_s: None,
            discard_s: self.fit.discard_s,
            stride: if rows.thinned { self.thinning() } else { 1 },
            stretches: rows.stretches,
            pass: number,
        };
        pass(self.records, &plan, self.progress, |record| {
            ContinuousColumns::new(record, &bases, self.cutoff_hz(record), constant)
        })
    }

    /// Cut-off of the low-pass, Hz.
    fn cutoff_hz(&self, record: &DimensionlessRecord) -> f64 {
        let default = CUTOFF_OVER_SAMPLING / record.step_s;
        self.fit.low_pass_hz.unwrap_or(default)
    }

    /// Every how many samples a row is enough: four rows a period of the cut-off still hold what the low-pass lets
    /// through.
    fn thinning(&self) -> usize {
        let stride = |r: &DimensionlessRecord| (0.25 / (self.cutoff_hz(r) * r.step_s)) as usize;
        self.records.iter().map(stride).min().unwrap_or(1).max(1)
    }

    /// Variance of the noise before the low-pass over that of the residuals behind it.
    fn noise_ratio(&self) -> f64 {
        let passed = |r: &DimensionlessRecord| 2.0 * NOISE_BANDWIDTH * self.cutoff_hz(r) * r.step_s;
        1.0 / self.records.iter().map(passed).fold(0.0, f64::max).min(1.0)
    }
}

/// A fit at given poles.
struct AtPoles<'a> {
    task: &'a RecordFit<'a>,
    /// Poles of the filters of every transfer function, row by row.
    chains: Vec<Vec<f64>>,
    fitted: Fitted<'a>,
    still_samples: Vec<usize>,
}

impl AtPoles<'_> {
    fn bases(&self) -> Result<Vec<Basis>> {
        let form = &self.task.fit.form;
        self.chains.iter().map(|c| Basis::new(form, c)).collect()
    }

    fn model(&self) -> Result<Model> {
        let n = self.task.dofs.len();
        let chains: Vec<_> = self.chains.chunks(n).map(<[_]>::to_vec).collect();
        let row = |i| (0..n).map(|j| self.fitted.values(i, j)).collect();
        let values: Vec<Vec<Vec<f64>>> = (0..n).map(row).collect();
        assemble(&self.task.fit.form, self.task.dofs, &chains, &values)
    }

    fn reports(&self) -> Result<Vec<EntryReport>> {
        self.fitted.reports(|e| {
            let basis = Basis::new(&self.task.fit.form, &self.chains[e])?;
            Ok((basis.names(), self.chains[e].clone()))
        })
    }

    /// Memory of the slowest chain against the rest, or what is discarded, before the motion.
    fn memory(&self) -> Result<Vec<MemoryReport>> {
        let account = |(record, still): (&DimensionlessRecord, &usize)| {
            let mut memory_samples = 0;
            for chain in &self.chains {
                let own = FilterBank::new(chain.clone())?.memory(record.delta_s())?;
                memory_samples = memory_samples.max(own);
            }
            let discarded = (self.task.fit.discard_s / record.step_s).ceil() as usize;
            Ok(MemoryReport {
                record: record.name().to_owned(),
                memory_samples,
                available_samples: discarded.max(*still),
                step_s: record.step_s,
            })
        };
        let each = self.task.records.iter().zip(&self.still_samples);
        each.map(account).collect()
    }

    /// Fewer filters (shared poles only).
    fn orders(&self) -> Vec<OrderReport> {
        let form = &self.task.fit.form;
        let shared = self.chains.iter().all(|c| *c == self.chains[0]);
        if !shared || matches!(form, Form::Rational { .. }) {
            return Vec::new();
        }
        self.fitted.orders(form.feed_through().count())
    }
}

#[cfg(test)]
mod tests;
