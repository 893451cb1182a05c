//! The aerodynamic filters of strips along a given motion.
//!
//! Strips go four at a time through the same operations, each in its own lane, so that its numbers do not depend on its
//! neighbours. Where many strips lie in one flow, all go by one matrix: what unit numbers become on the same way.

use super::StripFlow;
use super::course::{COEFFICIENTS, MotionCubic};
use crate::aerodynamics::{DiscreteRealization, Realization};
use crate::error::{Error, Result};
use crate::response::{LANES, Sparse};
use nalgebra::DMatrix;

/// Largest product of time and size of the filter matrix in one Taylor series: eighteen terms reach the last digit.
const REACH: f64 = 1.0;
/// Terms at most; the last is below rounding.
const TERMS: usize = 24;
/// Parts of one step, or samples in it, at most, over all strips: some ten milliseconds.
const MAX_PARTS: f64 = 1e4;
/// What each of many strips may take of them nevertheless.
const PARTS_OF_A_STRIP: f64 = 100.0;
/// Strips in one flow for each number of a strip, from which on a matrix is worth making.
const STRIPS_OF_A_MATRIX: usize = 2;

/// One number of each of four strips.
type Lanes = [f64; LANES];

/// How far the filters of all strips go.
pub(super) struct FilterAdvance<'a> {
    pub flows: &'a [StripFlow],
    /// Mean wind speed, m/s.
    pub wind_m_s: f64,
    pub duration_s: f64,
}

impl FilterAdvance<'_> {
    /// `V/B` of a strip, 1/s.
    fn rate(&self, flow: &StripFlow) -> f64 {
        self.wind_m_s * flow.wind_factor / flow.width_m
    }
}

/// Filters of up to four strips, and the motion of each that begins where they are now: along `courses` (one per degree of
/// freedom, dimensionless).
#[derive(Debug, Clone, Default)]
pub(super) struct StripLanes {
    /// Strip by strip.
    pub filters: Vec<f64>,
    pub courses: Vec<MotionCubic>,
    /// Part of `Δs` since the last sample.
    pub phases: Lanes,
}

/// `ż = (V/B)(A z + B r)` of a continuous model, exact to rounding: the solution is entire, and its Taylor series at the start
/// of each part follows from the equation itself. Memory of a step.
#[derive(Debug, Clone)]
pub(super) struct FilterSeries {
    a: Sparse,
    b: Sparse,
    filters: usize,
    dofs: usize,
    /// Size of the filter matrix, its largest sum over a row.
    size: f64,
    /// Filters, then coefficients of the courses: those of one power after those of another.
    operand: Vec<Lanes>,
    /// Coefficients from the start of a part on, in powers of the part.
    drive: Vec<Lanes>,
    term: Vec<Lanes>,
    next: Vec<Lanes>,
    /// What unit numbers become, four at a time; empty where each strip goes by itself.
    matrix: Vec<Lanes>,
    /// Of a sampled model.
    sample: Vec<f64>,
}

impl FilterSeries {
    pub(super) fn new(realization: &Realization, dofs: usize) -> Self {
        let none = DMatrix::zeros(0, 0);
        let (a, b) = match realization {
            Realization::Continuous(c) => (&c.a, &c.b),
            Realization::Discrete(_) => (&none, &none),
        };
        let sums = a.row_iter().map(|row| row.iter().map(|x| x.abs()).sum());
        Self {
            filters: a.nrows(),
            dofs,
            size: sums.fold(0.0, f64::max),
            a: Sparse::new(a),
            b: Sparse::new(b),
            operand: Vec::new(),
            drive: vec![[0.0; LANES]; dofs * COEFFICIENTS],
            term: vec![[0.0; LANES]; a.nrows()],
            next: vec![[0.0; LANES]; a.nrows()],
            matrix: Vec::new(),
            sample: Vec::new(),
        }
    }

    /// Makes ready for a step of a continuous model: looks whether it is short enough, and makes its matrix where that is worth it.
    pub(super) fn prepare(&mut self, step: &FilterAdvance) -> Result<()> {
        for flow in step.flows {
            parts(step, self.way(step, flow))?;
        }
        self.matrix.clear();
        let numbers = self.filters + self.drive.len();
        let mut others = step.flows.iter().skip(1);
        let in_one = others.all(|flow| *flow == step.flows[0]);
        let many = step.flows.len() >= STRIPS_OF_A_MATRIX * numbers;
        if !(in_one && many) || self.filters == 0 {
            return Ok(());
        }
        let flows = [step.flows[0]; LANES];
        for first in (0..numbers).step_by(LANES) {
            self.operand.clear();
            self.operand.resize(numbers, [0.0; LANES]);
            let units = self.operand[first..].iter_mut().take(LANES);
            for (lane, unit) in units.enumerate() {
                unit[lane] = 1.0;
            }
            self.series(step, &flows);
            self.matrix.extend_from_slice(&self.operand[..self.filters]);
        }
        Ok(())
    }

    /// Product of time and size of the filter matrix, as a number of parts.
    fn way(&self, step: &FilterAdvance, flow: &StripFlow) -> f64 {
        step.duration_s * step.rate(flow) * self.size / REACH
    }

    /// The filters of a group in these flows go to the end of the step that was made ready.
    pub(super) fn advance(
        &mut self,
        step: &FilterAdvance,
        flows: &[StripFlow],
        group: &mut StripLanes,
    ) -> Result<()> {
        self.load(flows.len(), group);
        if self.matrix.is_empty() {
            self.series(step, flows);
        } else {
            set_product(&mut self.next, &self.matrix, &self.operand);
            self.operand[..self.filters].copy_from_slice(&self.next);
        }
        for (lane, filters) in group.filters.chunks_mut(self.filters.max(1)).enumerate() {
            for (filter, lanes) in filters.iter_mut().zip(&self.operand) {
                *filter = lanes[lane];
            }
        }
        grown(&group.filters)
    }

    fn load(&mut self, strips: usize, group: &StripLanes) {
        self.operand.clear();
        let numbers = self.filters + self.drive.len();
        self.operand.resize(numbers, [0.0; LANES]);
        let (filters, courses) = self.operand.split_at_mut(self.filters);
        for lane in 0..strips {
            let of_strip = &group.filters[lane * self.filters..];
            for (lanes, filter) in filters.iter_mut().zip(of_strip) {
                lanes[lane] = *filter;
            }
            let of_strip = &group.courses[lane * self.dofs..];
            for (j, course) in of_strip[..self.dofs].iter().enumerate() {
                let powers = courses[j..].iter_mut().step_by(self.dofs);
                for (lanes, coefficient) in powers.zip(course.coefficients()) {
                    lanes[lane] = *coefficient;
                }
            }
        }
    }

    /// The filters of the operand go by series, each strip in parts of its own.
    fn series(&mut self, step: &FilterAdvance, flows: &[StripFlow]) {
        let mut of_lane = [1.0; LANES];
        let mut rates = [0.0; LANES];
        for ((parts, rate), flow) in of_lane.iter_mut().zip(&mut rates).zip(flows) {
            *parts = self.way(step, flow).ceil().max(1.0);
            *rate = step.rate(flow);
        }
        let most = of_lane.into_iter().fold(1.0, f64::max) as usize;
        let part_s = of_lane.map(|parts| step.duration_s / parts);
        for part in 0..most {
            let start = part_s.map(|s| part as f64 * s);
            // a strip that has arrived waits for the others
            let x = std::array::from_fn(|lane| {
                let going = (part as f64) < of_lane[lane];
                if going {
                    rates[lane] * part_s[lane]
                } else {
                    0.0
                }
            });
            add_terms(self, [start, part_s], x);
        }
    }

    /// One Taylor series of four strips: where it begins and how long it is, s, and how many widths the wind passes.
    #[inline(always)]
    fn part(&mut self, from: [Lanes; 2], mut x: Lanes) {
        let (filters, courses) = self.operand.split_at_mut(self.filters);
        let (term, next) = (&mut self.term, &mut self.next);
        shift(courses, self.dofs, from, &mut self.drive);
        term.copy_from_slice(filters);
        for k in 0..TERMS {
            self.a.set_lanes(term, next);
            // the coefficient of a course that drives this term
            if let Some(drive) = self.drive.chunks(self.dofs).nth(k) {
                self.b.add_lanes(drive, next);
            }
            let mut change = [0.0; LANES];
            for (z, (term, sum)) in filters.iter_mut().zip(term.iter_mut().zip(&*next)) {
                for lane in 0..LANES {
                    term[lane] = x[lane] / (k as f64 + 1.0) * sum[lane];
                    let before = z[lane];
                    z[lane] += term[lane];
                    change[lane] += (z[lane] - before).abs();
                }
            }
            // all of the course has acted, and what follows is smaller
            if k + 1 >= COEFFICIENTS {
                for lane in 0..LANES {
                    x[lane] = if change[lane] == 0.0 { 0.0 } else { x[lane] };
                }
                if x == [0.0; LANES] {
                    break;
                }
            }
        }
    }

    /// `S(k+1) = A S(k) + B r(k+1)` at every sample on the way, one each `Δs`.
    pub(super) fn advance_sampled(
        &mut self,
        d: &DiscreteRealization,
        step: &FilterAdvance,
        flows: &[StripFlow],
        group: &mut StripLanes,
    ) -> Result<()> {
        let states = group.filters.chunks_mut(d.a.nrows().max(1));
        let strips = states.zip(group.courses.chunks(self.dofs)).zip(flows);
        for (((state, courses), flow), phase) in strips.zip(&mut group.phases) {
            let passed = step.duration_s * step.rate(flow) / d.delta_s;
            parts(step, passed)?;
            let total = *phase + passed;
            let samples = total.floor();
            for sample in 1..=samples as usize {
                let at = (sample as f64 - *phase) / passed * step.duration_s;
                self.sample.clear();
                self.sample.resize(state.len(), 0.0);
                add_product(&d.a, state, &mut self.sample);
                for (j, course) in courses.iter().enumerate() {
                    let motion = course.from(at).coefficients()[0];
                    for (sum, b) in self.sample.iter_mut().zip(&d.b.column(j)) {
                        *sum += b * motion;
                    }
                }
                state.copy_from_slice(&self.sample);
            }
            *phase = total - samples;
        }
        grown(&group.filters)
    }
}

/// Refuses a strip that would need so many parts or samples.
fn parts(step: &FilterAdvance, count: f64) -> Result<()> {
    let at_most = (MAX_PARTS / step.flows.len().max(1) as f64).max(PARTS_OF_A_STRIP);
    if count <= at_most {
        return Ok(());
    }
    Err(Error::input(
        "communication step",
        format!("a step in which the flow passes the filters in at most {at_most:.0} parts"),
        format!("{count:.0}: a shorter step, or a slower wind, is needed"),
    ))
}

fn grown(state: &[f64]) -> Result<()> {
    if state.iter().all(|z| z.is_finite()) {
        Ok(())
    } else {
        Err(Error::Numerical("the motion has overflowed".into()))
    }
}

/// Coefficients of the courses from `start` on, in powers of `length`.
#[inline(always)]
fn shift(courses: &[Lanes], dofs: usize, [start, length]: [Lanes; 2], shifted: &mut [Lanes]) {
    shifted.copy_from_slice(courses);
    for first in 0..COEFFICIENTS {
        for c in (first..COEFFICIENTS - 1).rev() {
            let (lower, higher) = shifted[c * dofs..].split_at_mut(dofs);
            for (lower, higher) in lower.iter_mut().zip(higher) {
                for lane in 0..LANES {
                    lower[lane] += start[lane] * higher[lane];
                }
            }
        }
    }
    let mut power = [1.0; LANES];
    for coefficients in shifted.chunks_mut(dofs) {
        for lanes in coefficients {
            for lane in 0..LANES {
                lanes[lane] *= power[lane];
            }
        }
        for lane in 0..LANES {
            power[lane] *= length[lane];
        }
    }
}

aerodeck_core::vectorised! {
    /// A part of a series: a closure would not always be compiled for each set of vectors.
    fn add_terms<'a>(to: &'a mut FilterSeries, from: [Lanes; 2], x: Lanes) -> () {
        to.part(from, x);
    }

    /// What becomes of the numbers of four strips by a matrix.
    fn set_product<'a>(sums: &'a mut [Lanes], matrix: &'a [Lanes], operand: &'a [Lanes]) -> () {
        let rows = sums.len().max(1);
        sums.fill([0.0; LANES]);
        for (columns, numbers) in matrix.chunks(rows).zip(operand.chunks(LANES)) {
            for (sum, row) in sums.iter_mut().zip(columns) {
                for (entry, number) in row.iter().zip(numbers) {
                    for lane in 0..LANES {
                        sum[lane] += entry * number[lane];
                    }
                }
            }
        }
    }
}

pub(super) fn add_product(matrix: &DMatrix<f64>, vector: &[f64], sum: &mut [f64]) {
    let rows = matrix.nrows();
    for (column, x) in matrix.as_slice().chunks(rows.max(1)).zip(vector) {
        if *x != 0.0 {
            for (s, m) in sum.iter_mut().zip(column) {
                *s += m * x;
            }
        }
    }
}
