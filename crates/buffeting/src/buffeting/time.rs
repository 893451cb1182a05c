//! Response in the time domain: generated gust forces stepped through the coupled section, many records.

use super::problem::BuffetingProblem;
use super::response::{BuffetingResponse, part};
use super::synthesis::parts_in_time;
use crate::aeroelastic::CoupledSection;
use crate::error::{Result, ensure, positive};
use crate::numbered::{OnDone, numbered};
use crate::response::{Inputs, Stepper};
use crate::section::Dof;
use crate::signal::Fourier;
use serde::{Deserialize, Serialize};

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
pub struct TimePlan {
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

/// Refuses a plan that no structure could take; `place` is its key.
pub fn check_plan(
    place: &str,
    records: usize,
    duration_s: Option<f64>,
    step_s: Option<f64>,
) -> Result<()> {
    let expected = format_args!("a number from 2 to {MOST_RECORDS}");
    let fits = (2..=MOST_RECORDS).contains(&records);
    ensure(fits, format!("{place}.records"), expected, records)?;
    for (key, value) in [("duration_s", duration_s), ("step_s", step_s)] {
        let value = value.map(|v| positive(format!("{place}.{key}"), v));
        value.transpose()?;
    }
    Ok(())
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
    let of_one = |(i, dof): (usize, &Dof)| ComponentComparison {
        dof: *dof,
        frequency_rms: frequency.rms[i],
        time_rms: time.rms[i],
        standard_error: time.standard_error[i],
        deviations: (time.rms[i] - frequency.rms[i]) / time.standard_error[i],
    };
    dofs.iter().enumerate().map(of_one).collect()
}

/// The records of a plan at a mean wind speed.
struct SteppedRecords<'a> {
    problem: &'a BuffetingProblem<'a>,
    section: CoupledSection,
    speed_m_s: f64,
    step_s: f64,
    fourier: Fourier,
    warm_up: usize,
}

/// Steps `plan.records` records at a mean wind speed through the coupled section. Gust forces run on straight lines between
/// samples, for which the steps are exact; each record is one period of its force after a warm-up by its own end.
///
/// `progress` gets how many of all records are done.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) for a plan that cannot be, a model without realisation, and records shorter than their warm-up;
/// [`Error::Unstable`](crate::error::Error::Unstable) when the section is unstable at this speed.
pub fn time_ensemble(
    problem: &BuffetingProblem<'_>,
    speed_m_s: f64,
    plan: &TimePlan,
    progress: OnDone<'_>,
) -> Result<Ensemble> {
    let records = SteppedRecords::new(problem, speed_m_s, plan)?;
    let record = |seed: u64| records.mean_squares(seed);
    let runs = all_records(plan.records, plan.seed, progress, record)?;
    Ok(records.gathered(&runs))
}

/// Makes every record of a plan by its own seed, side by side; `progress` gets how many are done and how many there are.
///
/// # Errors
/// Those of a record.
pub(super) fn all_records<T: Send>(
    records: usize,
    seed: u64,
    progress: OnDone<'_>,
    record: impl Fn(u64) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    numbered(records, progress, |i| record(seed.wrapping_add(i as u64)))
}

/// Root of the mean of the mean squares of records, and its standard error by their scatter.
pub(super) fn root_and_error(squares: &[f64]) -> (f64, f64) {
    let count = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / count;
    let scatter = squares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let error = part((scatter / count).sqrt(), 2.0 * mean.sqrt(), 0.0);
    (mean.sqrt(), error)
}

/// The least length of a record, in words, for the decay rate of the slowest motion, 1/s.
fn at_least(decay_times: f64, slowest: f64, speed_m_s: f64) -> String {
    let least_s = decay_times / slowest;
    format!(
        "at least {least_s:.1} s, {decay_times} decay times of the least damped mode at {speed_m_s} m/s"
    )
}

/// What is wrong with records of that length, s, where it is: too few decay times of the slowest motion.
pub(super) fn too_short(
    record_s: f64,
    decay_times: f64,
    slowest: f64,
    speed_m_s: f64,
) -> Option<String> {
    (record_s * slowest < decay_times).then(|| {
        let expected = at_least(decay_times, slowest, speed_m_s);
        format!("RMS in time may be far off, whatever its standard error: a record expected {expected}, found {record_s:.0} s")
    })
}

impl<'a> SteppedRecords<'a> {
    fn new(problem: &'a BuffetingProblem<'a>, speed_m_s: f64, plan: &TimePlan) -> Result<Self> {
        let (section, slowest) = problem.coupled(speed_m_s)?;
        let finest = || 1.0 / (SAMPLES_PER_PERIOD * problem.highest_hz);
        let step_s = plan.step_s.unwrap_or_else(finest);
        let duration = plan.duration_s.unwrap_or(DECAY_TIMES_BY_DEFAULT / slowest);
        let warm_up_s = DECAY_TIMES / slowest;
        let expected = at_least(DECAY_TIMES, slowest, speed_m_s);
        ensure(warm_up_s <= duration, "duration_s", expected, duration)?;
        // an even number of samples
        let samples = 2 * (0.5 * duration / step_s).round() as usize;
        problem.check_record(speed_m_s, step_s, samples)?;
        Ok(Self {
            problem,
            section,
            speed_m_s,
            step_s,
            fourier: Fourier::new(samples),
            warm_up: ((warm_up_s / step_s).ceil() as usize).min(samples),
        })
    }

    /// Mean squares of the displacements of one record (n).
    fn mean_squares(&self, seed: u64) -> Result<Vec<f64>> {
        let (forces, samples) = (self.forces(seed), self.fourier.length());
        let n = forces.len();
        let mut stepper = Stepper::new(self.section.clone());
        let mut state = stepper.released(&vec![0.0; n], &vec![0.0; n])?;
        let mut inputs = Inputs::steady(self.speed_m_s, n);
        let mut squares = vec![0.0; n];
        for i in 0..self.warm_up + samples {
            let now = (i + samples - self.warm_up) % samples;
            let next = (now + 1) % samples;
            for (dof, force) in forces.iter().enumerate() {
                inputs.force[dof] = force[now];
                inputs.force_rate[dof] = (force[next] - force[now]) / self.step_s;
            }
            stepper.advance(&mut state, &inputs, self.step_s)?;
            if i >= self.warm_up {
                for (sum, q) in squares.iter_mut().zip(&state.values) {
                    *sum += q * q / samples as f64;
                }
            }
        }
        Ok(squares)
    }

    /// Gust forces of one record (n), each at all samples: N/m, N·m/m.
    fn forces(&self, seed: u64) -> Vec<Vec<f64>> {
        let (problem, speed, step_s) = (self.problem, self.speed_m_s, self.step_s);
        let samples = self.fourier.length();
        let parts = problem.forces(speed, step_s, samples, |component| {
            problem.coefficients(component, speed, step_s, samples, seed)
        });
        let in_time = parts.column_iter();
        let in_time = in_time.map(|c| parts_in_time(&self.fourier, c.as_slice()));
        in_time.collect()
    }

    fn gathered(&self, runs: &[Vec<f64>]) -> Ensemble {
        let (step_s, samples) = (self.step_s, self.fourier.length());
        let n = self.problem.structure.dofs.len();
        let column = |i: usize| runs.iter().map(|squares| squares[i]).collect::<Vec<f64>>();
        let (rms, standard_error) = (0..n).map(|i| root_and_error(&column(i))).unzip();
        let roots = |squares: &Vec<f64>| squares.iter().map(|s| s.sqrt()).collect();
        Ensemble {
            speed_m_s: self.speed_m_s,
            step_s,
            duration_s: step_s * samples as f64,
            warm_up_s: step_s * self.warm_up as f64,
            rms,
            standard_error,
            rms_of_records: runs.iter().map(roots).collect(),
            expected_gust_variance: (self.problem).expected_variance(
                self.speed_m_s,
                step_s,
                samples,
            ),
        }
    }
}

#[cfg(test)]
mod tests;
