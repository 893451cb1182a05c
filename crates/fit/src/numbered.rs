//! The one way through many samples, records or cells, each of which is a function of its own number: random numbers come from a
//! stream of that number ([`random_stream`](crate::signal::random_stream)), so that neither the number of threads nor their order
//! matters.

use crate::error::Result;
use aerodeck_core::threads;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Called with how many are done and how many there are, from any thread, before and after each part; it may unwind to end the work.
pub type OnDone<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// The values of the numbers below `count`, in their order, over the cores of the current pool.
///
/// # Errors
/// That of the lowest number that has one, whichever is met first.
pub fn numbered<T: Send>(
    count: usize,
    progress: OnDone<'_>,
    value: impl Fn(usize) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    numbered_in_parts(&mut vec![(); count], 1, progress, |number, _| value(number))
}

/// The same for what is so quick that a thread takes a `part` of it at once: `fill` gets the first number and the places of the part,
/// and what it gives stands in the order of the parts.
///
/// # Errors
/// As [`numbered`].
pub(crate) fn numbered_in_parts<V: Send, T: Send>(
    places: &mut [V],
    part: usize,
    progress: OnDone<'_>,
    fill: impl Fn(usize, &mut [V]) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let total = places.len();
    let (done, failed) = (AtomicUsize::new(0), AtomicUsize::new(usize::MAX));
    let found = threads::in_parts(places, part, |number, places| {
        if number > failed.load(Ordering::Relaxed) {
            return None;
        }
        // who wants no more need not wait for what has not begun
        progress(done.load(Ordering::Relaxed), total);
        let count = places.len();
        let found = fill(number * part, places);
        if found.is_err() {
            failed.fetch_min(number, Ordering::Relaxed);
        }
        progress(count + done.fetch_add(count, Ordering::Relaxed), total);
        Some(found)
    });
    // parts are left out only behind one that failed
    found.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use std::sync::Mutex;

    #[test]
    fn values_stand_in_their_order_and_all_are_counted() {
        let told = Mutex::new(Vec::new());
        let tell = |done, total| told.lock().unwrap().push((done, total));
        let squares = numbered(100, &tell, |i| Ok(i * i)).unwrap();
        assert_eq!(squares, (0..100).map(|i| i * i).collect::<Vec<_>>());
        let told = told.into_inner().unwrap();
        assert_eq!((told.len(), told.iter().max()), (200, Some(&(100, 100))));
        let mut places = vec![0; 10];
        let firsts = numbered_in_parts(&mut places, 4, &|_, _| (), |first, places| {
            let all = places.iter_mut().zip(first..);
            all.for_each(|(place, number)| *place = number);
            Ok((first, places.len()))
        });
        assert_eq!(firsts.unwrap(), [(0, 4), (4, 4), (8, 2)]);
        assert_eq!(places, (0..10).collect::<Vec<_>>());
    }

    #[test]
    fn the_error_is_that_of_the_lowest_number() {
        for _ in 0..20 {
            let failing = |i: usize| match i % 7 {
                6 => Err(Error::Numerical(i.to_string())),
                _ => Ok(i),
            };
            let error = numbered(200, &|_, _| (), failing).unwrap_err();
            assert_eq!(error.to_string(), Error::Numerical("6".into()).to_string());
        }
    }
}
