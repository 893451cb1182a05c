//! What is compared and how, and a deck as the virtual tunnel measures it.

use crate::aerodynamics::derivatives::DerivativeTable;
use crate::error::{Error, Result, positive};
use crate::files::derivatives::embedded;
use crate::identification::{DiscreteFit, sources};
use crate::section::Dof;
use crate::wind_tunnel::{Record, RecordSource, TunnelPlan};
use serde::{Deserialize, Serialize};

/// The four girders of Table 3.1 of the thesis.
pub const THESIS_DECKS: [&str; 4] = ["LN21-5200", "LN21-5500", "LN21-5800", "LN21-6100"];

/// How the metrics are taken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Scoring {
    /// Phase lag that brings the phase metric to 1/e, degrees of the frequency of the motion.
    pub significant_phase_deg: f64,
    /// The metrics see at most this much of the steady motion of a frequency, s: as many whole periods as fit.
    pub window_s: f64,
}

impl Default for Scoring {
    /// The 5° of the thesis; 12 s hold three periods of its lowest frequency.
    fn default() -> Self {
        Self {
            significant_phase_deg: 5.0,
            window_s: 12.0,
        }
    }
}

/// What is compared and how; the defaults are those of the thesis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CompareOptions {
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
    pub fn laguerre_name(&self) -> String {
        let DiscreteFit { filters, alpha, .. } = &self.laguerre;
        format!("L = {filters}, α = {alpha}")
    }
}

/// A deck, its records at all tested speeds, and the group of the speed for training.
pub(super) struct TestedDeck {
    pub(super) table: DerivativeTable,
    pub(super) plan: TunnelPlan,
    pub(super) speeds_m_s: Vec<f64>,
    pub(super) training_group: usize,
    pub(super) records: Vec<Record>,
}

impl TestedDeck {
    pub(super) fn new(name: &str, options: &CompareOptions) -> Result<Self> {
        let table = embedded::deck(name)?;
        positive("speed_m_s", options.speed_m_s)?;
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
    pub(super) fn training_speed_m_s(&self) -> f64 {
        self.speeds_m_s[self.training_group]
    }

    /// Records for training, one per motion.
    pub(super) fn training_records(&self) -> &[Record] {
        let motions = self.records.len() / self.speeds_m_s.len().max(1);
        &self.records[self.training_group * motions..][..motions]
    }

    pub(super) fn training(&self) -> Vec<&dyn RecordSource> {
        sources(self.training_records())
    }
}
