//! The aerodynamic filters along a given motion.

use super::course::{COEFFICIENTS, MotionCubic};
use crate::aerodynamics::{ContinuousRealization, DiscreteRealization};
use crate::error::{Error, Result};
use nalgebra::DMatrix;

/// Largest product of time and size of the filter matrix in one Taylor series: eighteen terms reach the last digit.
const REACH: f64 = 1.0;
/// Terms at most; the last is below rounding.
const TERMS: usize = 24;
/// Parts of one step, or samples in it, at most, over all strips: some ten milliseconds.
const MAX_PARTS: f64 = 1e4;
/// What each of many strips may take of them nevertheless.
const PARTS_OF_A_STRIP: f64 = 100.0;

/// Where the filters go: along `courses` (one per degree of freedom, dimensionless), whose time begins where they are now.
pub(super) struct MotionInterval<'a> {
    pub courses: &'a [MotionCubic],
    pub duration_s: f64,
    /// `V/B`, 1/s.
    pub rate_per_s: f64,
    /// Strips that go such ways in one step.
    pub strips: usize,
}

/// Buffers of one Taylor series.
#[derive(Debug, Clone, Default)]
pub(super) struct Buffers {
    term: Vec<f64>,
    next: Vec<f64>,
}

/// `ż = (V/B)(A z + B r)` to the end of the way, exact to rounding: the solution is entire, and its Taylor series at
/// the start of each part follows from the equation itself.
pub(super) fn advance_continuous(
    c: &ContinuousRealization,
    size: f64,
    state: &mut [f64],
    way: &MotionInterval,
    buffers: &mut Buffers,
) -> Result<()> {
    let parts = parts(way, way.duration_s * way.rate_per_s * size / REACH)?;
    let part_s = way.duration_s / parts;
    for part in 0..parts as usize {
        let start = part as f64 * part_s;
        series(c, state, way, start, part_s, buffers);
    }
    grown(state)
}

fn parts(way: &MotionInterval, count: f64) -> Result<f64> {
    let at_most = (MAX_PARTS / way.strips.max(1) as f64).max(PARTS_OF_A_STRIP);
    if count <= at_most {
        return Ok(count.ceil().max(1.0));
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

fn series(
    c: &ContinuousRealization,
    state: &mut [f64],
    way: &MotionInterval,
    start: f64,
    part_s: f64,
    buffers: &mut Buffers,
) {
    let Buffers { term, next } = buffers;
    term.clear();
    term.extend_from_slice(state);
    let mut power = 1.0;
    for k in 0..TERMS {
        next.clear();
        next.resize(state.len(), 0.0);
        add_product(&c.a, term, next);
        if let Some(entry) = power_of(k) {
            for (j, course) in way.courses.iter().enumerate() {
                let driven = course.from(start).coefficients()[entry] * power;
                for (sum, b) in next.iter_mut().zip(&c.b.column(j)) {
                    *sum += b * driven;
                }
            }
        }
        power *= part_s;
        let factor = way.rate_per_s * part_s / (k as f64 + 1.0);
        let mut moved = false;
        for (z, new) in state.iter_mut().zip(next.iter_mut()) {
            *new *= factor;
            let before = *z;
            *z += *new;
            moved |= *z != before;
        }
        std::mem::swap(term, next);
        // all of the course has acted, and what follows is smaller
        if !moved && power_of(k + 1).is_none() {
            break;
        }
    }
}

/// Coefficient of a course that drives term `k`.
fn power_of(k: usize) -> Option<usize> {
    (k < COEFFICIENTS).then_some(k)
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

/// `S(k+1) = A S(k) + B r(k+1)` at every sample on the way, one each `Δs`; `phase` is the part of `Δs` since the last.
pub(super) fn advance_discrete(
    d: &DiscreteRealization,
    state: &mut [f64],
    phase: &mut f64,
    way: &MotionInterval,
    buffers: &mut Buffers,
) -> Result<()> {
    let passed = way.duration_s * way.rate_per_s / d.delta_s;
    parts(way, passed)?;
    let total = *phase + passed;
    let samples = total.floor();
    for sample in 1..=samples as usize {
        let at = (sample as f64 - *phase) / passed * way.duration_s;
        let next = &mut buffers.next;
        next.clear();
        next.resize(state.len(), 0.0);
        add_product(&d.a, state, next);
        for (j, course) in way.courses.iter().enumerate() {
            let motion = course.from(at).coefficients()[0];
            for (sum, b) in next.iter_mut().zip(&d.b.column(j)) {
                *sum += b * motion;
            }
        }
        state.copy_from_slice(next);
    }
    *phase = total - samples;
    grown(state)
}
