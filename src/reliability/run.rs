//! All samples, over all cores.

use super::coefficients;
use super::drawn::drawn_model;
use super::plan::MonteCarloPlan;
use super::results::{MonteCarloResult, Tally};
use super::sampler::{Sample, Sampler};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::{
    FlutterSearch, OnsetSearch, OnsetSweep, SweepOutcome, SweptOnset, find_onset,
};
use crate::section::SectionModel;
use crate::trained_model::{Model, TrainedModel};
use rayon::prelude::*;

/// Samples between two reports of progress, on one core.
const CHUNK: usize = 2048;
/// Wind speeds of the search by eigenvalues.
const SPEEDS: usize = 200;

/// Called with the samples done and all of them, from any thread.
pub(crate) type OnSamples<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// Finds the onset of one sample.
pub(super) struct Finder<'a> {
    model: &'a TrainedModel,
    /// For continuous models.
    sweep: Option<OnsetSweep>,
    search: OnsetSearch,
}

/// Draws all samples of a plan and finds their onsets.
///
/// Continuous models go through [`OnsetSweep`]; what that does not resolve, and sampled models, through
/// [`find_onset`]. The result does not depend on the number of threads.
///
/// # Errors
/// [`crate::Error::Input`] naming the key of the plan that does not fit the model. Samples that fail are counted and named.
pub fn monte_carlo(
    plan: &MonteCarloPlan,
    model: &TrainedModel,
    progress: OnSamples<'_>,
) -> Result<MonteCarloResult> {
    plan.validate()?;
    let limit = plan
        .speed_max_m_s
        .unwrap_or(model.experiment.onset_search_limit_m_s);
    plan.check_design_speed(limit)?;
    let (drawn, covariance) = drawn_model(plan, model)?;
    let model = &TrainedModel {
        model: drawn,
        ..model.clone()
    };
    let finder = Finder::new(model, limit)?;
    let (values, _) = coefficients::of(&model.model);
    let sampler = Sampler::new(plan, &model.section, (&values, covariance))?;
    let nominal = finder.onset(&model.section, &values)?.0;
    let chunks = plan.samples.div_ceil(CHUNK);
    let done = std::sync::atomic::AtomicUsize::new(0);
    let tallies: Vec<Tally> = (0..chunks)
        .into_par_iter()
        .map(|chunk| {
            let range = chunk * CHUNK..plan.samples.min((chunk + 1) * CHUNK);
            let count = range.len();
            // who wants no more need not wait for what has not begun
            progress(
                done.load(std::sync::atomic::Ordering::Relaxed),
                plan.samples,
            );
            let tally = finder.tally(&sampler, range);
            let before = done.fetch_add(count, std::sync::atomic::Ordering::Relaxed);
            progress(before + count, plan.samples);
            tally
        })
        .collect();
    let mut total = Tally::default();
    for tally in tallies {
        total.add(tally);
    }
    Ok(total.summarise(plan, limit, &model.name, nominal))
}

impl<'a> Finder<'a> {
    pub(super) fn new(model: &'a TrainedModel, speed_max_m_s: f64) -> Result<Self> {
        let sweep = coefficients::linear(&model.model, model.tested_range)
            .map(|forces| OnsetSweep::new(forces, &model.section.structure()?, speed_max_m_s))
            .transpose()?;
        Ok(Self {
            model,
            sweep,
            search: OnsetSearch {
                speed_max_m_s,
                speeds: SPEEDS,
            },
        })
    }

    fn tally(&self, sampler: &Sampler, samples: std::ops::Range<usize>) -> Tally {
        let mut tally = Tally::default();
        let mut sample: Sample = sampler.empty();
        for index in samples {
            sampler.draw(index as u64, &mut sample);
            match self.onset(&sample.section, &sample.coefficients) {
                Ok((onset, in_full)) => {
                    tally.in_full += usize::from(in_full);
                    match onset {
                        SweepOutcome::Onset(onset) => tally.onset(&onset),
                        SweepOutcome::UnstableAtOrBelow(start) => tally.unstable(&start),
                        SweepOutcome::Stable => tally.stable += 1,
                        SweepOutcome::Unresolved => {
                            tally.failure(index, "its modes cannot be resolved".to_owned());
                        }
                    }
                }
                Err(error) => tally.failure(index, error.to_string()),
            }
        }
        tally
    }

    /// The answer, and whether it took the search by eigenvalues.
    pub(super) fn onset(
        &self,
        section: &SectionModel,
        values: &[f64],
    ) -> Result<(SweepOutcome, bool)> {
        if let Some(sweep) = &self.sweep {
            let outcome = sweep.onset(section, values)?;
            if outcome != SweepOutcome::Unresolved {
                return Ok((outcome, false));
            }
        }
        Ok((self.searched(section, values)?, true))
    }

    fn searched(&self, section: &SectionModel, values: &[f64]) -> Result<SweepOutcome> {
        let mut model: Model = self.model.model.clone();
        coefficients::replace(&mut model, values);
        let coupled = CoupledSection::with_model(&section.structure()?, &model)?;
        let tested = Some(self.model.tested_range);
        let found = find_onset(&self.model.name, &coupled, &self.search, tested)?;
        Ok(match found {
            FlutterSearch::Onset(o) => SweepOutcome::Onset(SweptOnset {
                speed_m_s: o.at.speed_m_s,
                frequency_hz: o.at.frequency_hz,
                in_tested_range: o.in_tested_range != Some(false),
                spurious: o.spurious_speeds_m_s.len(),
            }),
            FlutterSearch::UnstableAtOrBelow(start) => {
                SweepOutcome::UnstableAtOrBelow(SweptOnset {
                    speed_m_s: start.at.speed_m_s,
                    frequency_hz: start.at.frequency_hz,
                    in_tested_range: start.in_tested_range != Some(false),
                    spurious: 0,
                })
            }
            FlutterSearch::StableUpTo(_) => SweepOutcome::Stable,
        })
    }
}
