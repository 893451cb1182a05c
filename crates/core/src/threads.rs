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

/// Functions of which the widest version that the processor has runs: what they call is to be `#[inline(always)]`. The order of
/// the sums, and so the bits, are the same in all versions.
///
/// ```
/// aerodeck_core::vectorised! {
///     /// Adds one vector to another.
///     fn add<'a>(to: &'a mut [f64], from: &'a [f64]) -> () {
///         for (t, f) in to.iter_mut().zip(from) {
///             *t += f;
///         }
///     }
/// }
/// let mut to = [1.0, 2.0];
/// add(&mut to, &[0.5, 0.5]);
/// assert_eq!(to, [1.5, 2.5]);
/// ```
#[macro_export]
macro_rules! vectorised {
    ($($(#[$meta:meta])* $vis:vis fn $name:ident$(<$life:lifetime>)?($($arg:ident: $ty:ty),* $(,)?) -> $ret:ty $body:block)+) => {$(
        $(#[$meta])*
        $vis fn $name$(<$life>)?($($arg: $ty),*) -> $ret {
            struct Call$(<$life>)?($($ty),*);
            impl$(<$life>)? ::pulp::NullaryFnOnce for Call$(<$life>)? {
                type Output = $ret;
                #[inline(always)]
                fn call(self) -> $ret {
                    let Self($($arg),*) = self;
                    $body
                }
            }
            ::pulp::Arch::new().dispatch(Call($($arg),*))
        }
    )+};
}
