//! The pass over the records for the sampled filters of a grid.

use super::columns::DiscreteGridColumns;
use crate::error::{Error, Result};
use crate::identification::options::TimeWeights;
use crate::identification::records::{OnProgress, Progress};
use crate::identification::time::accumulate::Plan;
use crate::identification::time::layout::Layout;
use crate::identification::time::slices::Scaled;
use crate::identification::time::stretches::{Closed, stretches};

/// Factored stretches of all decay factors at once, with the columns of their systems.
pub(super) fn discrete_pass(
    records: &[Scaled<'_>],
    inputs: usize,
    (alphas, weights): (&[f64], TimeWeights),
    (filters, delta_s): (usize, f64),
    progress: OnProgress<'_>,
) -> Result<(Layout, Vec<Closed>)> {
    if let Some(bad) = alphas.iter().find(|a| !(**a > 0.0 && **a < 1.0)) {
        return Err(Error::input("alpha", "0 < alpha < 1", bad.to_string()));
    }
    let layout = Layout {
        inputs,
        per_input: filters,
        constant: true,
    };
    let plan = Plan {
        layout,
        weights,
        delta_s: Some(delta_s),
        discard_s: 0.0,
        stride: 1,
        stretches: 1,
    };
    let make = |_: &Scaled<'_>| Ok(DiscreteGridColumns::new(inputs, filters, alphas));
    let done = report(progress, records.len());
    Ok((layout, stretches(records, &plan, &make, &done)?))
}

/// Progress of the one pass.
pub(super) fn report(progress: OnProgress<'_>, records: usize) -> impl Fn(usize) + Sync + '_ {
    move |records_done| {
        progress(Progress {
            pass: 1,
            passes: 1,
            records_done,
            records,
        });
    }
}
