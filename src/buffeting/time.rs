//! Response in the time domain: generated gust forces stepped through the coupled section, many records.

use super::frequency::BuffetingResponse;
use super::problem::BuffetingProblem;
use super::synthesis::synthesise;
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, positive};
use crate::response::{Inputs, Stepper};
use crate::section::Dof;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Samples in the shortest still-air period when no step is given: straight lines between them lose 0.4 % of the power there.
const SAMPLES_PER_PERIOD: f64 = 40.0;
/// Decay times of the least damped mode before the record counts, and least length of the record: what is left of the start,
/// and the error of frequencies at a distance of 1/T, are e^(−10).
const DECAY_TIMES: f64 = 10.0;
/// More records than any average needs.
const MOST_RECORDS: usize = 100_000;
/// Decay times in a record when no length is given.
const DECAY_TIMES_BY_DEFAULT: f64 = 40.0;

/// How many records, how long, how fine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct TimePlan {
    /// Number of records, at least 2: their scatter gives the standard error.
    pub records: usize,
    /// Seed of the first record; the others follow.
    pub seed: u64,
    /// Length of each record, s, after a warm-up; left out, 40 decay times of the least damped mode.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Time step, s; left out, a fortieth of the shortest still-air period.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_s: Option<f64>,
}

impl Default for TimePlan {
    fn default() -> Self {
        Self {
            records: 32,
            seed: 1,
            duration_s: None,
            step_s: None,
        }
    }
}

/// Root mean squares over many records; vectors in the order of the degrees of freedom.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ensemble {
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// Time step, s.
    pub step_s: f64,
    /// Length of each record, s.
    pub duration_s: f64,
    /// Warm-up before each, s.
    pub warm_up_s: f64,
    /// Root of the mean of the variances: m, rad.
    pub rms: Vec<f64>,
    /// Standard error of `rms` from the scatter of the records: m, rad.
    pub standard_error: Vec<f64>,
    /// Root mean square of each record.
    pub rms_of_records: Vec<Vec<f64>>,
    /// Variances of `u` and `w` that such records have on average, m²/s².
    pub expected_gust_variance: [f64; 2],
}

/// Both domains side by side for one degree of freedom.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComponentComparison {
    /// The degree of freedom.
    pub dof: Dof,
    /// Root mean square in the frequency domain: m, rad.
    pub frequency_rms: f64,
    /// The same in the time domain.
    pub time_rms: f64,
    /// Standard error of the latter.
    pub standard_error: f64,
    /// Difference in standard errors.
    pub deviations: f64,
}

/// The two domains side by side.
pub fn compare(
    dofs: &[Dof],
    frequency: &BuffetingResponse,
    time: &Ensemble,
) -> Vec<ComponentComparison> {
    dofs.iter()
        .enumerate()
        .map(|(i, dof)| ComponentComparison {
            dof: *dof,
            frequency_rms: frequency.rms[i],
            time_rms: time.rms[i],
            standard_error: time.standard_error[i],
            deviations: (time.rms[i] - frequency.rms[i]) / time.standard_error[i],
        })
        .collect()
}

/// Grid of the records of a plan.
struct TimeGrid {
    step_s: f64,
    samples: usize,
    warm_up: usize,
}

/// Steps `plan.records` records at a mean wind speed through the coupled section. Gust forces run on straight lines between
/// samples, for which the steps are exact; each record is one period of its force after a warm-up by its own end.
///
/// `progress` gets how many of all records are done.
///
/// # Errors
/// [`Error::Input`] for a plan that cannot be, a model without realisation, and records shorter than their warm-up;
/// [`Error::Unstable`] when the section is unstable at this speed.
pub(crate) fn time_ensemble(
    problem: &BuffetingProblem<'_>,
    speed_m_s: f64,
    plan: &TimePlan,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Ensemble> {
    positive("wind speed", speed_m_s)?;
    if !(2..=MOST_RECORDS).contains(&plan.records) {
        return Err(Error::input(
            "records",
            format!("a number from 2 to {MOST_RECORDS}"),
            plan.records.to_string(),
        ));
    }
    let model = problem.model.realizable().ok_or_else(|| {
        Error::input(
            "buffeting in the time domain",
            "a model with a realisation",
            "one that is known only as a transfer matrix",
        )
    })?;
    let section = CoupledSection::with_model(problem.structure, model)?;
    let grid = grid(problem, &section, speed_m_s, plan)?;
    let done = AtomicUsize::new(0);
    let runs = (0..plan.records)
        .into_par_iter()
        .map(|i| {
            let seed = plan.seed.wrapping_add(i as u64);
            let run = mean_squares(problem, &section, speed_m_s, &grid, seed)?;
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, plan.records);
            Ok(run)
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(gathered(speed_m_s, &grid, runs))
}

fn grid(
    problem: &BuffetingProblem<'_>,
    section: &CoupledSection,
    speed_m_s: f64,
    plan: &TimePlan,
) -> Result<TimeGrid> {
    let slowest = section
        .at(speed_m_s)?
        .eigenvalues()?
        .into_iter()
        .map(|z| -z.re)
        .fold(f64::INFINITY, f64::min);
    if slowest <= 0.0 {
        return Err(Error::Unstable(format!(
            "buffeting at {speed_m_s} m/s: the section is unstable there"
        )));
    }
    let (_, fastest) = problem.natural_range_hz();
    let step_s = match plan.step_s {
        Some(step) => positive("step_s", step)?,
        None => 1.0 / (SAMPLES_PER_PERIOD * fastest),
    };
    let duration = match plan.duration_s {
        Some(duration) => positive("duration_s", duration)?,
        None => DECAY_TIMES_BY_DEFAULT / slowest,
    };
    let warm_up_s = DECAY_TIMES / slowest;
    if warm_up_s > duration {
        return Err(Error::input(
            "duration_s",
            format!(
                "at least {warm_up_s:.1} s, {DECAY_TIMES} decay times of the least damped mode at {speed_m_s} m/s"
            ),
            format!("{duration}"),
        ));
    }
    // an even number of samples
    let samples = 2 * (0.5 * duration / step_s).round() as usize;
    Ok(TimeGrid {
        step_s,
        samples,
        warm_up: ((warm_up_s / step_s).ceil() as usize).min(samples),
    })
}

/// Mean squares of the displacements of one record (n), and the expected variances of its gusts.
fn mean_squares(
    problem: &BuffetingProblem<'_>,
    section: &CoupledSection,
    speed: f64,
    grid: &TimeGrid,
    seed: u64,
) -> Result<(Vec<f64>, [f64; 2])> {
    let sample = synthesise(problem, speed, grid.step_s, grid.samples, seed)?;
    let n = problem.structure.dofs.len();
    let mut stepper = Stepper::new(section.clone());
    let mut state = stepper.released(&vec![0.0; n], &vec![0.0; n])?;
    let mut inputs = Inputs::steady(speed, n);
    let mut squares = vec![0.0; n];
    for i in 0..grid.warm_up + grid.samples {
        let now = (i + grid.samples - grid.warm_up) % grid.samples;
        let next = (now + 1) % grid.samples;
        for (dof, force) in sample.forces.iter().enumerate() {
            inputs.force[dof] = force[now];
            inputs.force_rate[dof] = (force[next] - force[now]) / grid.step_s;
        }
        stepper.advance(&mut state, &inputs, grid.step_s)?;
        if i >= grid.warm_up {
            for (sum, q) in squares.iter_mut().zip(&state.values) {
                *sum += q * q / grid.samples as f64;
            }
        }
    }
    Ok((squares, sample.expected_variance))
}

fn gathered(speed_m_s: f64, grid: &TimeGrid, runs: Vec<(Vec<f64>, [f64; 2])>) -> Ensemble {
    let count = runs.len() as f64;
    let n = runs.first().map_or(0, |(squares, _)| squares.len());
    let column = |i: usize| runs.iter().map(move |(squares, _)| squares[i]);
    let mean: Vec<f64> = (0..n).map(|i| column(i).sum::<f64>() / count).collect();
    let error = |i: usize| {
        let scatter = column(i).map(|s| (s - mean[i]).powi(2)).sum::<f64>() / (count - 1.0);
        (scatter / count).sqrt() / (2.0 * mean[i].sqrt())
    };
    Ensemble {
        speed_m_s,
        step_s: grid.step_s,
        duration_s: grid.step_s * grid.samples as f64,
        warm_up_s: grid.step_s * grid.warm_up as f64,
        standard_error: (0..n).map(error).collect(),
        rms: mean.iter().map(|s| s.sqrt()).collect(),
        rms_of_records: runs
            .iter()
            .map(|(squares, _)| squares.iter().map(|s| s.sqrt()).collect())
            .collect(),
        expected_gust_variance: runs.first().map_or([0.0; 2], |(_, variance)| *variance),
    }
}

#[cfg(test)]
mod tests;
