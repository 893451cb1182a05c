//! One model on several girders (section 3.5.4 of the thesis).

use super::options::CompareOptions;
use super::score::{ModelOnRecord, Score, ScoreSummary, run_all, summaries};
use super::statements::{Statement, on_decks};
use super::tested_deck::TestedDeck;
use crate::error::{Result, ensure};
use crate::identification::{FitReport, Fitted, fit_discrete};
use crate::numbered::OnDone;
use crate::trained_model::Model;
use crate::wind_tunnel::Record;
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
    let teacher = options.trained_on.as_ref();
    let teacher = teacher.map(|name| Trained::new(&TestedDeck::new(name, options)?, options));
    let teacher = teacher.transpose()?;
    let mut decks = Vec::with_capacity(options.decks.len());
    for name in &options.decks {
        let deck = TestedDeck::new(name, options)?;
        let trained = match &teacher {
            Some(teacher) => teacher.clone(),
            None => Trained::new(&deck, options)?,
        };
        decks.push((deck, trained));
    }
    let name = options.laguerre_name();
    let trials: Vec<ModelOnRecord<'_>> = decks
        .iter()
        .flat_map(|(deck, trained)| {
            deck.records.iter().map(|record| ModelOnRecord {
                deck,
                record,
                name: &name,
                model: &trained.model,
                held_out: trained.held_out(deck, record),
            })
        })
        .collect();
    let outcomes = run_all(&trials, options, progress)?;
    let scores: Vec<Score> = outcomes.into_iter().flat_map(|o| o.scores).collect();
    Ok(DecksComparison {
        decks: decks.into_iter().map(|(d, t)| t.scores_of(d)).collect(),
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
    report: FitReport,
}

impl Trained {
    fn new(deck: &TestedDeck, options: &CompareOptions) -> Result<Self> {
        let Fitted { model, report } = fit_discrete(&deck.training(), &options.laguerre, &|_| ())?;
        Ok(Self {
            deck: deck.table.name.clone(),
            speed_m_s: deck.training_speed_m_s(),
            model,
            report,
        })
    }

    fn held_out(&self, deck: &TestedDeck, record: &Record) -> bool {
        self.deck != deck.table.name || self.speed_m_s != record.header.mean_speed_m_s
    }

    fn scores_of(self, deck: TestedDeck) -> TestedDeckScores {
        TestedDeckScores {
            deck: deck.table.name,
            width_m: deck.table.width_m,
            speeds_m_s: deck.speeds_m_s,
            trained_on: (self.deck, self.speed_m_s),
            method: self.report.method,
            notes: self.report.notes,
        }
    }
}
