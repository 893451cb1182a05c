//! Systems of equations of one candidate model: what all records say of every force, and which columns of it a model has.

use super::pass::{ColumnOrder, Pass, Stretch};
use crate::error::Result;
use crate::identification::basis::Basis;
use crate::identification::dissipative::FitRequirements;
use crate::identification::joint::JointFit;
use crate::identification::least_squares::{Factor, StreamingQr};
use crate::identification::report::{LEAST_NOISE, relative_noise};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Factored systems of one candidate.
pub(crate) struct Systems {
    pub order: ColumnOrder,
    /// Inputs that moved together, and the system of their columns for each force.
    pub sets: Vec<(Vec<usize>, Vec<Factor>)>,
    /// The whole system for each force.
    pub whole: Vec<Factor>,
}

impl Pass {
    /// The systems of all candidates, from all stretches.
    pub(crate) fn systems(&self) -> Vec<Rc<Systems>> {
        let count = self.stretches.first().map_or(0, |s| s.factors.len());
        let all = |c: usize| Rc::new(Systems::new(self.order, self.stretches.iter(), c));
        (0..count).map(all).collect()
    }
}

impl Systems {
    /// The systems of one candidate from weighted stretches: summed record by record, then over the records.
    pub(crate) fn new<'a>(
        order: ColumnOrder,
        stretches: impl Iterator<Item = &'a Stretch>,
        candidate: usize,
    ) -> Self {
        let mut of_records: BTreeMap<(&[usize], usize), Vec<StreamingQr>> = BTreeMap::new();
        let empty = |set: &[usize]| vec![StreamingQr::new(order.width(set.len()), 1); order.inputs];
        for s in stretches {
            let factor = &s.factors[candidate];
            let own: Vec<usize> = (0..factor.columns()).collect();
            let key = (s.set.as_slice(), s.record);
            let into = of_records.entry(key).or_insert_with(|| empty(&s.set));
            for (i, (system, weight)) in into.iter_mut().zip(&s.weights).enumerate() {
                system.absorb(factor, &own, i, *weight);
            }
        }
        let mut of_sets: BTreeMap<&[usize], Vec<StreamingQr>> = BTreeMap::new();
        for ((set, _), systems) in of_records {
            let own: Vec<usize> = (0..order.width(set.len())).collect();
            let into = of_sets.entry(set).or_insert_with(|| empty(set));
            for (into, system) in into.iter_mut().zip(systems) {
                into.absorb(&system.finish(), &own, 0, 1.0);
            }
        }
        let finished = |systems: Vec<StreamingQr>| -> Vec<Factor> {
            systems.into_iter().map(StreamingQr::finish).collect()
        };
        let sets = of_sets.into_iter();
        let sets = sets.map(|(set, systems)| (set.to_vec(), finished(systems)));
        let sets: Vec<(Vec<usize>, Vec<Factor>)> = sets.collect();
        let whole = |i: usize| {
            let mut all = StreamingQr::new(order.width(order.inputs), 1);
            for (set, factors) in &sets {
                all.absorb(&factors[i], &order.columns(|_, j| set.contains(&j)), 0, 1.0);
            }
            all.finish()
        };
        Self {
            order,
            whole: (0..order.inputs).map(whole).collect(),
            sets,
        }
    }

    /// The rows in which only input `j` moves, for force `i`, when no record moves two at once.
    pub(crate) fn alone(&self, i: usize, j: usize) -> Option<&Factor> {
        let single = self.sets.iter().all(|(set, _)| set.len() < 2);
        let mut own = self.sets.iter().filter(|(set, _)| single && set == &[j]);
        own.next().map(|(_, factors)| &factors[i])
    }

    /// Root mean square, over forces and sets of inputs, of the weighted residual relative to the weighted data, with the
    /// first `per_input` columns of each input. Where one input moves alone, only the transfer functions `among` count.
    pub(crate) fn objective(&self, per_input: usize, among: &dyn Fn(usize, usize) -> bool) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (set, factors) in self.sets.iter().filter(|(set, _)| !set.is_empty()) {
            let leading = self.order.leading(per_input, set.len());
            for (i, factor) in factors.iter().enumerate() {
                let wanted = set.len() > 1 || among(i, set[0]);
                if wanted && factor.total_sum(0) > 0.0 {
                    sum += factor.residual_sum(leading, 0) / factor.total_sum(0);
                    count += 1.0;
                }
            }
        }
        (sum / f64::max(count, 1.0)).sqrt()
    }
}

/// The systems that each force is fitted to, one for all forces or one per force, and the columns that its transfer
/// functions have of them: all candidates have as many as the one with the most filters, the others leave their last out.
pub(crate) struct ForceSystems {
    /// Columns of every transfer function, row by row.
    pub counts: Vec<usize>,
    pub systems: Vec<Rc<Systems>>,
}

impl ForceSystems {
    /// The systems that hold the rows of force `i`.
    pub(crate) fn of_force(&self, i: usize) -> &Systems {
        &self.systems[if self.systems.len() == 1 { 0 } else { i }]
    }

    /// Number of columns of a transfer function.
    fn count(&self, i: usize, j: usize) -> usize {
        self.counts[i * self.systems[0].order.inputs + j]
    }

    /// Columns of the whole system that force `i` uses.
    fn columns(&self, i: usize) -> Vec<usize> {
        let order = self.of_force(i).order;
        order.columns(|c, j| c < self.count(i, j))
    }

    /// The whole system of force `i`.
    pub(crate) fn whole(&self, i: usize) -> Cow<'_, Factor> {
        reduced(&self.of_force(i).whole[i], &self.columns(i))
    }

    /// Places of all columns of motion `j` in the whole system of force `i`.
    pub(crate) fn places(&self, i: usize, j: usize) -> Vec<usize> {
        let (order, columns) = (self.of_force(i).order, self.columns(i));
        let place = |c| columns.iter().position(|&at| at == order.index(c, j));
        (0..self.count(i, j)).filter_map(place).collect()
    }

    /// The rows in which only motion `j` moves, for force `i`, when no record moves two at once.
    pub(crate) fn alone(&self, i: usize, j: usize) -> Option<Cow<'_, Factor>> {
        let systems = self.of_force(i);
        let leading = systems.order.leading(self.count(i, j), 1);
        let columns: Vec<usize> = (0..leading).collect();
        Some(reduced(systems.alone(i, j)?, &columns))
    }

    /// All transfer functions in the columns of one basis, fitted to one system and held where the search of poles asks; as
    /// [`Self::held`].
    pub(crate) fn held_alike(
        system: &Rc<Systems>,
        basis: Basis,
        requirements: &FitRequirements,
    ) -> Result<(JointFit, f64)> {
        let entries = system.order.inputs * system.order.inputs;
        let forces = Self {
            counts: vec![basis.len(); entries],
            systems: vec![Rc::clone(system)],
        };
        forces.held(&vec![basis; entries], requirements, false)
    }

    /// All transfer functions in the columns of `bases`, row by row, held together by what is asked of them, and the objective of
    /// that fit. As in the search of poles, the weighted residuals of every transfer function that has rows of its own count
    /// relative to its weighted data, else those of every force, constant included.
    ///
    /// # Errors
    /// Rows that do not determine the coefficients, and constraints that no coefficients satisfy.
    pub(crate) fn held(
        &self,
        bases: &[Basis],
        requirements: &FitRequirements,
        everywhere: bool,
    ) -> Result<(JointFit, f64)> {
        let n = bases.len().isqrt();
        let apart = (0..n).all(|i| (0..n).all(|j| self.alone(i, j).is_some()))
            && !self.of_force(0).order.constant;
        let count = if apart { n * n } else { n } as f64;
        let (mut joint, mut entries, mut sums) = (JointFit::default(), Vec::new(), Vec::new());
        for i in 0..n {
            let factors: Vec<Cow<'_, Factor>> = match apart {
                true => (0..n).filter_map(|j| self.alone(i, j)).collect(),
                false => vec![self.whole(i)],
            };
            for factor in factors {
                let columns = factor.columns();
                let (total, residual) = (factor.total_sum(0), factor.residual_sum(columns, 0));
                let share = if total > 0.0 {
                    let noise = relative_noise(residual, total, factor.rows, columns);
                    (total * count).sqrt().recip() / noise
                } else {
                    1.0
                };
                let values = factor.solve(columns)?.as_slice().to_vec();
                let part = joint.add(values, factor.inverse_upper(columns)? / share, share);
                sums.push([residual, total]);
                if apart {
                    entries.push(part.clone());
                    continue;
                }
                let places = |j| self.places(i, j).into_iter().map(|p| (p, 1.0));
                let picked = |j| part.picked(&places(j).collect::<Vec<_>>());
                entries.extend((0..n).map(picked));
            }
        }
        let joint = joint.held(entries, bases, requirements, everywhere)?;
        let objective = likeliest(&joint, &sums);
        Ok((joint, objective))
    }
}

/// Geometric mean of the relative weighted residuals of parts with the constraints, from the sums of the squares of the residuals without
/// them and of the data: where it is least, the likelihood of data that scatter by themselves each is largest.
fn likeliest(joint: &JointFit, sums: &[[f64; 2]]) -> f64 {
    let (mut logarithms, mut count) = (0.0, 0.0);
    for (part, [residual, total]) in sums.iter().enumerate() {
        if *total > 0.0 {
            let relative = (residual + joint.added(part)) / total;
            logarithms += (relative + LEAST_NOISE * LEAST_NOISE).ln();
            count += 1.0;
        }
    }
    (0.5 * logarithms / f64::max(count, 1.0)).exp()
}

fn reduced<'a>(factor: &'a Factor, columns: &[usize]) -> Cow<'a, Factor> {
    match columns.len() == factor.columns() {
        true => Cow::Borrowed(factor),
        false => Cow::Owned(factor.select(columns)),
    }
}
