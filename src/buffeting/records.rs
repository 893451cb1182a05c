//! Many records, and what their scatter says.

use crate::error::{Result, ensure};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// More records than any average needs.
const MOST_RECORDS: usize = 100_000;

/// Makes every record of a plan by its own seed, side by side; `progress` gets how many are done and how many there are.
///
/// # Errors
/// [`Error::Input`] for a number of records that cannot be, and those of a record.
pub(super) fn all_records<T: Send>(
    records: usize,
    seed: u64,
    progress: &(dyn Fn(usize, usize) + Sync),
    record: impl Fn(u64) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let expected = format_args!("a number from 2 to {MOST_RECORDS}");
    let fits = (2..=MOST_RECORDS).contains(&records);
    ensure(fits, "records", expected, records)?;
    let done = AtomicUsize::new(0);
    let counted = |i: usize| {
        let run = record(seed.wrapping_add(i as u64));
        progress(1 + done.fetch_add(1, Ordering::Relaxed), records);
        run
    };
    (0..records).into_par_iter().map(counted).collect()
}

/// Root of the mean of the mean squares of records, and its standard error by their scatter.
pub(super) fn root_and_error(squares: &[f64]) -> (f64, f64) {
    let count = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / count;
    let scatter = squares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean.sqrt(), (scatter / count).sqrt() / (2.0 * mean.sqrt()))
}
