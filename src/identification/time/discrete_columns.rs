//! Regressor columns of the discrete model for one record: the recursion (2.33).

use super::pass::{Columns, Piece};
use crate::aerodynamics::laguerre::Recursion;
use crate::identification::least_squares::BLOCK_ROWS;

/// Columns of the discrete model; a candidate is a decay factor for each input.
pub(crate) struct DiscreteColumns {
    /// One a candidate and input.
    recursions: Vec<Vec<Recursion>>,
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
    pub(crate) fn new(alphas: &[Vec<f64>], filters: usize, constant: bool) -> Self {
        let recursions = |alphas: &Vec<f64>| alphas.iter().map(|a| Recursion::new(*a)).collect();
        let inputs = alphas.first().map_or(0, Vec::len);
        Self {
            recursions: alphas.iter().map(recursions).collect(),
            filters,
            ones: constant.then(|| vec![1.0; BLOCK_ROWS]),
            states: vec![vec![vec![0.0; filters]; inputs]; alphas.len()],
            columns: vec![vec![0.0; filters * BLOCK_ROWS]; inputs],
        }
    }
}

impl Columns for DiscreteColumns {
    fn candidates(&self) -> usize {
        self.recursions.len()
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
            let recursion = self.recursions[candidate][j];
            recursion.advance(state, piece.motion[j], &mut self.columns[j], BLOCK_ROWS);
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
