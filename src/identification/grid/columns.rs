//! Columns of the discrete model for many decay factors in one pass: records are read, scaled and resampled once.

use crate::identification::least_squares::BLOCK_ROWS;
use crate::identification::time::accumulate::Columns;
use crate::identification::time::slices::Slice;

/// Filters (2.33) of several decay factors after a column of ones.
pub(super) struct DiscreteGridColumns {
    /// `√α` and `√(1 − α)` of each candidate.
    gains: Vec<(f64, f64)>,
    filters: usize,
    ones: Vec<f64>,
    /// Filter states at the last sample, one vector a candidate and input.
    states: Vec<Vec<Vec<f64>>>,
    /// Filter columns of the candidate asked for last, one stretch an input.
    columns: Vec<Vec<f64>>,
    motion: Vec<Vec<f64>>,
    force: Vec<Vec<f64>>,
    rows: usize,
}

impl DiscreteGridColumns {
    pub fn new(inputs: usize, filters: usize, alphas: &[f64]) -> Self {
        Self {
            gains: alphas
                .iter()
                .map(|a| (a.sqrt(), (1.0 - a).sqrt()))
                .collect(),
            filters,
            ones: vec![1.0; BLOCK_ROWS],
            states: vec![vec![vec![0.0; filters]; inputs]; alphas.len()],
            columns: vec![vec![0.0; filters * BLOCK_ROWS]; inputs],
            motion: vec![Vec::with_capacity(BLOCK_ROWS); inputs],
            force: vec![Vec::with_capacity(BLOCK_ROWS); inputs],
            rows: 0,
        }
    }
}

impl Columns for DiscreteGridColumns {
    fn candidates(&self) -> usize {
        self.gains.len()
    }

    fn advance(&mut self, slice: &Slice<'_>, _: &[usize]) {
        self.rows = slice.rows();
        let channels = self.motion.iter_mut().zip(&slice.motion);
        for (copy, samples) in channels.chain(self.force.iter_mut().zip(&slice.force)) {
            copy.clear();
            copy.extend_from_slice(samples);
        }
    }

    fn columns(&mut self, candidate: usize, active: &[usize]) -> Vec<&[f64]> {
        let (root, gain) = self.gains[candidate];
        for &j in active {
            let state = &mut self.states[candidate][j];
            let out = &mut self.columns[j];
            // one filter after the other, each over the whole slice: the recursions of a chain only look back
            let mut last = state[0];
            for (x, v) in out[..self.rows].iter_mut().zip(&self.motion[j]) {
                last = root * last + gain * v;
                *x = last;
            }
            let mut before = state[0];
            state[0] = last;
            for l in 1..self.filters {
                let (head, tail) = out.split_at_mut(l * BLOCK_ROWS);
                let below = &head[(l - 1) * BLOCK_ROWS..][..self.rows];
                let (mut old, first) = (state[l], before);
                before = state[l];
                let mut previous = first;
                for (x, b) in tail[..self.rows].iter_mut().zip(below) {
                    old = root * (old + b) - previous;
                    previous = *b;
                    *x = old;
                }
                state[l] = old;
            }
        }
        let mut columns: Vec<&[f64]> = vec![&self.ones[..self.rows]];
        for l in 0..self.filters {
            let stretch = l * BLOCK_ROWS..l * BLOCK_ROWS + self.rows;
            columns.extend(active.iter().map(|&j| &self.columns[j][stretch.clone()]));
        }
        columns.extend(self.force.iter().map(Vec::as_slice));
        columns
    }
}
