//! Response of a bridge in the time domain: a turbulence field stepped through the coupled modes, many records.

use super::{SpanProblem, TurbulenceField, turbulence_field};
use crate::aeroelastic::CoupledSection;
use crate::buffeting::spectrum::GustComponent;
use crate::error::{Error, Result, counted, positive};
use crate::response::{Inputs, SectionState, Stepper};
use crate::signal::Fourier;
use nalgebra::{Complex, DMatrix, DVector, Dyn, LU};
use serde::{Deserialize, Serialize};

/// How many records, how long, how fine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SpanPlan {
    /// Number of records, at least 2: their scatter gives the standard error.
    pub records: usize,
    /// Seed of the first record; the others follow.
    pub seed: u64,
    /// Length of each record, s.
    pub duration_s: f64,
    /// Time step, s.
    pub step_s: f64,
}

impl Default for SpanPlan {
    fn default() -> Self {
        Self {
            records: 8,
            seed: 1,
            duration_s: 600.0,
            step_s: 0.05,
        }
    }
}

/// Root mean squares and peaks over many records at named nodes: vertical, lateral (m), rotation (rad).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpanEnsemble {
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// What was asked for.
    pub plan: SpanPlan,
    /// Places of the nodes in the bridge.
    pub nodes: Vec<usize>,
    /// Root of the mean of the variances about the mean.
    pub rms: Vec<[f64; 3]>,
    /// Standard error of `rms` from the scatter of the records.
    pub standard_error: Vec<[f64; 3]>,
    /// Mean over the records of the greatest departure from the mean, over `rms`.
    pub peak_factor: Vec<[f64; 3]>,
}

/// Response of named nodes to one field: vertical, lateral (m), rotation (rad).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpanRecord {
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// Root mean square about the mean over the record.
    pub rms: Vec<[f64; 3]>,
    /// Greatest departure from the mean over `rms`.
    pub peak_factor: Vec<[f64; 3]>,
}

/// Steps one field through the coupled bridge, as one period of a periodic process.
///
/// # Errors
/// [`Error::Input`] for a field of other nodes and parts that do not fit together; [`Error::Unstable`] when the bridge is
/// unstable at this speed.
pub fn span_record(
    problem: &SpanProblem<'_>,
    nodes: &[usize],
    speed_m_s: f64,
    field: &TurbulenceField,
) -> Result<SpanRecord> {
    problem.validate(speed_m_s)?;
    let coupled = problem.coupled(speed_m_s)?;
    let mut periodic = Periodic::new(coupled, speed_m_s, field.step_s, field.samples())?;
    let forces = modal_forces(problem, field, speed_m_s)?;
    let shapes = problem.bridge.shapes_at(nodes);
    let found = run(&mut periodic, &forces, &shapes, speed_m_s, field.step_s)?;
    let list = |of: fn(&(f64, f64)) -> f64| -> Vec<[f64; 3]> {
        (0..nodes.len())
            .map(|n| std::array::from_fn(|i| of(&found[3 * n + i])))
            .collect()
    };
    Ok(SpanRecord {
        speed_m_s,
        rms: list(|r| r.0.sqrt()),
        peak_factor: list(|r| r.1 / r.0.sqrt()),
    })
}

/// What a period from rest leaves behind becomes the state with which the period repeats itself: `z₀ = (I − Φᴺ)⁻¹ z_N`.
struct Periodic {
    stepper: Stepper,
    less_one_period: LU<f64, Dyn, Dyn>,
}

impl Periodic {
    fn new(coupled: CoupledSection, speed: f64, step: f64, samples: usize) -> Result<Self> {
        let mut square = coupled.continuous_at(speed)?.c2d(step)?.phi;
        let n = square.nrows();
        let mut power = DMatrix::<f64>::identity(n, n);
        let mut left = samples;
        while left > 0 {
            if left % 2 == 1 {
                power = &power * &square;
            }
            left /= 2;
            if left > 0 {
                square = &square * &square;
            }
        }
        Ok(Self {
            stepper: Stepper::new(coupled),
            less_one_period: (DMatrix::identity(n, n) - power).lu(),
        })
    }
}

/// Steps `plan.records` fields through the coupled bridge. `progress` gets how many are done.
///
/// # Errors
/// [`Error::Input`] for a plan that cannot be and parts that do not fit together; [`Error::Unstable`] when the bridge is unstable
/// at this speed.
pub(crate) fn span_ensemble(
    problem: &SpanProblem<'_>,
    nodes: &[usize],
    speed_m_s: f64,
    plan: &SpanPlan,
    progress: &dyn Fn(usize, usize),
) -> Result<SpanEnsemble> {
    problem.validate(speed_m_s)?;
    positive("duration_s", plan.duration_s)?;
    positive("step_s", plan.step_s)?;
    if plan.records < 2 {
        return Err(Error::input(
            "records",
            "at least 2",
            plan.records.to_string(),
        ));
    }
    let coupled = problem.coupled(speed_m_s)?;
    let samples = 2 * (0.5 * plan.duration_s / plan.step_s).round() as usize;
    let mut periodic = Periodic::new(coupled, speed_m_s, plan.step_s, samples)?;
    let shapes = problem.bridge.shapes_at(nodes);
    let mut runs = Vec::with_capacity(plan.records);
    for i in 0..plan.records {
        let seed = plan.seed.wrapping_add(i as u64);
        let field = turbulence_field(problem, speed_m_s, plan.step_s, samples, seed)?;
        let forces = modal_forces(problem, &field, speed_m_s)?;
        runs.push(run(
            &mut periodic,
            &forces,
            &shapes,
            speed_m_s,
            plan.step_s,
        )?);
        progress(i + 1, plan.records);
    }
    Ok(gathered(speed_m_s, plan, nodes, &runs))
}

/// Forces on the mass-normalised modes by a field, one row per mode; the admittance is exact at every frequency of the record.
pub(crate) fn modal_forces(
    problem: &SpanProblem<'_>,
    field: &TurbulenceField,
    speed_m_s: f64,
) -> Result<Vec<Vec<f64>>> {
    let (nodes, samples) = (problem.bridge.nodes.len(), field.samples());
    let fits =
        |rows: &Vec<Vec<f64>>| rows.len() == nodes && rows.iter().all(|r| r.len() == samples);
    if samples < 2 || !field.gusts.iter().all(fits) {
        let expected = format!(
            "gusts at {}, as many samples at each",
            counted(nodes, "node")
        );
        return Err(Error::input(
            "turbulence field",
            expected,
            counted(field.gusts[0].len(), "node"),
        ));
    }
    let fourier = Fourier::new(samples);
    let modes = problem.bridge.modes.len();
    let mut spectrum = DMatrix::<Complex<f64>>::zeros(modes, samples);
    for (component, rows) in GustComponent::BOTH.into_iter().zip(&field.gusts) {
        if problem.turbulence.component(component).is_none() {
            continue;
        }
        let transform = |row: &Vec<f64>| fourier.spectrum(row.iter().copied());
        let transformed: Vec<_> = rows.iter().map(transform).collect();
        for k in 0..=samples / 2 {
            let frequency = k as f64 / (samples as f64 * field.step_s);
            let forces = problem.force_of_gusts(component, frequency, speed_m_s);
            let mut column = spectrum.column_mut(k);
            for (n, x) in transformed.iter().enumerate() {
                for (sum, force) in column.iter_mut().zip(forces.row(n).iter()) {
                    *sum += force * x[k];
                }
            }
        }
    }
    let scale = 1.0 / samples as f64;
    let to_time = |m: usize| {
        let mut x: Vec<Complex<f64>> = spectrum.row(m).iter().copied().collect();
        // the negative frequencies are the conjugates: twice the real part of the positive ones
        x[1..samples.div_ceil(2)].iter_mut().for_each(|z| *z *= 2.0);
        fourier.sums(x).iter().map(|x| x * scale).collect()
    };
    Ok((0..modes).map(to_time).collect())
}

/// Variance and greatest departure of each row over one record.
type Run = Vec<(f64, f64)>;

fn run(
    periodic: &mut Periodic,
    forces: &[Vec<f64>],
    shapes: &DMatrix<f64>,
    speed: f64,
    step: f64,
) -> Result<Run> {
    let (modes, samples) = (forces.len(), forces[0].len());
    let stepper = &mut periodic.stepper;
    let mut state = stepper.released(&vec![0.0; modes], &vec![0.0; modes])?;
    let mut inputs = Inputs::steady(speed, modes);
    let mut advance = |state: &mut SectionState, now: usize| {
        let next = (now + 1) % samples;
        for (m, force) in forces.iter().enumerate() {
            inputs.force[m] = force[now];
            inputs.force_rate[m] = (force[next] - force[now]) / step;
        }
        stepper.advance(state, &inputs, step)
    };
    for i in 0..samples {
        advance(&mut state, i)?;
    }
    let left = DVector::from_column_slice(&state.values);
    let start = periodic.less_one_period.solve(&left).ok_or_else(|| {
        Error::Numerical("buffeting: the motion does not repeat itself with the record".into())
    })?;
    state.values.copy_from_slice(start.as_slice());
    let mut rows = vec![Vec::with_capacity(samples); shapes.nrows()];
    for i in 0..samples {
        advance(&mut state, i)?;
        for (row, values) in rows.iter_mut().enumerate() {
            let shape = shapes.row(row);
            let value: f64 = shape
                .iter()
                .zip(&state.values)
                .map(|(phi, x)| phi * x)
                .sum();
            values.push(value);
        }
    }
    let statistics = |values: &Vec<f64>| {
        let mean = values.iter().sum::<f64>() / samples as f64;
        let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / samples as f64;
        let peak = values.iter().map(|x| (x - mean).abs()).fold(0.0, f64::max);
        (square, peak)
    };
    Ok(rows.iter().map(statistics).collect())
}

fn gathered(speed_m_s: f64, plan: &SpanPlan, nodes: &[usize], runs: &[Run]) -> SpanEnsemble {
    let count = runs.len() as f64;
    let of = |row: usize| {
        let mean = runs.iter().map(|r| r[row].0).sum::<f64>() / count;
        let scatter = runs.iter().map(|r| (r[row].0 - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let rms = mean.sqrt();
        let peak = runs.iter().map(|r| r[row].1).sum::<f64>() / count;
        [rms, (scatter / count).sqrt() / (2.0 * rms), peak / rms]
    };
    let list = |which: usize| -> Vec<[f64; 3]> {
        (0..nodes.len())
            .map(|n| std::array::from_fn(|i| of(3 * n + i)[which]))
            .collect()
    };
    SpanEnsemble {
        speed_m_s,
        plan: *plan,
        nodes: nodes.to_vec(),
        rms: list(0),
        standard_error: list(1),
        peak_factor: list(2),
    }
}
