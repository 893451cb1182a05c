//! Work on all threads, as long as the process is ours.

#[cfg(not(target_family = "wasm"))]
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

static ALONE: AtomicBool = AtomicBool::new(false);

/// From now on no work is shared among threads: the process is that of an importer, whose threads are its own affair, and which may
/// unload this library at any time. Results do not depend on it.
pub fn stay_on_the_callers() {
    ALONE.store(true, Ordering::Relaxed);
}

/// What `find` makes of each item, in their order; on all threads where that is `worth` it.
pub fn each<T: Sync, U: Send>(of: &[T], worth: bool, find: impl Fn(&T) -> U + Sync) -> Vec<U> {
    numbered(of.len(), worth, |number| find(&of[number]))
}

/// What `find` makes of the numbers below `count`, in their order; on all threads where that is `worth` it.
pub fn numbered<U: Send>(count: usize, worth: bool, find: impl Fn(usize) -> U + Sync) -> Vec<U> {
    if !worth || ALONE.load(Ordering::Relaxed) {
        return (0..count).map(find).collect();
    }
    let found: Vec<Mutex<Option<U>>> = (0..count).map(|_| Mutex::new(None)).collect();
    share(count, &|number| {
        let value = find(number);
        *found[number].lock().unwrap_or_else(PoisonError::into_inner) = Some(value);
    });
    let found = found.into_iter().map(Mutex::into_inner);
    let found = found.filter_map(|value| value.unwrap_or_else(PoisonError::into_inner));
    found.collect()
}

/// What `find` makes of each `part` of the places, with the number of the part, in their order; on all threads.
pub fn in_parts<V: Send, U: Send>(
    places: &mut [V],
    part: usize,
    find: impl Fn(usize, &mut [V]) -> U + Sync,
) -> Vec<U> {
    let parts: Vec<_> = places.chunks_mut(part).map(Mutex::new).collect();
    numbered(parts.len(), true, |number| {
        let place = parts[number].lock();
        find(number, &mut place.unwrap_or_else(PoisonError::into_inner))
    })
}

/// Compiled once, whatever is worked on.
#[cfg(not(target_family = "wasm"))]
fn share(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(work);
}

/// Where there is one thread, there is nothing to share.
#[cfg(target_family = "wasm")]
fn share(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).for_each(work);
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
