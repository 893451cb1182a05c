//! Readers of others, which may panic on corrupt files: a panic becomes an error and prints nothing.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    /// Whether a panic of this thread is about to become an error.
    static EXPECTED: Cell<bool> = const { Cell::new(false) };
}

/// Once a process, in front of the hook that is there: says nothing of panics that are expected.
static HOOK: Once = Once::new();

/// The result of `body`; `None` when it panicked.
pub(crate) fn guarded<T>(body: impl FnOnce() -> T) -> Option<T> {
    HOOK.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !EXPECTED.get() {
                before(info);
            }
        }));
    });
    let outer = EXPECTED.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(body));
    EXPECTED.set(outer);
    result.ok()
}
