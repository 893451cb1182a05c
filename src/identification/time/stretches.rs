//! Records factored stretch by stretch: what a covariance that allows for correlated residuals is made from.

use super::accumulate::{Columns, Plan, each_record};
use super::slices::Scaled;
use crate::error::Result;
use crate::identification::least_squares::Factor;
use crate::identification::options::TimeWeights;
use crate::wind_tunnel::Segment;

/// Length of the stretches of a record without segments, s: many times the memory of the forces.
const STRETCH_S: f64 = 10.0;
/// Greatest number of such stretches; the last takes the rest.
const MAX_STRETCHES: usize = 2000;

/// A stretch of one record between two boundaries, factored by itself.
pub(crate) struct Closed {
    /// Index of the record.
    pub record: usize,
    /// Number of the stretch in its record.
    pub stretch: usize,
    /// Segment it lies in; `None` in a record without segments.
    pub segment: Option<usize>,
    /// Instant of its first row, s.
    pub start_s: f64,
    /// Inputs that moved.
    pub set: Vec<usize>,
    /// One factor a candidate, all forces as right-hand sides.
    pub factors: Vec<Factor>,
    /// Weight of each force.
    pub weights: Vec<f64>,
    /// Sum of squares of each force while something moved.
    pub squares: Vec<f64>,
    /// Rows in which something moved.
    pub moving_rows: usize,
}

/// One pass over all records that keeps every stretch apart, in the order of the records; `plan.stretches` says how
/// many a segment.
///
/// # Errors
/// As [`super::accumulate::accumulate`].
pub(crate) fn stretches<'a, C: Columns>(
    records: &[Scaled<'a>],
    plan: &Plan,
    make: &(dyn Fn(&Scaled<'a>) -> Result<C> + Sync),
    done: &(dyn Fn(usize) + Sync),
) -> Result<Vec<Closed>> {
    let mut all = Vec::new();
    let parts = each_record(records, plan, make, done)?;
    for (record, part) in parts.into_iter().enumerate() {
        all.extend(part.closed.into_iter().map(|c| Closed { record, ..c }));
    }
    Ok(all)
}

/// Where stretches end: at the beginning of every segment and at even distances in it, or at even distances without
/// segments.
pub(super) fn stretch_ends(record: &Scaled<'_>, parts: usize) -> Vec<f64> {
    let segments = record.segments();
    if segments.is_empty() {
        return (1..MAX_STRETCHES).map(|i| i as f64 * STRETCH_S).collect();
    }
    let inner = segments.iter().flat_map(|s| {
        let length = s.end_s - s.start_s;
        (1..parts).map(move |i| s.start_s + length * i as f64 / parts as f64)
    });
    record.segment_starts().into_iter().chain(inner).collect()
}

/// Finds the segments of the stretches and gives all stretches of one segment, or of one record, the same weights.
pub(super) fn settle(closed: &mut [Closed], record: &Scaled<'_>, weights: TimeWeights) {
    let segments = record.segments();
    for stretch in closed.iter_mut() {
        // rest before the first segment belongs to it; half a step, since boundaries fall between samples
        let begun = |s: &&Segment| s.start_s <= stretch.start_s + 0.5 * record.step_s;
        let last = segments.iter().take_while(begun).count().saturating_sub(1);
        stretch.segment = (!segments.is_empty()).then_some(last);
    }
    let same: fn(&Closed, &Closed) -> bool = match weights {
        TimeWeights::None => return,
        TimeWeights::PerRecord => |_, _| true,
        TimeWeights::PerSegment => |a, b| match (a.segment, b.segment) {
            (Some(a), Some(b)) => a == b,
            // a record without segments is one
            _ => true,
        },
    };
    let mut first = 0;
    while first < closed.len() {
        let count = closed[first..]
            .iter()
            .take_while(|c| same(&closed[first], c))
            .count();
        weigh_alike(&mut closed[first..first + count]);
        first += count;
    }
}

fn weigh_alike(closed: &mut [Closed]) {
    let rows: usize = closed.iter().map(|c| c.moving_rows).sum();
    let forces = closed.first().map_or(0, |c| c.squares.len());
    let weights: Vec<f64> = (0..forces)
        .map(|i| weight(rows, closed.iter().map(|c| c.squares[i]).sum()))
        .collect();
    for stretch in closed {
        stretch.weights.clone_from(&weights);
    }
}

/// `1/RMS`; one for a force that is zero throughout, which cannot be scaled by its size.
pub(super) fn weight(rows: usize, sum: f64) -> f64 {
    if sum == 0.0 {
        1.0
    } else {
        (rows as f64 / sum).sqrt()
    }
}
