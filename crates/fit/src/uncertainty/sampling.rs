//! The one way through many samples, each a function of its own number: its random numbers come from a stream of their own
//! ([`random_stream`](crate::signal::random_stream)), so that neither the number of threads nor their order matters.

use super::statistics::sample_quantile;
use crate::error::Result;
use crate::signal::mean_and_deviation;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Called with the samples done and all of them, from any thread, before and after each part; it may unwind to end the work.
pub type OnSamples<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// The values of `count` samples in the order of their numbers, over the cores of the current pool.
///
/// # Errors
/// That of the sample with the lowest number that has one, whichever is met first.
pub fn sampled<T: Send>(
    count: usize,
    progress: OnSamples<'_>,
    value: impl Fn(usize) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    sampled_in_parts(&mut vec![(); count], 1, progress, |number, _| value(number))
}

/// The same for samples so quick that a thread takes a `part` of them at once: `fill` gets the number of its first sample and
/// the places of its samples, and what it gives stands in the order of the parts.
///
/// # Errors
/// As [`sampled`].
pub(crate) fn sampled_in_parts<V: Send, T: Send>(
    places: &mut [V],
    part: usize,
    progress: OnSamples<'_>,
    fill: impl Fn(usize, &mut [V]) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let total = places.len();
    let (done, failed) = (AtomicUsize::new(0), AtomicUsize::new(usize::MAX));
    let parts = places.par_chunks_mut(part).enumerate();
    let found: Vec<Option<Result<T>>> = parts
        .map(|(number, places)| {
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
        })
        .collect();
    // parts are left out only behind one that failed
    found.into_iter().flatten().collect()
}

/// Onsets of samples, and what they amount to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampledOnsets {
    /// Mean, m/s.
    pub mean_m_s: f64,
    /// Standard deviation, m/s.
    pub standard_deviation_m_s: f64,
    /// 95 % of the samples lie between these, m/s.
    pub interval_m_s: [f64; 2],
    /// Samples without an onset up to the highest wind speed; they are not in the numbers above.
    pub without_onset: usize,
    /// The onset of each sample that has one, m/s, rising.
    #[serde(skip)]
    pub speeds_m_s: Vec<f64>,
}

impl From<Vec<Option<f64>>> for SampledOnsets {
    /// NaN in place of what the onsets are too few for.
    fn from(found: Vec<Option<f64>>) -> Self {
        let mut speeds: Vec<f64> = found.iter().copied().flatten().collect();
        speeds.sort_unstable_by(f64::total_cmp);
        let (mean_m_s, standard_deviation_m_s) = mean_and_deviation(speeds.iter().copied());
        let quantile = |p| sample_quantile(&speeds, speeds.len(), p).unwrap_or(f64::NAN);
        Self {
            mean_m_s,
            standard_deviation_m_s,
            interval_m_s: [0.025, 0.975].map(quantile),
            without_onset: found.len() - speeds.len(),
            speeds_m_s: speeds,
        }
    }
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
        let squares = sampled(100, &tell, |i| Ok(i * i)).unwrap();
        assert_eq!(squares, (0..100).map(|i| i * i).collect::<Vec<_>>());
        let told = told.into_inner().unwrap();
        assert_eq!((told.len(), told.iter().max()), (200, Some(&(100, 100))));
        let mut places = vec![0; 10];
        let firsts = sampled_in_parts(&mut places, 4, &|_, _| (), |first, places| {
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
            let error = sampled(200, &|_, _| (), failing).unwrap_err();
            assert_eq!(error.to_string(), Error::Numerical("6".into()).to_string());
        }
    }

    #[test]
    fn samples_without_an_onset_are_in_no_other_number() {
        let onsets = SampledOnsets::from(vec![Some(3.0), None, Some(1.0)]);
        assert_eq!(onsets.speeds_m_s, [1.0, 3.0]);
        assert_eq!((onsets.without_onset, onsets.mean_m_s), (1, 2.0));
        assert!((onsets.interval_m_s[0] - 1.05).abs() < 1e-12);
        assert!(SampledOnsets::from(vec![None]).interval_m_s[1].is_nan());
    }
}
