//! Accumulation of regressor rows over records: only the inputs that move take columns, weights are applied to whole
//! chunks after they have been factored, and one pass serves many candidate models.

use super::layout::Layout;
use super::motion_start::MotionStart;
use super::slices::{Event, Scaled, Slice};
use super::stretches::{Closed, settle, stretch_ends, weight};
use crate::error::{Error, Result};
use crate::identification::least_squares::{Factor, StreamingQr};
use crate::identification::options::TimeWeights;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Makes the columns of one record, slice after slice.
pub(crate) trait Columns {
    /// Number of candidate models.
    fn candidates(&self) -> usize;
    /// Takes the next slice; inputs that are not `active` have been zero so far.
    fn advance(&mut self, slice: &Slice<'_>, active: &[usize]);
    /// Columns of a candidate for the active inputs, in the order of [`Layout`], followed by one a force. Called once a
    /// slice and candidate, with the candidates in order.
    fn columns(&mut self, candidate: usize, active: &[usize]) -> Vec<&[f64]>;
}

/// How to accumulate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plan {
    pub layout: Layout,
    pub weights: TimeWeights,
    /// Resample to this dimensionless step.
    pub delta_s: Option<f64>,
    /// Seconds at the start that only settle the filters.
    pub discard_s: f64,
    /// Every how many samples a row is taken.
    pub stride: usize,
    /// Into how many stretches every segment is cut that are kept apart; 0 keeps none.
    pub stretches: usize,
}

/// Systems of one candidate, one a set of inputs that moved together and force.
pub(crate) struct Totals {
    sets: BTreeMap<Vec<usize>, Vec<StreamingQr>>,
}

/// The same, factored.
pub(crate) struct Factored {
    pub layout: Layout,
    /// Inputs that moved together, and the system of their columns for each force.
    pub sets: Vec<(Vec<usize>, Vec<Factor>)>,
    /// The whole system for each force.
    pub whole: Vec<Factor>,
}

/// Result of one pass.
pub(crate) struct Accumulated {
    /// One a candidate.
    pub systems: Vec<Factored>,
    /// Samples before the motion starts, one number a record, at the step of the pass.
    pub still_samples: Vec<usize>,
}

/// One pass over all records; one system a candidate. `make` builds the columns of a record, `done` is called after
/// each record with the number of those that are through.
///
/// # Errors
/// Those of reading, and records without samples.
pub(crate) fn accumulate<'a, C: Columns>(
    records: &[Scaled<'a>],
    plan: &Plan,
    make: &(dyn Fn(&Scaled<'a>) -> Result<C> + Sync),
    done: &(dyn Fn(usize) + Sync),
) -> Result<Accumulated> {
    let parts = each_record(records, plan, make, done)?;
    // merged in the order of the records, whatever the order in which they were done
    let mut by_candidate: Vec<Vec<Totals>> = Vec::new();
    let mut still_samples = Vec::with_capacity(records.len());
    for part in parts {
        still_samples.push(part.still_samples);
        for (c, totals) in part.totals.into_iter().enumerate() {
            if by_candidate.len() <= c {
                by_candidate.push(Vec::new());
            }
            by_candidate[c].push(totals);
        }
    }
    Ok(Accumulated {
        systems: by_candidate
            .into_iter()
            .map(|parts| Factored::merge(plan.layout, parts))
            .collect(),
        still_samples,
    })
}

/// What one record yields: its totals, or its stretches where they are kept, and the samples before its motion starts.
pub(super) struct Part {
    totals: Vec<Totals>,
    pub closed: Vec<Closed>,
    still_samples: usize,
}

pub(super) fn each_record<'a, C: Columns>(
    records: &[Scaled<'a>],
    plan: &Plan,
    make: &(dyn Fn(&Scaled<'a>) -> Result<C> + Sync),
    done: &(dyn Fn(usize) + Sync),
) -> Result<Vec<Part>> {
    let finished = std::sync::atomic::AtomicUsize::new(0);
    records
        .par_iter()
        .map(|record| {
            let totals = one_record(record, plan, &mut make(record)?);
            done(1 + finished.fetch_add(1, std::sync::atomic::Ordering::Relaxed));
            totals
        })
        .collect()
}

fn one_record<C: Columns>(record: &Scaled<'_>, plan: &Plan, make: &mut C) -> Result<Part> {
    let mut boundaries = match plan.weights {
        _ if plan.stretches > 0 => stretch_ends(record, plan.stretches),
        TimeWeights::PerSegment => record.segment_starts(),
        _ => Vec::new(),
    };
    boundaries.push(plan.discard_s);
    boundaries.sort_by(f64::total_cmp);
    let step = plan.delta_s.map_or(record.step_s, |d| d / record.rate);
    let discard = (plan.discard_s / step).ceil() as usize;
    let mut totals: Vec<Totals> = (0..make.candidates())
        .map(|_| Totals {
            sets: BTreeMap::new(),
        })
        .collect();
    let mut chunk = Chunk::new(plan.layout.inputs);
    let mut active: Vec<usize> = Vec::new();
    let mut closed: Vec<Closed> = Vec::new();
    let mut start = MotionStart::default();
    let mut rows = 0;
    record.stream(plan.delta_s, &boundaries, &mut |event| {
        match event {
            Event::Boundary => chunk.close(plan, &mut totals, &mut closed),
            Event::Samples(slice) => {
                start.take(&slice);
                let moving = activate(&slice, &mut active);
                make.advance(&slice, &active);
                if slice.first >= discard {
                    chunk.begin(slice.first as f64 * step);
                    chunk.take(&slice, moving, plan, &active, make);
                    rows += slice.rows();
                }
            }
        }
        Ok(())
    })?;
    chunk.close(plan, &mut totals, &mut closed);
    let least = plan.layout.width(1).max(16) * plan.stride;
    if rows < least {
        return Err(Error::input(
            format!("record {}", record.name()),
            format!("at least {least} samples after discard_s"),
            rows.to_string(),
        ));
    }
    settle(&mut closed, record, plan.weights);
    Ok(Part {
        totals,
        closed,
        still_samples: start.still_samples(),
    })
}

/// Adds the inputs that begin to move in this slice to `active`; returns from which row on something has moved.
fn activate(slice: &Slice<'_>, active: &mut Vec<usize>) -> usize {
    let at_rest = active.is_empty();
    let mut first = slice.rows();
    for (j, motion) in slice.motion.iter().enumerate() {
        if let Some(row) = motion.iter().position(|x| *x != 0.0) {
            first = first.min(row);
            if !active.contains(&j) {
                active.push(j);
            }
        }
    }
    active.sort_unstable();
    if at_rest { first } else { 0 }
}

/// Rows of one record that share their weights.
struct Chunk {
    /// Inputs, and one system a candidate with all forces as right-hand sides.
    sets: Vec<(Vec<usize>, Vec<StreamingQr>)>,
    /// Sum of squares of each force while something moved.
    squares: Vec<f64>,
    rows: usize,
    strided: Vec<Vec<f64>>,
    /// Instant of the first row, s.
    start_s: f64,
}

impl Chunk {
    fn new(forces: usize) -> Self {
        Self {
            sets: Vec::new(),
            squares: vec![0.0; forces],
            rows: 0,
            strided: Vec::new(),
            start_s: 0.0,
        }
    }

    /// Notes the instant of the first row.
    fn begin(&mut self, time_s: f64) {
        if self.sets.is_empty() {
            self.start_s = time_s;
        }
    }

    fn take<C: Columns>(
        &mut self,
        slice: &Slice<'_>,
        moving: usize,
        plan: &Plan,
        active: &[usize],
        make: &mut C,
    ) {
        let forces = plan.layout.inputs;
        if self.sets.last().is_none_or(|(set, _)| set != active) {
            let empty = StreamingQr::new(plan.layout.width(active.len()), forces);
            self.sets
                .push((active.to_vec(), vec![empty; make.candidates()]));
        }
        let Some((_, systems)) = self.sets.last_mut() else {
            return;
        };
        for (candidate, system) in systems.iter_mut().enumerate() {
            let columns = make.columns(candidate, active);
            if candidate == 0 {
                let filtered = &columns[columns.len() - forces..];
                for (sum, force) in self.squares.iter_mut().zip(filtered) {
                    *sum += force[moving..].iter().map(|x| x * x).sum::<f64>();
                }
                self.rows += slice.rows() - moving;
            }
            if plan.stride == 1 {
                system.push_columns(&columns);
            } else {
                let skip = (plan.stride - slice.first % plan.stride) % plan.stride;
                self.strided.resize(columns.len(), Vec::new());
                for (to, from) in self.strided.iter_mut().zip(&columns) {
                    to.clear();
                    to.extend(from.iter().skip(skip).step_by(plan.stride));
                }
                let rows: Vec<&[f64]> = self.strided.iter().map(Vec::as_slice).collect();
                system.push_columns(&rows);
            }
        }
    }

    /// Hands the rows over with the weight of each force, and starts anew.
    fn close(&mut self, plan: &Plan, totals: &mut [Totals], closed: &mut Vec<Closed>) {
        let weights: Vec<f64> = self
            .squares
            .iter()
            .map(|sum| match plan.weights {
                TimeWeights::None => 1.0,
                _ => weight(self.rows, *sum),
            })
            .collect();
        let stretch = closed.last().map_or(0, |c| c.stretch + 1);
        let last = self.sets.len().saturating_sub(1);
        for (at, (set, systems)) in self.sets.drain(..).enumerate() {
            let factors: Vec<Factor> = systems.into_iter().map(StreamingQr::finish).collect();
            if plan.stretches > 0 {
                let own = at == last;
                closed.push(Closed {
                    record: 0,
                    stretch,
                    segment: None,
                    start_s: self.start_s,
                    set,
                    factors,
                    weights: weights.clone(),
                    squares: self
                        .squares
                        .iter()
                        .map(|s| if own { *s } else { 0.0 })
                        .collect(),
                    moving_rows: if own { self.rows } else { 0 },
                });
                continue;
            }
            for (factor, totals) in factors.iter().zip(totals.iter_mut()) {
                totals.add(&set, factor, &weights);
            }
        }
        *self = Self::new(plan.layout.inputs);
    }
}

impl Totals {
    fn add(&mut self, set: &[usize], factor: &Factor, weights: &[f64]) {
        let columns = factor.columns();
        let own: Vec<usize> = (0..columns).collect();
        let systems = self
            .sets
            .entry(set.to_vec())
            .or_insert_with(|| vec![StreamingQr::new(columns, 1); weights.len()]);
        for (i, (system, weight)) in systems.iter_mut().zip(weights).enumerate() {
            system.absorb(factor, &own, i, *weight);
        }
    }
}

impl Factored {
    /// The systems of one candidate from stretches that were kept apart.
    pub fn from_stretches<'a>(
        layout: Layout,
        stretches: impl Iterator<Item = &'a Closed>,
        candidate: usize,
    ) -> Self {
        let mut totals = Totals {
            sets: BTreeMap::new(),
        };
        for closed in stretches {
            totals.add(&closed.set, &closed.factors[candidate], &closed.weights);
        }
        Self::merge(layout, vec![totals])
    }

    fn merge(layout: Layout, parts: Vec<Totals>) -> Self {
        let mut sets: BTreeMap<Vec<usize>, Vec<StreamingQr>> = BTreeMap::new();
        for part in parts {
            for (set, systems) in part.sets {
                let own: Vec<usize> = (0..layout.width(set.len())).collect();
                let into = sets
                    .entry(set)
                    .or_insert_with(|| vec![StreamingQr::new(own.len(), 1); layout.inputs]);
                for (into, system) in into.iter_mut().zip(systems) {
                    into.absorb(&system.finish(), &own, 0, 1.0);
                }
            }
        }
        let sets: Vec<(Vec<usize>, Vec<Factor>)> = sets
            .into_iter()
            .map(|(set, systems)| (set, systems.into_iter().map(StreamingQr::finish).collect()))
            .collect();
        let whole = (0..layout.inputs)
            .map(|i| {
                let mut all = StreamingQr::new(layout.width(layout.inputs), 1);
                for (set, factors) in &sets {
                    all.absorb(&factors[i], &layout.map(set), 0, 1.0);
                }
                all.finish()
            })
            .collect();
        Self {
            layout,
            sets,
            whole,
        }
    }

    /// Whether no record moves two degrees of freedom at once, so that every transfer function has its own rows.
    pub fn single_motions(&self) -> bool {
        self.sets.iter().all(|(set, _)| set.len() < 2)
    }

    /// The rows in which only input `j` moves, for force `i`.
    pub fn alone(&self, i: usize, j: usize) -> Option<&Factor> {
        self.sets
            .iter()
            .find(|(set, _)| set == &[j])
            .map(|(_, factors)| &factors[i])
    }

    /// Root mean square, over forces and sets of inputs, of the weighted residual relative to the weighted data, with the
    /// first `per_input` columns of each input. Where one input moves alone, only the transfer functions `among` count.
    pub fn objective(&self, per_input: usize, among: &dyn Fn(usize, usize) -> bool) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (set, factors) in self.sets.iter().filter(|(set, _)| !set.is_empty()) {
            let leading = usize::from(self.layout.constant) + per_input * set.len();
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
