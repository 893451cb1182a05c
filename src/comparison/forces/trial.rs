//! One model asked for the forces of one record, compared with those measured, frequency by frequency.

use super::score::Score;
use super::{CompareOptions, TestedDeck};
use crate::error::Result;
use crate::trained_model::Model;
use crate::wind_tunnel::{Record, predicted_forces};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A model and a record.
pub(super) struct Trial<'a> {
    pub(super) deck: &'a TestedDeck,
    pub(super) record: &'a Record,
    /// Name of the model in the results.
    pub(super) name: &'a str,
    pub(super) model: &'a Model,
    /// Whether the model was not trained on this record.
    pub(super) held_out: bool,
}

/// What a model predicts for a record.
pub(super) struct Outcome {
    /// One vector a force, one number a sample.
    pub(super) predicted: Vec<Vec<f64>>,
    /// One entry a force and frequency.
    pub(super) scores: Vec<Score>,
}

/// The outcomes in the order of the trials. `progress` hears how many of how many are done.
pub(super) fn run_all(
    trials: &[Trial<'_>],
    options: &CompareOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Vec<Outcome>> {
    let done = AtomicUsize::new(0);
    trials
        .par_iter()
        .map(|trial| {
            let outcome = trial.run(options);
            progress(1 + done.fetch_add(1, Ordering::Relaxed), trials.len());
            outcome
        })
        .collect()
}

impl Trial<'_> {
    fn run(&self, options: &CompareOptions) -> Result<Outcome> {
        let record = self.record;
        let predicted = predicted_forces(self.model, record)?;
        let h = &record.header;
        let moves = |m: &Vec<f64>| m.iter().any(|x| *x != 0.0);
        let moving = record.motion.iter().position(moves).unwrap_or(0);
        let mut scores = Vec::new();
        for (i, &force) in h.dofs.iter().enumerate() {
            for segment in &h.segments {
                let ramp_s = self.deck.plan.ramp_s;
                let (from, to) = options.scoring.window(record, segment, ramp_s)?;
                let metrics = options.scoring.metrics(
                    &record.force[i][from..to],
                    &predicted[i][from..to],
                    h.sampling_hz,
                    segment.frequency_hz,
                )?;
                scores.push(Score {
                    deck: self.deck.table.name.clone(),
                    model: self.name.to_owned(),
                    speed_m_s: h.mean_speed_m_s,
                    held_out: self.held_out,
                    motion: h.dofs[moving],
                    force,
                    frequency_hz: segment.frequency_hz,
                    metrics,
                });
            }
        }
        Ok(Outcome { predicted, scores })
    }
}
