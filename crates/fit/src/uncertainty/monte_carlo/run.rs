//! Onsets of many sections over all cores: drawn from a plan, or given.

use super::coefficients;
use super::plan::MonteCarloPlan;
use super::results::{MonteCarloResult, Tally};
use super::sampler::{Sample, Sampler};
use super::scatter::{CovarianceFactor, DrawnForces, drawn_model};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, ensure};
use crate::flutter::{
    CriticalPoint, FlutterSearch, OnsetSearch, OnsetSweep, SweepOutcome, SweptOnset, find_onset,
};
use crate::numbered::{OnDone, numbered_in_parts};
use crate::section::SectionModel;
use crate::trained_model::{Model, TrainedModel};
use std::ops::Range;

/// Samples or sections that a thread takes at once.
const PART: usize = 2048;
/// Wind speeds of the search by eigenvalues.
const SPEEDS: usize = 200;

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
    progress: OnDone<'_>,
) -> Result<MonteCarloResult> {
    let tally = tally(plan, model, 0..plan.samples, progress)?;
    summarise(plan, model, [tally])
}

/// Answers of some samples of a plan, by their numbers from 0, over the cores of the current pool: for several machines, each
/// with its part.
///
/// # Errors
/// As [`monte_carlo`]; [`crate::Error::Input`] for samples that the plan has not.
pub fn tally(
    plan: &MonteCarloPlan,
    model: &TrainedModel,
    samples: Range<usize>,
    progress: OnDone<'_>,
) -> Result<Tally> {
    ensure(
        samples.start <= samples.end && samples.end <= plan.samples,
        "samples",
        format_args!("numbers of samples up to {}", plan.samples),
        format_args!("{samples:?}"),
    )?;
    let (limit, model, covariance) = drawn(plan, model)?;
    let finder = Finder::new(&model, limit)?;
    let (values, _) = coefficients::list(&model.model);
    let sampler = Sampler::new(plan, &model.section, &values, covariance)?;
    // a number for each sample, and nothing twice: those of a part stand in its places until all are closed up
    let mut onsets = vec![0.0; samples.len()];
    let tallies = numbered_in_parts(&mut onsets, PART, progress, |first, places| {
        let from = samples.start + first;
        let mut tally = finder.tally(&sampler, from..from + places.len());
        let found = std::mem::take(&mut tally.onsets);
        places[..found.len()].copy_from_slice(&found);
        Ok((tally, found.len()))
    })?;
    let mut kept = 0;
    for (part, (_, found)) in tallies.iter().enumerate() {
        let from = part * PART;
        onsets.copy_within(from..from + found, kept);
        kept += found;
    }
    onsets.truncate(kept);
    let rest = tallies.into_iter().map(|(tally, _)| tally).collect();
    Ok(Tally {
        onsets,
        ..Tally::joined(rest)
    })
}

/// What the answers of all samples of a plan amount to, in the order of their numbers.
///
/// # Errors
/// As [`monte_carlo`]; [`crate::Error::Input`] when they are not as many as the plan has, and where all of them failed.
pub fn summarise(
    plan: &MonteCarloPlan,
    model: &TrainedModel,
    tallies: impl IntoIterator<Item = Tally>,
) -> Result<MonteCarloResult> {
    let (limit, model, covariance) = drawn(plan, model)?;
    let (values, _) = coefficients::list(&model.model);
    let (nominal, _) = Finder::new(&model, limit)?.onset(&model.section, &values)?;
    let total = Tally::joined(tallies.into_iter().collect());
    ensure(
        total.len() == plan.samples,
        "samples",
        format_args!("answers of {} samples", plan.samples),
        total.len(),
    )?;
    let mut found = total.summarise(plan, limit, &model.name, nominal);
    found.findings = plan.findings(&model.section)?;
    let relative_scatter = plan.aerodynamics.relative_scatter;
    let by_plan = relative_scatter.map(|_| DrawnForces {
        relative_scatter,
        ..DrawnForces::default()
    });
    found.drawn_forces = covariance.map(|c| c.draws).or(by_plan);
    // nothing answers for what no sample had an answer for
    let answered = plan.samples > found.failed;
    let first = found.failures.first().map_or("", |f| f.reason.as_str());
    let none = format_args!("none; the first: {first}");
    ensure(answered, "samples", "some with an answer", none)?;
    Ok(found)
}

/// Highest speed searched, m/s, and the model that a plan draws from.
fn drawn(
    plan: &MonteCarloPlan,
    model: &TrainedModel,
) -> Result<(f64, TrainedModel, Option<CovarianceFactor>)> {
    plan.validate()?;
    let limit = model.experiment.onset_search_limit_m_s;
    let limit = plan.speed_max_m_s.unwrap_or(limit);
    plan.check_design_speed(limit)?;
    let (drawn, covariance) = drawn_model(plan, model)?;
    let model = TrainedModel {
        model: drawn,
        ..model.clone()
    };
    Ok((limit, model, covariance))
}

impl<'a> Finder<'a> {
    pub(super) fn new(model: &'a TrainedModel, speed_max_m_s: f64) -> Result<Self> {
        let forces = coefficients::linear(&model.model, Some(model.tested_range));
        let sweep = |forces| OnsetSweep::new(forces, &model.section.structure()?, speed_max_m_s);
        Ok(Self {
            model,
            sweep: forces.map(sweep).transpose()?,
            search: OnsetSearch::new(speed_max_m_s, SPEEDS),
        })
    }

    fn tally(&self, sampler: &Sampler, samples: Range<usize>) -> Tally {
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
                        SweepOutcome::Stable { judged_to_m_s } => tally.stable.push(judged_to_m_s),
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
        let swept = |at: &CriticalPoint, tested: Option<bool>, spurious| SweptOnset {
            speed_m_s: at.speed_m_s,
            frequency_hz: at.frequency_hz,
            in_tested_range: tested != Some(false),
            spurious,
        };
        Ok(match found {
            FlutterSearch::Onset(o) => {
                let spurious = o.spurious_speeds_m_s.len();
                SweepOutcome::Onset(swept(&o.at, o.in_tested_range, spurious))
            }
            FlutterSearch::UnstableAtOrBelow(start) => {
                SweepOutcome::UnstableAtOrBelow(swept(&start.at, start.in_tested_range, 0))
            }
            FlutterSearch::StableUpTo(range) => SweepOutcome::Stable {
                judged_to_m_s: range.to_m_s,
            },
        })
    }
}

/// Finds the onset of the force model of `model` on `count` sections, over all cores; `section` makes the i-th of them from
/// that of the model. Continuous models go through [`OnsetSweep`]. What that leaves unresolved is searched in full, which always answers.
///
/// # Errors
/// [`Error::Input`] naming the number of the first section that cannot be.
pub fn many_onsets(
    model: &TrainedModel,
    count: usize,
    section: &(dyn Fn(usize, &mut SectionModel) + Sync),
    speed_max_m_s: f64,
    progress: OnDone<'_>,
) -> Result<Vec<SweepOutcome>> {
    let finder = Finder::new(model, speed_max_m_s)?;
    let (values, _) = coefficients::list(&model.model);
    let mut outcomes = vec![SweepOutcome::Unresolved; count];
    numbered_in_parts(&mut outcomes, PART, progress, |first, places| {
        let mut one = model.section.clone();
        for (i, place) in (first..).zip(places) {
            section(i, &mut one);
            let outcome = finder.onset(&one, &values);
            (*place, _) = outcome.map_err(|e| of_section(i, e))?;
        }
        Ok(())
    })?;
    Ok(outcomes)
}

fn of_section(index: usize, error: Error) -> Error {
    match error {
        Error::Input(mut input) => {
            input.place = format!("section {index}: {}", input.place).into();
            Error::Input(input)
        }
        other => other,
    }
}
