//! One model on several girders (section 3.5.4 of the thesis).

use super::score::{Score, ScoreSummary, summaries};
use super::statements::{Statement, on_decks};
use super::{CompareOptions, TestedDeck};
use crate::error::{Error, Result};
use crate::identification::fit_discrete;
use crate::trained_model::Model;
use crate::wind_tunnel::{Record, RecordSource, predicted_forces};
use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What was done on one deck.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeckAccount {
    /// Deck.
    pub deck: String,
    /// Width of the section model, m.
    pub width_m: f64,
    /// Tested speeds, m/s.
    pub speeds_m_s: Vec<f64>,
    /// Deck and speed (m/s) at which the model was trained.
    pub trained_on: (String, f64),
    /// The fit in words.
    pub method: String,
    /// Remarks of the fit.
    pub notes: Vec<String>,
}

/// Predicted against measured forces of several decks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DecksComparison {
    /// What was asked for.
    pub options: CompareOptions,
    /// The decks.
    pub decks: Vec<DeckAccount>,
    /// One entry a deck, speed, motion, force and frequency.
    pub scores: Vec<Score>,
    /// Over the frequencies.
    pub summaries: Vec<ScoreSummary>,
    /// What the thesis says, and what is found here.
    pub statements: Vec<Statement>,
}

/// Trains the discrete Laguerre model on the records of one speed, predicts the forces of every record of every deck, and
/// compares them frequency by frequency. `progress` hears how many of how many records are done.
///
/// # Errors
/// [`Error::Input`] for unknown decks and impossible options; those of fits and metrics.
pub fn compare_decks(
    options: &CompareOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<DecksComparison> {
    if options.decks.is_empty() {
        return Err(Error::input("decks", "at least one", "none"));
    }
    let teacher = match &options.trained_on {
        Some(name) => Some(train(&TestedDeck::new(name, options)?, options)?),
        None => None,
    };
    let mut decks = Vec::with_capacity(options.decks.len());
    for name in &options.decks {
        let deck = TestedDeck::new(name, options)?;
        let trained = match &teacher {
            Some(teacher) => teacher.clone(),
            None => train(&deck, options)?,
        };
        decks.push((deck, trained));
    }
    let records: Vec<(&TestedDeck, &Trained, &Record)> = decks
        .iter()
        .flat_map(|(d, t)| d.records.iter().map(move |r| (d, t, r)))
        .collect();
    let done = AtomicUsize::new(0);
    let scores = records
        .par_iter()
        .map(|(deck, trained, record)| {
            let scores = score_record(deck, trained, record, options);
            progress(1 + done.fetch_add(1, Ordering::Relaxed), records.len());
            scores
        })
        .collect::<Result<Vec<_>>>()?
        .concat();
    Ok(DecksComparison {
        decks: decks.iter().map(|(d, t)| t.account(d)).collect(),
        summaries: summaries(&scores),
        statements: on_decks(&scores),
        options: options.clone(),
        scores,
    })
}

/// A model and where it comes from.
#[derive(Clone)]
struct Trained {
    deck: String,
    speed_m_s: f64,
    model: Model,
    method: String,
    notes: Vec<String>,
}

impl Trained {
    fn account(&self, deck: &TestedDeck) -> DeckAccount {
        DeckAccount {
            deck: deck.table.name.clone(),
            width_m: deck.table.width_m,
            speeds_m_s: deck.speeds_m_s.clone(),
            trained_on: (self.deck.clone(), self.speed_m_s),
            method: self.method.clone(),
            notes: self.notes.clone(),
        }
    }
}

fn train(deck: &TestedDeck, options: &CompareOptions) -> Result<Trained> {
    let records = deck.at_speed(deck.training_group);
    let sources: Vec<&dyn RecordSource> = records.iter().map(|r| r as &dyn RecordSource).collect();
    let (model, report) = fit_discrete(&sources, &options.laguerre, &|_| ())?;
    Ok(Trained {
        deck: deck.table.name.clone(),
        speed_m_s: deck.speeds_m_s[deck.training_group],
        model,
        method: report.method,
        notes: report.notes,
    })
}

fn score_record(
    deck: &TestedDeck,
    trained: &Trained,
    record: &Record,
    options: &CompareOptions,
) -> Result<Vec<Score>> {
    let predicted = predicted_forces(&trained.model, record)?;
    let speed = record.header.mean_speed_m_s;
    let name = format!(
        "L = {}, α = {}",
        options.laguerre.filters, options.laguerre.alpha
    );
    let held_out = trained.deck != deck.table.name || speed != trained.speed_m_s;
    score_forces(
        (&deck.table.name, &name, held_out),
        deck.plan.ramp_s,
        record,
        &predicted,
        options,
    )
}

/// Scores of every force at every frequency of one record.
pub(super) fn score_forces(
    (deck, model, held_out): (&str, &str, bool),
    ramp_s: f64,
    record: &Record,
    predicted: &[Vec<f64>],
    options: &CompareOptions,
) -> Result<Vec<Score>> {
    let h = &record.header;
    let moves = |m: &Vec<f64>| m.iter().any(|x| *x != 0.0);
    let moving = record.motion.iter().position(moves).unwrap_or(0);
    let mut scores = Vec::new();
    for (i, &force) in h.dofs.iter().enumerate() {
        for segment in &h.segments {
            let (from, to) = options.scoring.window(record, segment, ramp_s)?;
            let metrics = options.scoring.metrics(
                &record.force[i][from..to],
                &predicted[i][from..to],
                h.sampling_hz,
                segment.frequency_hz,
            )?;
            scores.push(Score {
                deck: deck.to_owned(),
                model: model.to_owned(),
                speed_m_s: h.mean_speed_m_s,
                held_out,
                motion: h.dofs[moving],
                force,
                frequency_hz: segment.frequency_hz,
                metrics,
            });
        }
    }
    Ok(scores)
}
