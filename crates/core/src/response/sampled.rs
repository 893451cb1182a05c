//! Steps of the discrete Laguerre model: the dimensionless force is sampled and held every `Δt = Δs B/V`. The dynamic
//! pressure is that of the wind at every instant, so that nothing depends on where communication points fall.

use super::matrix_polynomial::{MatrixPolynomial, terms_of_exponential};
use super::packed::{Packed, apply, flush_subnormals};
use super::sampling::{Sampling, wind_after};
use super::series::{Drive, overgrown};
use super::step_cache::{active_columns, load};
use super::values::{Inputs, SectionState};
use super::{MAX_SUBSTEPS, PARTS_OF_A_MATRIX, SAMPLE_BY_MATRIX, Stepper, too_long};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::state_space::{StateEquation, step_matrix};
use nalgebra::DMatrix;

/// A sample closer to the end of the step than this part of `Δs` is taken: the phase is known to rounding only.
const SAMPLE_TOLERANCE: f64 = 1e-10;
/// Samples at most that one product takes.
const MOST_SAMPLES: f64 = 16.0;
/// A phase ends before the sample that rounding would make it reach.
const LAST_PHASE: f64 = 1.0 - f64::EPSILON;

impl Stepper {
    /// Moves the structure from sample to sample; the last piece ends between two samples.
    pub(super) fn advance_sampled(
        &mut self,
        state: &mut SectionState,
        inputs: &Inputs,
        step: f64,
    ) -> Result<()> {
        let mut next = std::mem::take(&mut self.sampled);
        next.set_to(state);
        let moved = self.move_sampled(&mut next, inputs, step);
        if moved.is_ok() {
            std::mem::swap(state, &mut next);
        }
        self.sampled = next;
        moved
    }

    fn move_sampled(&mut self, next: &mut SectionState, inputs: &Inputs, step: f64) -> Result<()> {
        let way = self.sampling()?.way_m;
        let mean = inputs.wind_speed_m_s + 0.5 * inputs.wind_speed_rate_m_s2 * step;
        let samples = (mean * step / way).ceil();
        let gusts = self.gusts_act(next, inputs);
        let parts = if inputs.wind_speed_rate_m_s2 == 0.0 && !gusts {
            0.0
        } else {
            let fastest = inputs.wind_speed_m_s.max(wind_after(inputs, step));
            self.series.parts(fastest, step, gusts)
        };
        // a wind that stays is worth a matrix for the way from sample to sample
        let known = next.last_wind_m_s == Some(inputs.wind_speed_m_s);
        let stays = inputs.wind_speed_rate_m_s2 == 0.0 && (known || samples > PARTS_OF_A_MATRIX);
        let of_sample = if stays { SAMPLE_BY_MATRIX } else { 1.0 };
        let cost = of_sample * samples + parts;
        if cost.is_nan() || cost > MAX_SUBSTEPS {
            return Err(too_long(step, cost));
        }
        next.last_wind_m_s = Some(inputs.wind_speed_m_s);
        let (mut time, mut remaining) = (0.0, step);
        while remaining > 0.0 {
            let (wind, rate) = (wind_after(inputs, time), inputs.wind_speed_rate_m_s2);
            let wait = time_to_cover((1.0 - next.phase) * way, wind, rate);
            let sampled = remaining >= wait * (1.0 - SAMPLE_TOLERANCE);
            let piece = if sampled { wait } else { remaining };
            if stays && sampled && next.phase == 0.0 && !gusts {
                let count = (remaining / piece + SAMPLE_TOLERANCE).floor();
                let samples = [piece, count.clamp(1.0, MOST_SAMPLES)];
                self.take_samples(next, inputs, time, samples)?;
                let passed = piece * samples[1];
                time += passed;
                remaining = (remaining - passed).max(0.0);
                continue;
            }
            self.move_structure(next, inputs, time, piece)?;
            if sampled {
                self.sampling()?.sample(&mut next.values);
                next.phase = 0.0;
                time += piece;
                remaining = (remaining - piece).max(0.0);
            } else {
                let travelled = (wind + 0.5 * rate * piece) * piece;
                next.phase = (next.phase + travelled / way).clamp(0.0, LAST_PHASE);
                remaining = 0.0;
            }
        }
        if !flush_subnormals(&mut next.values) {
            return Err(overgrown());
        }
        Ok(())
    }

    /// From one sample on, `time` after the start of the step: time between samples, and how many are taken.
    fn take_samples(
        &mut self,
        state: &mut SectionState,
        inputs: &Inputs,
        time: f64,
        samples: [f64; 2],
    ) -> Result<()> {
        let (states, n) = (state.values.len(), inputs.force.len());
        let sampling = self.sampling.as_mut().ok_or_else(not_sampled)?;
        let (section, wind) = (&self.section, inputs.wind_speed_m_s);
        let [between, count] = samples;
        let step = self.samples.get([wind, between, count], || {
            matrix_of_samples(section, sampling, wind, samples)
        })?;
        load(&mut self.operand, &state.values, inputs);
        let force = self.operand[states..].iter_mut().take(n);
        for (w, rate) in force.zip(&inputs.force_rate) {
            *w += rate * time;
        }
        let columns = active_columns(inputs, states);
        apply(step, &self.operand[..columns], &mut state.values);
        Ok(())
    }

    /// Writes the state matrix from one sample to the next in a steady wind on a resting section (`steady`): each number of the
    /// state is stepped by itself. The time between samples, s; `None` for a continuous model and without wind.
    ///
    /// # Errors
    /// As for a step.
    pub fn write_sample_matrix(
        &mut self,
        steady: &Inputs,
        matrix: &mut DMatrix<f64>,
    ) -> Result<Option<f64>> {
        let wind = steady.wind_speed_m_s;
        let Some(sampling) = self.sampling.as_ref().filter(|_| wind > 0.0) else {
            return Ok(None);
        };
        let step = sampling.way_m / wind;
        let mut state = std::mem::take(&mut self.sampled);
        let mut written = Ok(());
        for (j, mut column) in matrix.column_iter_mut().enumerate() {
            state.values.clear();
            state.values.resize(column.len(), 0.0);
            state.values[j] = 1.0;
            state.gusts.clear();
            written = self.move_structure(&mut state, steady, 0.0, step);
            if written.is_err() {
                break;
            }
            self.sampling()?.sample(&mut state.values);
            column.copy_from_slice(&state.values);
        }
        self.sampled = state;
        written.map(|()| Some(step))
    }

    fn sampling(&mut self) -> Result<&mut Sampling> {
        self.sampling.as_mut().ok_or_else(not_sampled)
    }

    /// Structure alone under the force of the filters and the external one, from `time` on.
    fn move_structure(
        &mut self,
        state: &mut SectionState,
        inputs: &Inputs,
        time: f64,
        piece: f64,
    ) -> Result<()> {
        if piece <= 0.0 {
            return Ok(());
        }
        let (wind, force) = self.sampling()?.drive(&state.values, inputs, time);
        let gusts = self.gusts_act(state, inputs);
        let fastest = wind.max(wind_after(inputs, time + piece));
        let parts = self.series.parts(fastest, piece, gusts);
        let motion = &mut state.values[..2 * inputs.force.len()];
        let long = parts > PARTS_OF_A_MATRIX;
        if inputs.wind_speed_rate_m_s2 == 0.0 && !gusts && (long || parts == 1.0) {
            let n = inputs.force.len();
            let operand = &mut self.operand[..4 * n];
            operand[..2 * n].copy_from_slice(motion);
            operand[2 * n..3 * n].copy_from_slice(&force[0][..n]);
            operand[3 * n..].copy_from_slice(&force[1][..n]);
            let step = if long {
                let StateEquation { a, b } = self.section.structure_alone();
                self.steps
                    .get([0.0, piece], || step_matrix(&a, &b, piece))?
            } else {
                let alone = || MatrixPolynomial::exponential(&self.section.structure_alone());
                let steps = self.structure.get_or_insert_with(alone);
                steps.at(piece, terms_of_exponential(self.series.norm(0.0, piece)))
            };
            apply(step, operand, motion);
            return Ok(());
        }
        let drive = Drive {
            inputs,
            after: time,
            wind,
            force: [&force[0], &force[1], &force[2]],
        };
        let lagging = gusts.then_some(state.gusts.as_mut_slice());
        self.series.advance(motion, lagging, &drive, piece, parts)
    }
}

/// So many samples of a sampled model in a steady wind, from one on: what unit numbers of `[z, w, ẇ]` become.
fn matrix_of_samples(
    section: &CoupledSection,
    sampling: &mut Sampling,
    wind: f64,
    [step, count]: [f64; 2],
) -> Result<DMatrix<f64>> {
    let alone = section.structure_alone();
    let structure = Packed::new(&step_matrix(&alone.a, &alone.b, step)?);
    let (states, n) = (section.states(), alone.b.ncols());
    let mut matrix = DMatrix::zeros(states, states + 2 * n);
    for (j, mut column) in matrix.column_iter_mut().enumerate() {
        let mut z = vec![0.0; states + 2 * n];
        z[j] = 1.0;
        let mut external = z.split_off(states);
        for _ in 0..count as usize {
            let mut operand = [&z[..2 * n], &external].concat();
            let forces = operand[2 * n..3 * n].iter_mut();
            for (w, held) in forces.zip(sampling.force(&z, wind)) {
                *w += held;
            }
            apply(&structure, &operand, &mut z[..2 * n]);
            sampling.sample(&mut z);
            let (w, rates) = external.split_at_mut(n);
            w.iter_mut()
                .zip(rates)
                .for_each(|(w, rate)| *w += *rate * step);
        }
        column.copy_from_slice(&z);
    }
    Ok(matrix)
}

fn not_sampled() -> Error {
    Error::Numerical("step: the model is not sampled".into())
}

/// Time in which the wind covers `distance`, starting at `wind` with the acceleration `rate`; infinite if never.
fn time_to_cover(distance: f64, wind: f64, rate: f64) -> f64 {
    if rate == 0.0 {
        return if wind > 0.0 {
            distance / wind
        } else {
            f64::INFINITY
        };
    }
    let discriminant = wind * wind + 2.0 * rate * distance;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    let sum = wind + discriminant.sqrt();
    if sum > 0.0 {
        2.0 * distance / sum
    } else {
        f64::INFINITY
    }
}
