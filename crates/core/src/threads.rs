//! Work on all threads, as long as the process is ours.

use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

static ALONE: AtomicBool = AtomicBool::new(false);

/// From now on no work is shared among threads: the process is that of an importer, whose threads are its own affair, and which may
/// unload this library at any time. Results do not depend on it.
pub fn stay_on_the_callers() {
    ALONE.store(true, Ordering::Relaxed);
}

/// What `find` makes of each item, in their order; on all threads where that is `worth` it.
pub(crate) fn each<T: Sync, U: Send>(
    of: &[T],
    worth: bool,
    find: impl Fn(&T) -> U + Send + Sync,
) -> Vec<U> {
    if worth && !ALONE.load(Ordering::Relaxed) {
        return of.par_iter().map(find).collect();
    }
    of.iter().map(find).collect()
}
