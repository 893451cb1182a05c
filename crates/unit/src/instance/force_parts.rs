//! Strips under the forces of one model, and where their numbers stand among those of all strips.

use crate::aerodynamics::Realizable;
use crate::force_options::StripsOfModel;
use crate::prescribed::{PrescribedForces, StripGusts};
use crate::section::Dof;
use std::ops::Range;

/// Strips that lie side by side under the forces of one model. A unit has one of these for each of its models.
#[derive(Debug)]
pub(super) struct StripsUnderModel {
    pub forces: PrescribedForces,
    /// Forces of gusts; none where the unit takes none.
    pub gusts: Option<StripGusts>,
    /// Among all strips.
    pub strips: Range<usize>,
    /// Among all coordinates.
    pub coordinates: Range<usize>,
    /// Their forces among the numbers of the system's state.
    pub state: Range<usize>,
    /// Their gusts among those of the system's state.
    pub lagging: Range<usize>,
    /// Their filters and lagging gusts, strip by strip, among those of all.
    pub inner: Range<usize>,
}

impl StripsUnderModel {
    /// All of a unit whose state of the forces begins behind `before` numbers for itself and three for each coordinate.
    pub(super) fn all(parts: &[StripsOfModel<'_>], before: usize) -> Vec<Self> {
        let coordinates = |p: &StripsOfModel<'_>| p.strips.len() * p.model.section.dofs().len();
        let mut at = before + 3 * parts.iter().map(coordinates).sum::<usize>();
        let (mut coordinate, mut gust, mut inner) = (0, 0, 0);
        let next = |from: &mut usize, count: usize| {
            *from += count;
            *from - count..*from
        };
        let part = |of: &StripsOfModel<'_>| {
            let strips = of.strips.clone();
            let dofs = of.model.section.dofs();
            let forces = PrescribedForces::new(of.model.model.realize(), dofs);
            let gusts = of.gusts.map(StripGusts::new);
            let of_gusts = gusts.as_ref().map_or(0, StripGusts::per_strip);
            Self {
                state: next(&mut at, forces.rest(strips.len()).len()),
                coordinates: next(&mut coordinate, coordinates(of)),
                lagging: next(&mut gust, strips.len() * of_gusts),
                inner: next(&mut inner, strips.len() * of.inner()),
                forces,
                gusts,
                strips,
            }
        };
        parts.iter().map(part).collect()
    }

    /// The part to which strip `s` belongs.
    pub(super) fn new(all: &[Self], s: usize) -> &Self {
        &all[all.partition_point(|part| part.strips.end <= s)]
    }

    /// Coordinates of strip `s`.
    pub(super) fn coordinates_of(&self, s: usize) -> Range<usize> {
        let n = self.forces.dofs().len();
        let first = self.coordinates.start + (s - self.strips.start) * n;
        first..first + n
    }

    /// Filters of strip `s` in the system's state.
    pub(super) fn filters_of(&self, s: usize) -> Range<usize> {
        let own = self.forces.filters(s - self.strips.start);
        self.state.start + own.start..self.state.start + own.end
    }

    /// Gusts of strip `s` in the system's state: those that blow, then those behind each lag.
    pub(super) fn gusts_of(&self, s: usize) -> Range<usize> {
        let per_strip = self.gusts.as_ref().map_or(0, StripGusts::per_strip);
        let first = self.lagging.start + (s - self.strips.start) * per_strip;
        first..first + per_strip
    }

    /// Index of a filter or lagging gust of strip `s` among those of all, by its number among those of the strip.
    pub(super) fn inner_index(&self, s: usize, number: usize) -> usize {
        let per_strip = self.inner.len() / self.strips.len();
        self.inner.start + (s - self.strips.start) * per_strip + number
    }

    /// Strip and number of one of its filters and lagging gusts, by that index.
    pub(super) fn at_inner(&self, index: usize) -> [usize; 2] {
        let per_strip = self.inner.len() / self.strips.len();
        let own = index - self.inner.start;
        [self.strips.start + own / per_strip, own % per_strip]
    }
}

/// Which of all coordinates a degree of freedom of strip `s` is.
pub(super) fn coordinate(parts: &[StripsUnderModel], s: usize, dof: Dof) -> usize {
    let part = StripsUnderModel::new(parts, s);
    let of_strip = part.forces.dofs().iter().position(|d| *d == dof);
    part.coordinates_of(s).start + of_strip.unwrap_or(0)
}
