//! Regressor columns of the discrete model for one record: the recursion (2.33).

use super::accumulate::Columns;
use super::slices::Slice;
use crate::identification::least_squares::BLOCK_ROWS;

/// Columns of the discrete model; a candidate is a decay factor for each input.
pub(crate) struct DiscreteColumns {
    /// One chain a candidate and input.
    chains: Vec<Vec<Recursion>>,
    filters: usize,
    /// The constant, if there is one.
    ones: Option<Vec<f64>>,
    force: Vec<Vec<f64>>,
    rows: usize,
}

/// One chain of filters driven by one motion.
struct Recursion {
    root: f64,
    gain: f64,
    /// Filter states at the last sample.
    state: Vec<f64>,
    /// States over the slice, one stretch of [`BLOCK_ROWS`] a filter.
    columns: Vec<f64>,
}

impl DiscreteColumns {
    /// `filters` columns an input; `constant` puts a column of ones in front.
    pub fn new(alphas: &[Vec<f64>], filters: usize, constant: bool) -> Self {
        let chain = |alpha: &f64| Recursion {
            root: alpha.sqrt(),
            gain: (1.0 - alpha).sqrt(),
            state: vec![0.0; filters],
            columns: vec![0.0; filters * BLOCK_ROWS],
        };
        let inputs = alphas.first().map_or(0, Vec::len);
        Self {
            chains: alphas
                .iter()
                .map(|a| a.iter().map(chain).collect())
                .collect(),
            filters,
            ones: constant.then(|| vec![1.0; BLOCK_ROWS]),
            force: vec![Vec::with_capacity(BLOCK_ROWS); inputs],
            rows: 0,
        }
    }
}

impl Recursion {
    fn advance(&mut self, motion: &[f64]) {
        let (state, out) = (&mut self.state, &mut self.columns);
        for (k, v) in motion.iter().enumerate() {
            let mut before = state[0];
            let mut new = self.root * before + self.gain * v;
            state[0] = new;
            out[k] = new;
            for l in 1..state.len() {
                let old = state[l];
                new = self.root * (old + new) - before;
                before = old;
                state[l] = new;
                out[l * BLOCK_ROWS + k] = new;
            }
        }
    }
}

impl Columns for DiscreteColumns {
    fn candidates(&self) -> usize {
        self.chains.len()
    }

    fn advance(&mut self, slice: &Slice<'_>, active: &[usize]) {
        self.rows = slice.rows();
        for of_inputs in &mut self.chains {
            for &j in active {
                of_inputs[j].advance(slice.motion[j]);
            }
        }
        for (copy, samples) in self.force.iter_mut().zip(&slice.force) {
            copy.clear();
            copy.extend_from_slice(samples);
        }
    }

    fn columns(&mut self, candidate: usize, active: &[usize]) -> Vec<&[f64]> {
        let mut columns: Vec<&[f64]> = Vec::new();
        columns.extend(self.ones.as_ref().map(|ones| &ones[..self.rows]));
        let chains = &self.chains[candidate];
        for l in 0..self.filters {
            let stretch = l * BLOCK_ROWS..l * BLOCK_ROWS + self.rows;
            columns.extend(active.iter().map(|&j| &chains[j].columns[stretch.clone()]));
        }
        columns.extend(self.force.iter().map(Vec::as_slice));
        columns
    }
}
