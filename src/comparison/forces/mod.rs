//! The comparisons of chapter 3 of the thesis on the embedded decks: one model on several girders (section 3.5.4), and
//! several models on one girder (sections 3.5.5 and 3.5.6).
//!
//! The decks come as derivatives, so that the "measured" forces are those of the virtual tunnel at the test points: exactly
//! the measured derivatives, without the noise, drift and knocks of the thesis's records. What the metrics see here is the
//! model alone.

mod decks;
mod entries;
mod models;
mod score;
mod statements;

pub(crate) use decks::{DecksComparison, compare_decks};
pub use entries::inside;
pub(crate) use models::{History, ModelsComparison, compare_models};
pub(crate) use score::{ForceMetrics, Score, ScoreSummary, Scoring, score_table};
pub(crate) use statements::Statement;

use crate::aerodynamics::derivatives::DerivativeTable;
use crate::error::{Error, Result};
use crate::files::derivatives::embedded;
use crate::identification::{Constraints, DiscreteFit, Form, FrequencyFit, FrequencyWeights};
use crate::section::Dof;
use crate::wind_tunnel::{Record, RecordSource, TunnelPlan};
use serde::{Deserialize, Serialize};

/// The four girders of Table 3.1 of the thesis.
pub(crate) const THESIS_DECKS: [&str; 4] = ["LN21-5200", "LN21-5500", "LN21-5800", "LN21-6100"];

/// Called with the records that are done and all of them, from any thread.
pub(crate) type OnRecords<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// What is compared and how; the defaults are those of the thesis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct CompareOptions {
    /// Embedded decks.
    pub decks: Vec<String>,
    /// Deck whose model predicts the forces of all; left out, each deck has its own.
    pub trained_on: Option<String>,
    /// Models are trained at the tested speed nearest to this one, m/s.
    pub speed_m_s: f64,
    /// Degrees of freedom of motions and forces.
    pub dofs: Vec<Dof>,
    /// The discrete Laguerre model.
    pub laguerre: DiscreteFit,
    /// Standard deviation of the noise of each force over its RMS; it is not filtered out.
    pub noise_fraction: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// The metrics.
    pub scoring: Scoring,
}

impl Default for CompareOptions {
    fn default() -> Self {
        Self {
            decks: THESIS_DECKS.map(str::to_owned).to_vec(),
            trained_on: None,
            speed_m_s: 8.0,
            dofs: Dof::TWO.to_vec(),
            laguerre: DiscreteFit::default(),
            noise_fraction: 0.0,
            seed: 1,
            scoring: Scoring::default(),
        }
    }
}

impl CompareOptions {
    /// The discrete Laguerre model in a few letters.
    pub(crate) fn laguerre_name(&self) -> String {
        let DiscreteFit { filters, alpha, .. } = &self.laguerre;
        format!("L = {filters}, α = {alpha}")
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

/// A deck, its records at all tested speeds, and the group of the speed for training.
struct TestedDeck {
    table: DerivativeTable,
    plan: TunnelPlan,
    speeds_m_s: Vec<f64>,
    training_group: usize,
    records: Vec<Record>,
}

impl TestedDeck {
    fn new(name: &str, options: &CompareOptions) -> Result<Self> {
        let table = embedded::deck(name)?;
        let plan = TunnelPlan {
            noise_fraction: options.noise_fraction,
            seed: options.seed,
            ..TunnelPlan::default()
        };
        let speeds = table.speed_groups();
        let distance = |v: f64| (v - options.speed_m_s).abs();
        let nearest = (0..speeds.len())
            .min_by(|a, b| distance(speeds[*a]).total_cmp(&distance(speeds[*b])))
            .ok_or_else(|| Error::input(format!("deck {name}"), "tested speeds", "none"))?;
        Ok(Self {
            records: plan.records_from_table(&table, &options.dofs)?,
            plan,
            speeds_m_s: speeds,
            training_group: nearest,
            table,
        })
    }

    /// Mean wind speed of the records for training, m/s.
    fn training_speed_m_s(&self) -> f64 {
        self.speeds_m_s[self.training_group]
    }

    /// Records for training, one a motion.
    fn training_records(&self) -> &[Record] {
        let motions = self.records.len() / self.speeds_m_s.len().max(1);
        &self.records[self.training_group * motions..][..motions]
    }

    fn training(&self) -> Vec<&dyn RecordSource> {
        let records = self.training_records().iter();
        records.map(|r| r as &dyn RecordSource).collect()
    }
}

#[cfg(test)]
mod tests;
