//! Which columns of the accumulated systems belong to the model: all candidates have as many columns an input as the
//! transfer function with the most filters needs, the others leave their last ones out.

use super::accumulate::Factored;
use crate::identification::least_squares::Factor;
use std::borrow::Cow;
use std::rc::Rc;

/// Columns in use, and the systems they are taken from: one for all forces, or one a force.
pub(crate) struct Selection {
    /// Columns of every transfer function, row by row.
    pub counts: Vec<usize>,
    pub systems: Vec<Rc<Factored>>,
}

impl Selection {
    /// Number of degrees of freedom.
    fn n(&self) -> usize {
        self.systems[0].layout.inputs
    }

    /// The systems that hold the rows of force `i`.
    pub fn of_force(&self, i: usize) -> &Factored {
        &self.systems[if self.systems.len() == 1 { 0 } else { i }]
    }

    /// Number of columns of a transfer function.
    pub fn count(&self, i: usize, j: usize) -> usize {
        self.counts[i * self.n() + j]
    }

    /// Columns of the whole system that force `i` uses.
    fn columns(&self, i: usize) -> Vec<usize> {
        let layout = self.of_force(i).layout;
        let constant = layout.constant.then_some(0);
        let used = (0..layout.per_input).flat_map(|c| {
            (0..self.n())
                .filter(move |&j| c < self.count(i, j))
                .map(move |j| layout.index(c, j))
        });
        constant.into_iter().chain(used).collect()
    }

    /// The whole system of force `i`.
    pub fn whole(&self, i: usize) -> Cow<'_, Factor> {
        reduced(&self.of_force(i).whole[i], &self.columns(i))
    }

    /// Place of column `c` of motion `j` in the whole system of force `i`.
    pub fn place(&self, i: usize, c: usize, j: usize) -> Option<usize> {
        let wanted = self.of_force(i).layout.index(c, j);
        self.columns(i).iter().position(|&column| column == wanted)
    }

    /// Places of all columns of motion `j` in the whole system of force `i`.
    pub fn places(&self, i: usize, j: usize) -> Vec<usize> {
        let all = 0..self.count(i, j);
        all.filter_map(|c| self.place(i, c, j)).collect()
    }

    /// The rows in which only motion `j` moves, for force `i`, when no record moves two at once.
    pub fn alone(&self, i: usize, j: usize) -> Option<Cow<'_, Factor>> {
        let systems = self.of_force(i);
        let factor = systems.alone(i, j).filter(|_| systems.single_motions())?;
        let columns: Vec<usize> = (0..systems.layout.leading_alone(self.count(i, j))).collect();
        Some(reduced(factor, &columns))
    }
}

fn reduced<'a>(factor: &'a Factor, columns: &[usize]) -> Cow<'a, Factor> {
    if columns.len() == factor.columns() {
        Cow::Borrowed(factor)
    } else {
        Cow::Owned(factor.select(columns))
    }
}
