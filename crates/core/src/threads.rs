//! Work on all threads, as long as the process is ours.

#[cfg(not(target_family = "wasm"))]
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
    let share = worth && !ALONE.load(Ordering::Relaxed);
    #[cfg(not(target_family = "wasm"))]
    if share {
        return of.par_iter().map(find).collect();
    }
    // where there is one thread, there is nothing to share
    let _ = share;
    of.iter().map(find).collect()
}
