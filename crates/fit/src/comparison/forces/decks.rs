//! One model on several girders (section 3.5.4 of the thesis).

use super::options::{CompareOptions, TestedDeck};
use super::score::{Score, ScoreSummary, summaries};
use super::statements::{Statement, on_decks};
use crate::error::{Result, ensure};
use crate::identification::{Fitted, fit_discrete};
use crate::numbered::{OnDone, numbered};
use serde::Serialize;

/// What was done on one deck.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TestedDeckScores {
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
    pub decks: Vec<TestedDeckScores>,
    /// One entry per deck, speed, motion, force and frequency.
    pub scores: Vec<Score>,
    /// Over the frequencies.
    pub summaries: Vec<ScoreSummary>,
    /// What the thesis says, and what is found here.
    pub statements: Vec<Statement>,
}

/// Trains the discrete Laguerre model on the records of one speed, predicts the forces of every record of every deck, and
/// compares them frequency by frequency. `progress` hears how many of how many records are done.
pub fn compare_decks(options: &CompareOptions, progress: OnDone<'_>) -> Result<DecksComparison> {
    ensure(!options.decks.is_empty(), "decks", "at least one", "none")?;
    // deck and speed of the training, and the fit
    let train = |deck: &TestedDeck| -> Result<((String, f64), Fitted)> {
        let fitted = fit_discrete(&deck.training(), &options.laguerre, &|_, _| ())?;
        Ok(((deck.table.name.clone(), deck.training_speed_m_s()), fitted))
    };
    let teacher = options.trained_on.as_ref();
    let teacher = teacher.map(|name| train(&TestedDeck::new(name, options)?));
    let teacher = teacher.transpose()?;
    let trained = |name: &String| {
        let deck = TestedDeck::new(name, options)?;
        let by = teacher.clone().map_or_else(|| train(&deck), Ok)?;
        Ok((deck, by))
    };
    let decks = options.decks.iter().map(trained);
    let decks = decks.collect::<Result<Vec<_>>>()?;
    let name = options.laguerre_name();
    let mut trials = Vec::new();
    for (deck, trained) in &decks {
        trials.extend(deck.records.iter().map(|record| (deck, record, trained)));
    }
    let outcomes = numbered(trials.len(), progress, |at| {
        let (deck, record, ((trained_on, speed_m_s), fitted)) = &trials[at];
        let held_out = *trained_on != deck.table.name || *speed_m_s != record.header.mean_speed_m_s;
        deck.scores(record, &name, &fitted.model, held_out, options)
    })?;
    let scores: Vec<Score> = outcomes.into_iter().flat_map(|(_, s)| s).collect();
    let scores_of = |(deck, (trained_on, fitted)): (TestedDeck, (_, Fitted))| TestedDeckScores {
        deck: deck.table.name,
        width_m: deck.table.width_m,
        speeds_m_s: deck.speeds_m_s,
        trained_on,
        method: fitted.report.method,
        notes: fitted.report.notes,
    };
    Ok(DecksComparison {
        decks: decks.into_iter().map(scores_of).collect(),
        summaries: summaries(&scores),
        statements: on_decks(&scores),
        options: options.clone(),
        scores,
    })
}
