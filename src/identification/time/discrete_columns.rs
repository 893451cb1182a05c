//! Regressor columns of the discrete model for one record: the recursion (2.33).

use super::pass::{Columns, Piece};
use crate::identification::least_squares::BLOCK_ROWS;

/// Columns of the discrete model; a candidate is a decay factor for each input.
pub(crate) struct DiscreteColumns {
    /// `√α` and `√(1 − α)` of each candidate and input.
    gains: Vec<Vec<(f64, f64)>>,
    filters: usize,
    /// The constant, if there is one.
    ones: Option<Vec<f64>>,
    /// Filter states at the last sample, one vector a candidate and input.
    states: Vec<Vec<Vec<f64>>>,
    /// Filter columns of the candidate asked for last, one stretch of [`BLOCK_ROWS`] a filter, one vector an input.
    columns: Vec<Vec<f64>>,
}

impl DiscreteColumns {
    /// `filters` columns an input; `constant` puts a column of ones in front.
    pub fn new(alphas: &[Vec<f64>], filters: usize, constant: bool) -> Self {
        let gains = |a: &f64| (a.sqrt(), (1.0 - a).sqrt());
        let inputs = alphas.first().map_or(0, Vec::len);
        Self {
            gains: alphas
                .iter()
                .map(|a| a.iter().map(gains).collect())
                .collect(),
            filters,
            ones: constant.then(|| vec![1.0; BLOCK_ROWS]),
            states: vec![vec![vec![0.0; filters]; inputs]; alphas.len()],
            columns: vec![vec![0.0; filters * BLOCK_ROWS]; inputs],
        }
    }
}

/// One filter of a chain after the other, each over the whole piece: the recursions only look back.
fn advance((root, gain): (f64, f64), state: &mut [f64], motion: &[f64], out: &mut [f64]) {
    let rows = motion.len();
    let mut last = state[0];
    for (x, v) in out[..rows].iter_mut().zip(motion) {
        last = root * last + gain * v;
        *x = last;
    }
    let mut before = std::mem::replace(&mut state[0], last);
    for l in 1..state.len() {
        let (head, tail) = out.split_at_mut(l * BLOCK_ROWS);
        let below = &head[(l - 1) * BLOCK_ROWS..][..rows];
        let (mut last, mut previous) = (state[l], before);
        for (x, b) in tail[..rows].iter_mut().zip(below) {
            last = root * (last + b) - previous;
            previous = *b;
            *x = last;
        }
        before = std::mem::replace(&mut state[l], last);
    }
}

impl Columns for DiscreteColumns {
    fn candidates(&self) -> usize {
        self.gains.len()
    }

    fn advance(&mut self, _: &Piece<'_>, _: &[usize]) {}

    fn columns<'a>(
        &'a mut self,
        piece: &Piece<'a>,
        candidate: usize,
        active: &[usize],
    ) -> Vec<&'a [f64]> {
        for &j in active {
            let state = &mut self.states[candidate][j];
            let gains = self.gains[candidate][j];
            advance(gains, state, piece.motion[j], &mut self.columns[j]);
        }
        let rows = piece.rows();
        let mut columns: Vec<&[f64]> = Vec::new();
        columns.extend(self.ones.as_ref().map(|ones| &ones[..rows]));
        for l in 0..self.filters {
            let stretch = l * BLOCK_ROWS..l * BLOCK_ROWS + rows;
            columns.extend(active.iter().map(|&j| &self.columns[j][stretch.clone()]));
        }
        columns.extend(&piece.force);
        columns
    }
}
