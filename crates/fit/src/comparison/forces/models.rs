//! Several models on one girder, in the time and the frequency domain (sections 3.5.5 and 3.5.6 of the thesis).

use super::entries::{DerivativeComparison, EntryComparison, compare_derivatives, compare_entries};
use super::options::{CompareOptions, TestedDeck};
use super::score::{Score, ScoreSummary, summaries};
use super::statements::{Statement, on_models};
use crate::aerodynamics::Transfer;
use crate::aerodynamics::derivatives::TransferSample;
use crate::error::{Error, Result};
use crate::identification::{
    Constraints, FitReport, Fitted, Form, FrequencyFit, FrequencyWeights, TimeFit, fit_discrete,
    fit_records, fit_table,
};
use crate::numbered::{OnDone, numbered};
use crate::section::Dof;
use crate::wind_tunnel::{Record, RecordSource};
use serde::Serialize;

/// Frequencies whose histories the thesis shows (Figures 3.29 to 3.32), Hz.
const SHOWN_HZ: [f64; 2] = [0.5, 2.0];
/// Filters of the thesis's model, which this program's is to have too.
const THESIS_FILTERS: usize = 3;
/// Periods of a history.
const SHOWN_PERIODS: f64 = 3.0;

/// A model that takes part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedModel {
    /// Name in tables and figures.
    pub name: String,
    /// The fit in words.
    pub method: String,
    /// Coefficients of one transfer function.
    pub coefficients: usize,
    /// Poles or lags, dimensionless; none for the discrete model.
    pub poles: Vec<f64>,
    /// Remarks of the fit.
    pub notes: Vec<String>,
}

/// A few periods of the forces due to one motion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct History {
    /// Motion.
    pub motion: Dof,
    /// Force.
    pub force: Dof,
    /// Frequency of the motion, Hz.
    pub frequency_hz: f64,
    /// Time from the start of the record, s.
    pub time_s: Vec<f64>,
    /// Measured force, N/m or N·m/m.
    pub measured: Vec<f64>,
    /// Predicted forces, one vector per model in the order of [`ModelsComparison::models`].
    pub predicted: Vec<Vec<f64>>,
}

/// Models of one deck side by side.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelsComparison {
    /// What was asked for.
    pub options: CompareOptions,
    /// Deck.
    pub deck: String,
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// The models: the thesis's two first.
    pub models: Vec<ComparedModel>,
    /// Transfer functions, row by row.
    pub entries: Vec<EntryComparison>,
    /// Derivatives.
    pub derivatives: Vec<DerivativeComparison>,
    /// One entry per model, motion, force and frequency.
    pub scores: Vec<Score>,
    /// Over the frequencies.
    pub summaries: Vec<ScoreSummary>,
    /// Histories at the frequencies that the thesis shows.
    pub histories: Vec<History>,
    /// What the thesis says, and what is found here.
    pub statements: Vec<Statement>,
}

/// Fits the thesis's discrete Laguerre model, its rational functions and the continuous Laguerre model of this program to
/// one deck at one speed, and compares them with what was measured. `progress` hears how many of how many records are done.
pub fn compare_models(options: &CompareOptions, progress: OnDone<'_>) -> Result<ModelsComparison> {
    let [name] = options.decks.as_slice() else {
        let found = options.decks.len().to_string();
        return Err(Error::input("decks", "one deck", found));
    };
    let deck = TestedDeck::new(name, options)?;
    let speed = deck.training_speed_m_s();
    let group = deck.table.at_speed_group(deck.training_group)?;
    let (records, sources) = (deck.training_records(), deck.training());
    let fits = fits(options, &sources, &group.samples(&options.dofs))?;
    let model = |(name, fitted): &(String, Fitted)| ComparedModel::new(name, &fitted.report);
    let models = fits
        .each_ref()
        .map(|(name, f)| (name.clone(), &f.model as &dyn Transfer));
    let each = |fit| records.iter().map(move |record| (fit, record));
    let trials: Vec<(&(String, Fitted), &Record)> = fits.iter().flat_map(each).collect();
    let outcomes = numbered(trials.len(), progress, |at| {
        let ((name, fitted), record) = trials[at];
        deck.scores(record, name, &fitted.model, false, options)
    })?;
    let (predicted, scores): (Vec<_>, Vec<_>) = outcomes.into_iter().unzip();
    let scores = scores.concat();
    let entries = compare_entries(&group, speed, &options.dofs, &models)?;
    Ok(ModelsComparison {
        deck: deck.table.name.clone(),
        speed_m_s: speed,
        derivatives: compare_derivatives(&group, &options.dofs, &models)?,
        histories: histories(&deck, records, &predicted),
        summaries: summaries(&scores),
        statements: on_models(&entries, &scores),
        models: fits.iter().map(model).collect(),
        entries,
        scores,
        options: options.clone(),
    })
}

/// The models, each with its name.
fn fits(
    options: &CompareOptions,
    sources: &[&dyn RecordSource],
    samples: &[TransferSample],
) -> Result<[(String, Fitted); 3]> {
    let discrete = fit_discrete(sources, &options.laguerre, &|_, _| ())?;
    let rational = fit_table(samples, &options.dofs, &thesis_rational_functions())?;
    let continuous = fit_records(sources, &with_feed_through(), &|_, _| ())?;
    Ok([
        (format!("Laguerre, {}", options.laguerre_name()), discrete),
        ("rational functions, one lag".to_owned(), rational),
        (
            format!("Laguerre with feed-through, L = {THESIS_FILTERS}"),
            continuous,
        ),
    ])
}

impl ComparedModel {
    fn new(name: &str, report: &FitReport) -> Self {
        let entry = report.entries.first();
        Self {
            name: name.to_owned(),
            method: report.method.clone(),
            coefficients: entry.map_or(0, |e| e.coefficients.len()),
            poles: entry.map_or_else(Vec::new, |e| e.poles.clone()),
            notes: report.notes.clone(),
        }
    }
}

/// This program's fit with the filters of the thesis: left to the data there would be more of them.
fn with_feed_through() -> TimeFit {
    TimeFit {
        form: Form::laguerre(THESIS_FILTERS),
        ..TimeFit::default()
    }
}

/// The thesis's fit of rational functions: one lag, no added mass, least squares on the derivatives, the lag searched.
fn thesis_rational_functions() -> FrequencyFit {
    FrequencyFit {
        form: Form::Rational {
            lags: 1,
            added_mass: false,
        },
        weights: FrequencyWeights::Derivatives,
        constraints: Constraints::None,
        ..FrequencyFit::default()
    }
}

/// `predicted` holds the forces of every model and record, model by model.
fn histories(deck: &TestedDeck, records: &[Record], predicted: &[Vec<Vec<f64>>]) -> Vec<History> {
    let mut all = Vec::new();
    for (r, record) in records.iter().enumerate() {
        let h = &record.header;
        for shown in SHOWN_HZ {
            let nearest = h.segments.iter().min_by(|a, b| {
                let distance = |f: f64| (f - shown).abs();
                distance(a.frequency_hz).total_cmp(&distance(b.frequency_hz))
            });
            let Some(segment) = nearest else { continue };
            let first = segment.start_s + deck.plan.ramp_s;
            let last = first + SHOWN_PERIODS / segment.frequency_hz;
            let samples = record.motion.first().map_or(0, Vec::len);
            let at = |t: f64| ((t * h.sampling_hz).round() as usize).min(samples);
            let range = at(first)..at(last);
            for (i, &force) in h.dofs.iter().enumerate() {
                let of_models = predicted.iter().skip(r).step_by(records.len().max(1));
                all.push(History {
                    motion: h.dofs[r],
                    force,
                    frequency_hz: segment.frequency_hz,
                    time_s: range.clone().map(|k| k as f64 / h.sampling_hz).collect(),
                    measured: record.force[i][range.clone()].to_vec(),
                    predicted: of_models.map(|f| f[i][range.clone()].to_vec()).collect(),
                });
            }
        }
    }
    all
}
