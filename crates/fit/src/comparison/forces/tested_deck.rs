//! A deck as the virtual tunnel measures it.

use super::options::CompareOptions;
use crate::aerodynamics::derivatives::DerivativeTable;
use crate::error::{Error, Result, positive};
use crate::files::derivatives::embedded;
use crate::wind_tunnel::{Record, RecordSource, TunnelPlan};

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
        let records = self.training_records().iter();
        records.map(|r| r as &dyn RecordSource).collect()
    }
}
