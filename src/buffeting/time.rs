//! Response of a section in the time domain, many records.

use super::periodic::{PeriodicResponse, Run};
use super::problem::BuffetingProblem;
use super::records::{all_records, root_and_error};
use super::response::BuffetingResponse;
use crate::error::{Result, ensure, positive};
use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// Samples in the shortest still-air period when no step is given: straight lines between them lose 0.4 % of the power there.
const SAMPLES_PER_PERIOD: f64 = 40.0;
/// Decay times of the least damped mode in a record at least: the error of frequencies at a distance of 1/T is e^(−10).
const DECAY_TIMES: f64 = 10.0;
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
    /// Length of each record, s; left out, 40 decay times of the least damped mode.
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

/// Moves the section through `plan.records` records at a mean wind speed. Gust forces run on straight lines between samples, for which the
/// motion is exact; force and motion of a record repeat themselves.
///
/// `progress` gets how many of all records are done.
///
/// # Errors
/// [`Error::Input`] for a plan that cannot be, a model without realisation, and records shorter than ten decay times;
/// [`Error::Unstable`] when the section is unstable at this speed.
pub(crate) fn time_ensemble(
    problem: &BuffetingProblem<'_>,
    speed_m_s: f64,
    plan: &TimePlan,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Ensemble> {
    let step_s = match plan.step_s {
        Some(step) => positive("step_s", step)?,
        None => 1.0 / (SAMPLES_PER_PERIOD * problem.highest_hz),
    };
    let samples = samples(problem, speed_m_s, plan, step_s)?;
    let section = PeriodicResponse::new(problem, &[0], speed_m_s, step_s, samples)?;
    let record = |seed: u64| Ok(section.record(seed));
    let runs = all_records(plan.records, plan.seed, progress, record)?;
    let n = problem.structure.dofs.len();
    let column = |i: usize| runs.iter().map(|run| run[i].0).collect::<Vec<f64>>();
    let (rms, standard_error) = (0..n).map(|i| root_and_error(&column(i))).unzip();
    let roots = |run: &Run| run.iter().map(|motion| motion.0.sqrt()).collect();
    Ok(Ensemble {
        speed_m_s,
        step_s,
        duration_s: step_s * samples as f64,
        rms,
        standard_error,
        rms_of_records: runs.iter().map(roots).collect(),
        expected_gust_variance: problem.expected_variance(speed_m_s, step_s, samples),
    })
}

/// Samples of a record, an even number.
fn samples(
    problem: &BuffetingProblem<'_>,
    speed_m_s: f64,
    plan: &TimePlan,
    step_s: f64,
) -> Result<usize> {
    let (_, slowest) = problem.coupled(speed_m_s)?;
    let duration = match plan.duration_s {
        Some(duration) => positive("duration_s", duration)?,
        None => DECAY_TIMES_BY_DEFAULT / slowest,
    };
    let least = DECAY_TIMES / slowest;
    let expected = format!(
        "at least {least:.1} s, {DECAY_TIMES} decay times of the least damped mode at {speed_m_s} m/s"
    );
    ensure(least <= duration, "duration_s", expected, duration)?;
    let samples = 2 * (0.5 * duration / step_s).round() as usize;
    problem.check_record(speed_m_s, step_s, samples)?;
    Ok(samples)
}

#[cfg(test)]
mod tests;
