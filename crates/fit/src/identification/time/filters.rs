//! Regressor columns of the continuous models for one record: low-pass and orthonormal filters as one exactly discretised
//! linear system.
//!
//! Motion and force go through the same fourth-order Butterworth low-pass, whose states are the filtered motion and its
//! derivatives: no sample is differentiated. Low-pass and filters advance together by the exact response to a motion that
//! runs straight from sample to sample (first-order hold), the force through the same low-pass with the same hold. A
//! harmonic motion and its force are thereby distorted alike, up to what the low-pass leaves of the images above half
//! the sampling frequency (about 1e-5 with the default cut-off).

use super::low_pass::{Filtered, LowPassStep, ORDER, hold, low_pass};
use super::pass::{Chunk, Columns};
use super::record::DimensionlessRecord;
use crate::error::{Error, Result, ensure};
use crate::identification::basis::Basis;
use crate::identification::form::FeedThrough;
use crate::identification::least_squares::BLOCK_ROWS;
use aerodeck_core::vectorised;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Step of the filters of one candidate behind the low-pass.
struct FilterStep {
    count: usize,
    /// Lower triangle of the filters' own step, row by row (count×count).
    own: Vec<f64>,
    /// What the low-pass states, the last and the new sample add (count×6).
    drive: Vec<[f64; ORDER + 2]>,
    /// Filter states under a motion of one that has always been there.
    rest: Vec<f64>,
}

impl FilterStep {
    /// `x[k] = own x[k−1] + drive (w[k−1], u[k−1], u[k])` for a whole chunk; `out` holds one stretch of
    /// [`BLOCK_ROWS`] per filter.
    fn advance(&self, input: &Filtered, state: &mut [f64], out: &mut [f64]) {
        drive(self, input, out);
        let rows = input.input.len() - 1;
        match self.count {
            1 => self.recur::<1>(rows, state, out),
            2 => self.recur::<2>(rows, state, out),
            3 => self.recur::<3>(rows, state, out),
            4 => self.recur::<4>(rows, state, out),
            5 => self.recur::<5>(rows, state, out),
            6 => self.recur::<6>(rows, state, out),
            _ => self.recur_by_row(rows, state, out),
        }
    }

    /// The recursion of `N` filters, whose states stay in registers.
    fn recur<const N: usize>(&self, rows: usize, state: &mut [f64], out: &mut [f64]) {
        let own: [[f64; N]; N] =
            std::array::from_fn(|l| std::array::from_fn(|m| self.own[l * N + m]));
        let mut x: [f64; N] = std::array::from_fn(|l| state[l]);
        let out = &mut out[..N * BLOCK_ROWS];
        for k in 0..rows.min(BLOCK_ROWS) {
            let mut next = [0.0; N];
            for l in 0..N {
                let mut sum = own[l][0] * x[0];
                for m in 1..=l {
                    sum += own[l][m] * x[m];
                }
                next[l] = sum + out[l * BLOCK_ROWS + k];
                out[l * BLOCK_ROWS + k] = next[l];
            }
            x = next;
        }
        state.copy_from_slice(&x);
    }

    fn recur_by_row(&self, rows: usize, state: &mut [f64], out: &mut [f64]) {
        for k in 0..rows {
            // from the last filter to the first: each needs the old states of those before it
            for l in (0..self.count).rev() {
                let row = &self.own[l * self.count..l * self.count + l + 1];
                let sum: f64 = row.iter().zip(state.iter()).map(|(p, x)| p * x).sum();
                state[l] = sum + out[l * BLOCK_ROWS + k];
                out[l * BLOCK_ROWS + k] = state[l];
            }
        }
    }
}

vectorised! {
    /// `drive (w[k−1], u[k−1], u[k])`.
    fn drive<'a>(step: &'a FilterStep, input: &'a Filtered, out: &'a mut [f64]) -> () {
        let rows = input.input.len() - 1;
        let [w0, w1, w2, w3] = &input.states;
        for (drive, out) in step.drive.iter().zip(out.chunks_exact_mut(BLOCK_ROWS)) {
            let before = w0.iter().zip(w1).zip(w2.iter().zip(w3));
            let samples = input.input.windows(2);
            for ((x, ((a, b), (c, d))), u) in out[..rows].iter_mut().zip(before).zip(samples) {
                *x = drive[0] * a
                    + drive[1] * b
                    + drive[2] * c
                    + drive[3] * d
                    + drive[4] * u[0]
                    + drive[5] * u[1];
            }
        }
    }
}

/// Columns of the continuous models; a candidate is a basis for each input, all of one length.
pub(crate) struct ContinuousColumns<'a> {
    bases: &'a [Vec<Basis>],
    low_pass: LowPassStep,
    /// One step per candidate and input.
    steps: Vec<Vec<FilterStep>>,
    motion: Vec<Filtered>,
    force: Vec<Filtered>,
    /// Filter states, one vector per candidate and input.
    states: Vec<Vec<Vec<f64>>>,
    /// Filter columns of the candidate asked for last, one stretch per input.
    filters: Vec<Vec<f64>>,
    /// The constant, if there is one.
    ones: Option<Vec<f64>>,
}

impl<'a> ContinuousColumns<'a> {
    /// For one record, with the cut-off in Hz; `constant` puts a column of ones in front.
    ///
    /// # Errors
    /// [`Error::Input`] for a cut-off at or above half the sampling frequency.
    pub(crate) fn new(
        record: &DimensionlessRecord,
        bases: &'a [Vec<Basis>],
        cutoff_hz: f64,
        constant: bool,
    ) -> Result<Self> {
        let name = &record.header.name;
        ensure(
            cutoff_hz * record.step_s < 0.5,
            "low_pass_hz",
            format_args!("less than half the sampling frequency of record {name}"),
            cutoff_hz,
        )?;
        let step = record.delta_s();
        let (a, b) = low_pass(TAU * cutoff_hz / record.rate);
        let hold = hold(&a, &b, step)?;
        let of_candidate = |bases: &Vec<Basis>| {
            let each = bases.iter().map(|basis| filter_step(basis, &a, &b, step));
            each.collect::<Result<Vec<_>>>()
        };
        let steps = bases.iter().map(of_candidate).collect::<Result<Vec<_>>>()?;
        let inputs = bases.first().map_or(0, Vec::len);
        let every = bases.iter().flatten();
        let longest = every.map(|b| b.poles().len()).max().unwrap_or(0);
        let at_rest = |s: &Vec<FilterStep>| s.iter().map(|s| vec![0.0; s.count]).collect();
        Ok(Self {
            bases,
            low_pass: LowPassStep::new(&hold),
            states: steps.iter().map(at_rest).collect(),
            steps,
            motion: (0..inputs).map(|_| Filtered::new()).collect(),
            force: (0..inputs).map(|_| Filtered::new()).collect(),
            filters: vec![vec![0.0; longest * BLOCK_ROWS]; inputs],
            ones: constant.then(|| vec![1.0; BLOCK_ROWS]),
        })
    }
}

fn filter_step(basis: &Basis, a: &DMatrix<f64>, b: &DVector<f64>, step: f64) -> Result<FilterStep> {
    let (own, driven) = basis.filters();
    let count = basis.poles().len();
    let mut joint = DMatrix::zeros(ORDER + count, ORDER + count);
    joint.view_mut((0, 0), (ORDER, ORDER)).copy_from(a);
    let mut behind = joint.rows_mut(ORDER, count);
    behind.columns_mut(0, 2).copy_from(&driven);
    behind.columns_mut(ORDER, count).copy_from(&own);
    let drive = b.clone().resize_vertically(ORDER + count, 0.0);
    let hold = hold(&joint, &drive, step)?;
    let rest = own.lu().solve(&-driven.column(0));
    let rest = rest.ok_or_else(|| Error::Numerical("filters: a pole at zero".into()))?;
    let own = |i| hold.phi[(ORDER + i / count, ORDER + i % count)];
    let drive = |l| {
        std::array::from_fn(|m| match m {
            0..ORDER => hold.phi[(ORDER + l, m)],
            ORDER => hold.gamma_0[ORDER + l],
            _ => hold.gamma_1[ORDER + l],
        })
    };
    Ok(FilterStep {
        count,
        own: (0..count * count).map(own).collect(),
        drive: (0..count).map(drive).collect(),
        rest: rest.as_slice().to_vec(),
    })
}

impl Columns for ContinuousColumns<'_> {
    fn candidates(&self) -> usize {
        self.bases.len()
    }

    fn advance(&mut self, chunk: &Chunk<'_>, active: &[usize]) {
        for &j in active {
            // an input that was zero so far has started from rest, unless the record begins with it
            if chunk.first > 0 {
                self.motion[j].started = true;
            }
            if !self.motion[j].started {
                let first = chunk.motion[j][0];
                for (steps, states) in self.steps.iter().zip(&mut self.states) {
                    states[j] = steps[j].rest.iter().map(|x| x * first).collect();
                }
            }
            self.motion[j].take(chunk.motion[j]);
        }
        for (filter, samples) in self.force.iter_mut().zip(&chunk.force) {
            filter.take(samples);
        }
        let motions = self.motion.iter_mut().enumerate();
        let moving = motions.filter(|(j, _)| active.contains(j));
        let channels = moving.map(|(_, motion)| motion).chain(&mut self.force);
        self.low_pass.advance(channels.collect());
    }

    fn columns<'a>(
        &'a mut self,
        chunk: &Chunk<'a>,
        candidate: usize,
        active: &[usize],
    ) -> Vec<&'a [f64]> {
        for &j in active {
            let state = &mut self.states[candidate][j];
            self.steps[candidate][j].advance(&self.motion[j], state, &mut self.filters[j]);
        }
        let rows = chunk.rows();
        let basis = self.bases[candidate].first();
        let none = (FeedThrough::none(), 0);
        let (feed, count) = basis.map_or(none, |b| (b.feed(), b.poles().len()));
        let mut columns: Vec<&[f64]> = Vec::new();
        columns.extend(self.ones.as_ref().map(|ones| &ones[..rows]));
        for order in feed.orders() {
            columns.extend(active.iter().map(|&j| &self.motion[j].states[order][1..]));
        }
        for l in 0..count {
            let stretch = l * BLOCK_ROWS..l * BLOCK_ROWS + rows;
            columns.extend(active.iter().map(|&j| &self.filters[j][stretch.clone()]));
        }
        columns.extend(self.force.iter().map(|f| &f.states[0][1..]));
        columns
    }
}
