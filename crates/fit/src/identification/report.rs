//! What a fit tells about itself.

use super::dissipative::ConstraintReport;
use super::entry_report::EntryReport;
use super::form::{Form, PoleSearch};
use super::own::OwnFilters;
use crate::error::{Error, Result, ensure};
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use serde::{Deserialize, Serialize};

/// Terms this many times larger than their sum say that the fit lives on differences of large numbers.
pub(crate) const CANCELLATION_LIMIT: f64 = 30.0;
/// Scaled columns above this condition number leave fewer than half of the digits to the coefficients.
pub(crate) const CONDITION_LIMIT: f64 = 1e8;

/// A fitted model with the account of its fit.
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_fit::*; pub use aerodeck_lab::*; }
/// use aerodeck::files::derivatives::embedded;
/// use aerodeck::identification::{Fitted, FrequencyFit, fit_table};
/// use aerodeck::section::Dof;
///
/// let table = embedded::deck("LN21-5200")?;
/// let Fitted { model, report } = fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &FrequencyFit::default())?;
/// assert_eq!(model.kind(), "continuous Laguerre");
/// assert_eq!(report.entries.len(), 4);
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Fitted {
    /// The model.
    pub model: Model,
    /// How it was fitted, and how well.
    pub report: FitReport,
}

/// Account of one fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitReport {
    /// What was fitted, in words.
    pub method: String,
    /// What the residuals were weighted with, in words.
    pub weights: String,
    /// Real numbers (parts of table entries, or rows of records) that entered the least squares.
    pub samples: usize,
    /// Reduced frequencies at which the data have every force in every motion.
    pub tested_range: ReducedFrequencyRange,
    /// Largest condition number of the columns, each scaled to unit norm.
    pub condition: f64,
    /// One account per transfer function, row by row.
    pub entries: Vec<EntryReport>,
    /// Searches of the poles; empty when they were given.
    pub search: Vec<SearchReport>,
    /// Fits with fewer filters and the same poles (time domain, from the same factorisation).
    pub orders: Vec<OrderReport>,
    /// The guideline for `α` (2.36), for the discrete model.
    pub alpha_guideline: Option<AlphaGuideline>,
    /// The constant part of the forces, as far as the fit dealt with it; empty when it did not.
    pub static_terms: Vec<StaticReport>,
    /// Memory of the filters against the rest before the motion starts, one account per record; empty for fits to a table.
    pub memory: Vec<MemoryReport>,
    /// What held the fit back; `None` when nothing did, or when nothing was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub constraints: Option<ConstraintReport>,
    /// Under which assumption standard errors and covariances hold.
    pub covariance_assumption: String,
    /// What a user of the model should know.
    pub notes: Vec<String>,
}

/// The constant part of one force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StaticReport {
    /// Force.
    pub force: Dof,
    /// Record whose mean was removed; `None` for a constant estimated from all records.
    pub record: Option<String>,
    /// The constant, dimensionless as the forces.
    pub value: f64,
    /// Standard error of an estimated constant; `None` when there are no residual degrees of freedom, and for a mean.
    pub standard_error: Option<f64>,
}

/// Whether a record is at rest for longer than the filters remember (thesis, section 3.3): otherwise forces of a motion
/// before the record enter the fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MemoryReport {
    /// Name of the record.
    pub record: String,
    /// Memory of the slowest filters in samples of the fit, see `discrete_memory`.
    pub memory_samples: usize,
    /// Samples before the motion starts, or before the first row of the fit when that is later.
    pub available_samples: usize,
    /// Sampling step of the fit in this record, s.
    pub step_s: f64,
}

/// The search of one set of poles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SearchReport {
    /// Transfer function (force, motion) it belongs to; `None` when the poles are shared by all.
    pub entry: Option<(Dof, Dof)>,
    /// Force whose entries share it, when every force has poles of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<Dof>,
    /// Lower bound.
    pub min: f64,
    /// Upper bound.
    pub max: f64,
    /// Points of the grid and of the refinement, in the order of evaluation.
    pub points: Vec<SearchPoint>,
    /// What was chosen.
    pub chosen: SearchPoint,
}

/// One evaluated point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SearchPoint {
    /// Free poles, dimensionless.
    pub poles: Vec<f64>,
    /// Root mean square of the relative weighted residuals of the entries (weighted residual over weighted data of each).
    pub objective: f64,
}

/// Fit with fewer filters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OrderReport {
    /// Number of filters `L`.
    pub filters: usize,
    /// As in [`SearchPoint::objective`].
    pub objective: f64,
}

/// Guideline (2.36) for the decay factor of the discrete model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AlphaGuideline {
    /// `α` in use.
    pub alpha: f64,
    /// Lower bound of (2.36).
    pub lower_bound: f64,
    /// Highest frequency of the motion, Hz, at the highest speed.
    pub highest_frequency_hz: f64,
    /// Sampling frequency of the model, Hz, at that speed.
    pub sampling_hz: f64,
}

impl FitReport {
    /// The account of these transfer functions and of the search of their poles, for a fit to say the rest.
    pub(super) fn new(
        tested_range: ReducedFrequencyRange,
        entries: Vec<EntryReport>,
        search: Vec<SearchReport>,
    ) -> Self {
        Self {
            method: String::new(),
            weights: String::new(),
            samples: 0,
            tested_range,
            condition: entries.iter().map(|e| e.condition).fold(1.0, f64::max),
            entries,
            search,
            orders: Vec::new(),
            alpha_guideline: None,
            static_terms: Vec::new(),
            memory: Vec::new(),
            constraints: None,
            covariance_assumption: String::new(),
            notes: Vec::new(),
        }
    }

    /// How well the data tell the coefficients apart, in words.
    pub fn condition_in_words(&self) -> String {
        format!(
            "condition number {:.0}: errors of the data may grow so much in single coefficients, not in the forces",
            self.condition
        )
    }

    /// The form that was asked for, with the number of filters that the fit has chosen where it was left open and no force has
    /// filters of its own.
    pub(crate) fn form_fitted(&self, asked: &Form, own: &[OwnFilters]) -> Form {
        let first = self.entries.first();
        let first = first.filter(|_| own.is_empty() && asked.is_open());
        let fitted = first.and_then(|entry| asked.with_filters(entry.poles.len()));
        fitted.unwrap_or_else(|| asked.clone())
    }

    /// Adds the notes that follow from the numbers: poles at their bounds, cancelling terms, bad conditioning.
    pub(crate) fn judge(&mut self, poles: &PoleSearch) {
        let notes = &mut self.notes;
        // whether nothing before the record is remembered when the motion starts
        let sufficient = |m: &&MemoryReport| m.available_samples >= m.memory_samples;
        for memory in self.memory.iter().filter(|m| !sufficient(m)) {
            let (own, rest) = (memory.memory_samples, memory.available_samples);
            notes.push(format!(
                "record {}: the filters remember {own} samples ({:.2} s), but the motion starts after {rest} ({:.2} s): forces of \
                 a motion before the record may have entered the fit; record more rest, or discard_s",
                memory.record,
                own as f64 * memory.step_s,
                rest as f64 * memory.step_s,
            ));
        }
        for search in &self.search {
            search.judge(poles.min_ratio, notes);
        }
        for entry in &self.entries {
            let (force, motion) = (entry.force.name(), entry.motion.name());
            let name = format!("{force} force due to {motion} motion");
            if entry.cancellation > CANCELLATION_LIMIT {
                notes.push(format!(
                    "{name}: coefficients cancel (the largest term is {:.0} times the fit): over-fitted, use fewer \
                     filters or poles further apart",
                    entry.cancellation
                ));
            }
            if entry.condition > CONDITION_LIMIT {
                notes.push(format!(
                    "{name}: ill-conditioned columns (condition number {:.1e})",
                    entry.condition
                ));
            }
        }
    }
}

impl SearchReport {
    /// Of one that ended at the best of its points, between these bounds.
    ///
    /// # Errors
    /// [`Error::Numerical`] when no point has a finite objective.
    pub(super) fn new(
        entry: Option<(Dof, Dof)>,
        [min, max]: [f64; 2],
        points: Vec<SearchPoint>,
    ) -> Result<Self> {
        Ok(Self {
            entry,
            force: None,
            min,
            max,
            chosen: best_of(&points)?,
            points,
        })
    }

    fn judge(&self, min_ratio: f64, notes: &mut Vec<String>) {
        let whose = match (self.entry, self.force) {
            (Some((f, m)), _) => format!("{} force due to {} motion: ", f.name(), m.name()),
            (None, Some(f)) => format!("{} force: ", f.name()),
            (None, None) => String::new(),
        };
        let poles = self.chosen.poles.iter();
        for (bound, value) in [("lower", self.min), ("upper", self.max)] {
            let near = |p: &&f64| (*p / value).ln().abs() < 0.01;
            if let Some(p) = poles.clone().find(near) {
                notes.push(format!(
                    "{whose}the pole {p:.4} lies at its {bound} bound: the data do not determine it"
                ));
            }
        }
        for pair in self.chosen.poles.windows(2) {
            if pair[1] / pair[0] < 1.01 * min_ratio {
                notes.push(format!(
                    "{whose}the poles {:.4} and {:.4} are held apart by the least ratio {min_ratio}: fewer of them \
                     would fit as well",
                    pair[0], pair[1]
                ));
            }
        }
    }
}

/// The point with the smallest objective.
pub(super) fn best_of(points: &[SearchPoint]) -> Result<SearchPoint> {
    let finite = points.iter().filter(|p| p.objective.is_finite());
    let best = finite.min_by(|a, b| a.objective.total_cmp(&b.objective));
    let none = || Error::Numerical("pole search: no point has a finite objective".into());
    best.cloned().ok_or_else(none)
}

/// A degree-of-freedom count that leaves something to estimate the variance from.
pub(crate) fn variance(residual_sum: f64, rows: usize, unknowns: usize) -> Option<f64> {
    (rows > unknowns).then(|| residual_sum / (rows - unknowns) as f64)
}

/// Relative scatter below which no measurement is known: what is left of a better fit is not told from the form of the model.
pub(crate) const LEAST_NOISE: f64 = 0.01;

/// Root mean square of the noise of weighted data, relative to the data, from the sum of the squares of `rows` residuals after
/// `unknowns` coefficients were fitted to them; one where that leaves nothing to judge by.
pub(crate) fn relative_noise(
    residual_sum: f64,
    total_sum: f64,
    rows: usize,
    unknowns: usize,
) -> f64 {
    let relative = |v: f64| (v * rows as f64 / total_sum).sqrt().max(LEAST_NOISE);
    match variance(residual_sum, rows, unknowns) {
        Some(v) if total_sum > 0.0 => relative(v),
        _ => 1.0,
    }
}

/// Fewer equations than unknowns cannot be fitted.
pub(crate) fn enough_rows(place: &str, rows: usize, unknowns: usize) -> Result<()> {
    ensure(
        rows >= unknowns,
        place,
        format_args!("at least {unknowns} numbers for {unknowns} coefficients"),
        rows,
    )
}
