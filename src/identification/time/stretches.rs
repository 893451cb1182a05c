//! Records factored stretch by stretch: what a covariance that allows for correlated residuals is made from.

use super::accumulate::{Columns, Plan, each_record};
use super::slices::Scaled;
use crate::error::Result;
use crate::identification::least_squares::Factor;

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

/// One pass over all records that keeps every stretch apart, in the order of the records.
///
/// # Errors
/// As [`super::accumulate::accumulate`].
pub(crate) fn stretches<'a, C: Columns>(
    records: &[Scaled<'a>],
    plan: &Plan,
    make: &(dyn Fn(&Scaled<'a>) -> Result<C> + Sync),
    done: &(dyn Fn(usize) + Sync),
) -> Result<Vec<Closed>> {
    let plan = Plan {
        keep_stretches: true,
        ..*plan
    };
    let mut all = Vec::new();
    let parts = each_record(records, &plan, make, done)?;
    for (record, (_, closed)) in parts.into_iter().enumerate() {
        all.extend(closed.into_iter().map(|c| Closed { record, ..c }));
    }
    Ok(all)
}

/// Where stretches end: at the beginning of every segment but the first, or at even distances without segments.
pub(super) fn stretch_ends(record: &Scaled<'_>) -> Vec<f64> {
    if record.has_segments() {
        record.segment_starts()
    } else {
        (1..MAX_STRETCHES).map(|i| i as f64 * STRETCH_S).collect()
    }
}

/// Gives all stretches the weights of their record.
pub(super) fn weigh_by_record(closed: &mut [Closed]) {
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
