//! Response of a bridge in the time domain to a turbulence field that repeats itself, many records.
//!
//! The forces run on straight lines between samples, for which the steps `z⁺ = Φ z + Γ₀ u + Γ₁ (u⁺ − u)/h` are exact. A period of `N`
//! steps that repeats itself is as many numbers `ζ = e^{2πik/N}`, and the response to each is
//!
//! ```text
//! G(ζ) = C B₁ + C (ζI − Φ)⁻¹ (B₀ + Φ B₁),   B₁ = Γ₁/h,   B₀ = Γ₀ − B₁
//! (ζI − Φ)⁻¹ = Σ_n ζ^{−n−1} Φⁿ (I − Φᴺ)⁻¹
//! ```
//!
//! the transform of the `N` matrices `C Φⁿ (I − Φᴺ)⁻¹ (B₀ + Φ B₁)`, products of a few `C Φⁱ` with a few `Φ^{sj} …`: nothing is stepped.

use super::problem::BuffetingProblem;
use super::response::{by_node, part};
use super::synthesis::parts_in_time;
use super::time::{all_records, root_and_error, too_short};
use crate::aerodynamics::GustComponent;
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, counted};
use crate::numbered::OnDone;
use crate::signal::Fourier;
use crate::state_space::{StateEquation, c2d};
use aerodeck_core::threads;
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Length of a record in decay times of the least damped mode: what its lines leave out of a variance, or add to it, is at most
/// 2 e^(−5), 1.4 % of it.
const DECAY_TIMES: f64 = 5.0;
/// Samples of a record whose length is not stated, at most: time and memory grow with it.
const SAMPLES_BY_DEFAULT: usize = 1 << 18;
/// The same times nodes: a quarter of a gigabyte for each component of the gusts.
const NUMBERS_BY_DEFAULT: usize = 1 << 25;
/// Time in which peaks are expected when none is stated, s.
const PEAK_S: f64 = 600.0;

/// How many records, how long, how fine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SpanPlan {
    /// Number of records, at least 2: their scatter gives the standard error.
    pub records: usize,
    /// Seed of the first record; the others follow.
    pub seed: u64,
    /// Length of each record, s; left out, as many times 600 s as make five decay times of the least damped mode.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Time step, s.
    pub step_s: f64,
}

impl Default for SpanPlan {
    fn default() -> Self {
        Self {
            records: 8,
            seed: 1,
            duration_s: None,
            step_s: 0.05,
        }
    }
}

impl SpanPlan {
    /// Time in which peaks are expected, s: the stated length of a record, or else 600 s.
    pub fn peak_s(&self) -> f64 {
        self.duration_s.unwrap_or(PEAK_S)
    }

    /// Samples in that time.
    fn peak_samples(&self) -> usize {
        2 * (0.5 * self.peak_s() / self.step_s).round() as usize
    }

    /// Samples of a record at a wind speed, m/s.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the eigenvalues of the bridge cannot be computed.
    pub fn record_samples(&self, problem: &BuffetingProblem<'_>, speed_m_s: f64) -> Result<usize> {
        let slowest = match self.duration_s {
            Some(_) => f64::INFINITY,
            None => match problem.coupled(speed_m_s) {
                Ok((_, slowest)) => slowest,
                // no record of a growing motion is long enough
                Err(Error::Unstable(_)) => f64::INFINITY,
                Err(error) => return Err(error),
            },
        };
        Ok(self.samples(slowest, problem.nodes.len()))
    }

    /// Samples of a record of so many nodes, for the decay rate of the slowest motion, 1/s.
    fn samples(&self, slowest: f64, nodes: usize) -> usize {
        let samples = self.peak_samples().max(1);
        let most = SAMPLES_BY_DEFAULT.min(NUMBERS_BY_DEFAULT / nodes.max(1));
        let times = match self.duration_s {
            Some(_) => 1,
            None => (DECAY_TIMES / slowest / PEAK_S).ceil() as usize,
        };
        samples * times.clamp(1, (most / samples).max(1))
    }
}

/// Root mean squares and peaks over many records at named nodes: vertical, lateral (m), rotation (rad).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpanEnsemble {
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// What was asked for.
    pub plan: SpanPlan,
    /// Length of each record, s.
    pub record_s: f64,
    /// Why the records are too short for their root mean squares, where they are.
    pub too_short: Option<String>,
    /// Places of the nodes in the bridge.
    pub nodes: Vec<usize>,
    /// Root of the mean of the variances about the mean.
    pub rms: Vec<[f64; 3]>,
    /// Standard error of `rms` from the scatter of the records.
    pub standard_error: Vec<[f64; 3]>,
    /// Mean of the greatest departure from the mean in the time of the peaks, over `rms`.
    pub peak_factor: Vec<[f64; 3]>,
}

/// Response of named nodes to one field: vertical, lateral (m), rotation (rad).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpanRecord {
    /// Names of the nodes.
    pub nodes: Vec<String>,
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// Why the record is too short for its root mean squares, where it is.
    pub too_short: Option<String>,
    /// Root mean square about the mean over the record.
    pub rms: Vec<[f64; 3]>,
    /// Greatest departure from the mean over `rms`.
    pub peak_factor: Vec<[f64; 3]>,
}

/// The response to one field of gusts `u`, `w`, a row per node, as one period of a periodic process.
///
/// # Errors
/// [`Error::Input`] for a field of other nodes and parts that do not fit together; [`Error::Unstable`] when the bridge is
/// unstable at this speed.
pub fn span_record(
    problem: &BuffetingProblem<'_>,
    nodes: &[usize],
    speed_m_s: f64,
    step_s: f64,
    gusts: &[Vec<Vec<f64>>; 2],
) -> Result<SpanRecord> {
    let (count, samples) = (problem.nodes.len(), gusts[0].first().map_or(0, Vec::len));
    let fits =
        |rows: &Vec<Vec<f64>>| rows.len() == count && rows.iter().all(|r| r.len() == samples);
    if samples < 2 || !gusts.iter().all(fits) {
        let [wanted, found] = [count, gusts[0].len()].map(|n| counted(n, "node"));
        let expected = format!("gusts at {wanted}, as many samples at each");
        return Err(Error::input("turbulence field", expected, found));
    }
    let (coupled, slowest) = problem.coupled(speed_m_s)?;
    let bridge = PeriodicBridge::new(problem, &coupled, nodes, speed_m_s, step_s, samples)?;
    let found = bridge.run(samples, |component| {
        let rows = &gusts[component as usize];
        threads::each(rows, true, |row| bridge.amplitudes(row))
    });
    let record_s = samples as f64 * step_s;
    let factor = |row: usize| part(found[row].1, found[row].0.sqrt(), 0.0);
    Ok(SpanRecord {
        nodes: problem.names_of(nodes),
        speed_m_s,
        too_short: too_short(record_s, DECAY_TIMES, slowest, speed_m_s),
        rms: by_node(nodes.len(), |row| found[row].0.sqrt()),
        peak_factor: by_node(nodes.len(), factor),
    })
}

/// Responses to `plan.records` fields. `progress` gets how many are done, from any thread.
///
/// # Errors
/// [`Error::Input`] for a plan that cannot be and parts that do not fit together; [`Error::Unstable`] when the bridge is unstable
/// at this speed.
pub fn span_ensemble(
    problem: &BuffetingProblem<'_>,
    nodes: &[usize],
    speed_m_s: f64,
    plan: &SpanPlan,
    progress: OnDone<'_>,
) -> Result<SpanEnsemble> {
    let (coupled, slowest) = problem.coupled(speed_m_s)?;
    let (step, samples) = (plan.step_s, plan.samples(slowest, problem.nodes.len()));
    problem.check_record(speed_m_s, step, samples)?;
    let bridge = PeriodicBridge::new(problem, &coupled, nodes, speed_m_s, step, samples)?;
    let record = |seed: u64| {
        let gusts = |component| problem.coefficients(component, speed_m_s, step, samples, seed);
        Ok(bridge.run(plan.peak_samples(), gusts))
    };
    let runs = all_records(plan.records, plan.seed, progress, record)?;
    let of = |row: usize| {
        let squares: Vec<f64> = runs.iter().map(|r| r[row].0).collect();
        let (rms, error) = root_and_error(&squares);
        let peak = runs.iter().map(|r| r[row].1).sum::<f64>() / runs.len() as f64;
        [rms, error, part(peak, rms, 0.0)]
    };
    let each: Vec<[f64; 3]> = (0..3 * nodes.len()).map(of).collect();
    let list = |which: usize| by_node(nodes.len(), |row| each[row][which]);
    let record_s = samples as f64 * step;
    Ok(SpanEnsemble {
        speed_m_s,
        plan: *plan,
        record_s,
        too_short: too_short(record_s, DECAY_TIMES, slowest, speed_m_s),
        nodes: nodes.to_vec(),
        rms: list(0),
        standard_error: list(1),
        peak_factor: list(2),
    })
}

/// Variance of each row over one record, and its mean greatest departure.
type Run = Vec<(f64, f64)>;

/// A stable bridge that is driven by gusts of one period.
struct PeriodicBridge<'a> {
    problem: &'a BuffetingProblem<'a>,
    speed_m_s: f64,
    step_s: f64,
    fourier: Fourier,
    /// `G` of the force on one mode each: a row per frequency from zero to half the rate of the samples, a column per motion.
    transfer: Vec<DMatrix<Complex<f64>>>,
    /// Motions of the nodes, in columns, by those motions, which are the modes' where nodes have more of them.
    of_motions: DMatrix<f64>,
}

impl<'a> PeriodicBridge<'a> {
    fn new(
        problem: &'a BuffetingProblem<'a>,
        coupled: &CoupledSection,
        nodes: &[usize],
        speed_m_s: f64,
        step_s: f64,
        samples: usize,
    ) -> Result<Self> {
        let shapes = problem.shapes_at(nodes);
        let fourier = Fourier::new(samples);
        let (rows, modes) = shapes.shape();
        let (motions, of_motions) = match rows > modes {
            true => (DMatrix::identity(modes, modes), shapes.transpose()),
            false => (shapes, DMatrix::identity(rows, rows)),
        };
        let transfer = transfer(coupled, &motions, speed_m_s, step_s, &fourier)?;
        Ok(Self {
            problem,
            speed_m_s,
            step_s,
            fourier,
            transfer,
            of_motions,
        })
    }

    /// Numbers of a signal whose sum over the positive frequencies has it as its real part.
    fn amplitudes(&self, signal: &[f64]) -> Vec<Complex<f64>> {
        let samples = self.fourier.length();
        let mut spectrum = self.fourier.spectrum(signal.iter().copied());
        spectrum.truncate(samples / 2 + 1);
        for (k, z) in spectrum.iter_mut().enumerate() {
            // the negative frequencies are the conjugates, but for those that have none
            let both = if k == 0 || 2 * k == samples { 1.0 } else { 2.0 };
            *z *= both / samples as f64;
        }
        spectrum
    }

    /// What the rows do in gusts, of which a row per node is made for each component; a peak is that of `peak_samples`.
    fn run(
        &self,
        peak_samples: usize,
        gusts: impl Fn(GustComponent) -> Vec<Vec<Complex<f64>>>,
    ) -> Run {
        let samples = self.fourier.length();
        let forces = (self.problem).forces(self.speed_m_s, self.step_s, samples, gusts);
        let (motions, rows) = self.of_motions.shape();
        // real and imaginary parts one after the other, as those of the forces
        let mut parts = DMatrix::<f64>::zeros(forces.nrows(), motions);
        for (transfer, force) in self.transfer.iter().zip(forces.column_iter()) {
            for (mut sums, driven) in parts.column_iter_mut().zip(transfer.column_iter()) {
                let sums = sums.as_mut_slice().chunks_exact_mut(2);
                let force = force.as_slice().chunks_exact(2);
                for ((sum, g), part) in sums.zip(driven.iter()).zip(force) {
                    sum[0] += g.re * part[0] - g.im * part[1];
                    sum[1] += g.re * part[1] + g.im * part[0];
                }
            }
        }
        let row = |row: usize| {
            let column = &parts * self.of_motions.column(row);
            let values = parts_in_time(&self.fourier, column.as_slice());
            let mean = values.iter().sum::<f64>() / samples as f64;
            let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / samples as f64;
            let parts = values.chunks(peak_samples);
            let peak = |part: &[f64]| part.iter().map(|x| (x - mean).abs()).fold(0.0, f64::max);
            let peaks = parts.len() as f64;
            (square, parts.map(peak).sum::<f64>() / peaks)
        };
        (0..rows).map(row).collect()
    }
}

/// Transfer of a coupled bridge, for each mode what its force does to the rows of `shapes`.
fn transfer(
    coupled: &CoupledSection,
    shapes: &DMatrix<f64>,
    speed: f64,
    step_s: f64,
    fourier: &Fourier,
) -> Result<Vec<DMatrix<Complex<f64>>>> {
    let samples = fourier.length();
    let StateEquation { a, b } = coupled.equation_at(speed)?;
    let step = c2d(&a, &b, step_s)?;
    let (rows, modes) = shapes.shape();
    let states = step.phi.nrows();
    let next = &step.gamma_1 / step_s;
    let driven = &step.gamma_0 - &next + &step.phi * &next;
    let repeated = DMatrix::identity(states, states) - power(&step.phi, samples);
    let first = repeated.lu().solve(&driven).ok_or_else(|| {
        Error::Numerical("buffeting: the motion does not repeat itself with the record".into())
    })?;
    let mut output = DMatrix::zeros(rows, states);
    output.columns_mut(0, modes).copy_from(shapes);
    let direct = &output * next;
    // as many products on the one side as on the other
    let block = ((samples * modes) as f64 / rows as f64).sqrt().ceil() as usize;
    let block = block.clamp(1, samples);
    let mut outputs = DMatrix::zeros(rows * block, states);
    for i in 0..block {
        for row in 0..rows {
            outputs.row_mut(row * block + i).copy_from(&output.row(row));
        }
        output = &output * &step.phi;
    }
    let stride = power(&step.phi, block);
    let blocks = std::iter::successors(Some(first), |z| Some(&stride * z));
    let blocks: Vec<DMatrix<f64>> = blocks.take(samples.div_ceil(block)).collect();
    let turn = |k: usize| Complex::from_polar(1.0, -TAU * k as f64 / samples as f64);
    let turns: Vec<Complex<f64>> = (0..=samples / 2).map(turn).collect();
    let of_mode = |mode: usize| {
        let starts: Vec<_> = blocks.iter().map(|z| z.column(mode)).collect();
        let response = &outputs * DMatrix::from_columns(&starts);
        let mut all = DMatrix::zeros(turns.len(), rows);
        for (row, mut column) in all.column_iter_mut().enumerate() {
            let at = |n: usize| response[(row * block + n % block, n / block)];
            let spectrum = fourier.spectrum((0..samples).map(at));
            for ((to, z), turn) in column.iter_mut().zip(&spectrum).zip(&turns) {
                *to = z * turn + direct[(row, mode)];
            }
        }
        all
    };
    Ok(threads::numbered(modes, true, of_mode))
}

/// A power of a square matrix by repeated squaring.
fn power(matrix: &DMatrix<f64>, exponent: usize) -> DMatrix<f64> {
    let mut square = matrix.clone();
    let mut power = DMatrix::identity(matrix.nrows(), matrix.nrows());
    let mut left = exponent;
    while left > 0 {
        if left % 2 == 1 {
            power = &power * &square;
        }
        left /= 2;
        if left > 0 {
            square = &square * &square;
        }
    }
    power
}
