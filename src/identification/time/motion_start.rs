//! When a motion begins, found while the samples stream past.

use super::slices::Slice;

/// A motion counts as still while it is closer to its first value than this fraction of its largest departure from it:
/// the rest of a rig is not perfectly quiet.
const STILL: f64 = 0.01;
/// The departure has to grow by this ratio to be remembered.
const GROWTH: f64 = 1.01;

/// Departures of the dimensionless motion from its first value, over all inputs.
#[derive(Default)]
pub(super) struct MotionStart {
    first: Vec<f64>,
    /// Sample and departure, each larger than the one before.
    records: Vec<(usize, f64)>,
    samples: usize,
}

impl MotionStart {
    pub fn take(&mut self, slice: &Slice<'_>) {
        if self.samples == 0 {
            self.first = slice.motion.iter().map(|m| m[0]).collect();
        }
        let mut largest = self.records.last().map_or(0.0, |(_, d)| *d);
        for k in 0..slice.rows() {
            let departures = slice.motion.iter().zip(&self.first);
            let departure = departures.fold(0.0, |d: f64, (m, first)| d.max((m[k] - first).abs()));
            if departure > GROWTH * largest {
                largest = departure;
                self.records.push((slice.first + k, departure));
            }
        }
        self.samples += slice.rows();
    }

    /// Number of samples before the motion starts; all of them when it never does.
    pub fn still_samples(&self) -> usize {
        let largest = self.records.last().map_or(0.0, |(_, d)| *d);
        let start = self.records.iter().find(|(_, d)| *d > STILL * largest);
        start.map_or(self.samples, |(sample, _)| *sample)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn still(motion: &[Vec<f64>], block: usize) -> usize {
        let mut start = MotionStart::default();
        for first in (0..motion[0].len()).step_by(block) {
            let end = (first + block).min(motion[0].len());
            start.take(&Slice {
                motion: motion.iter().map(|m| &m[first..end]).collect(),
                force: Vec::new(),
                first,
            });
        }
        start.still_samples()
    }

    /// Noise of 0.2 % in both channels and an offset; the sine starts at sample 300 and passes 1 % of its amplitude there.
    #[test]
    fn noise_and_offsets_are_still() {
        let noise = |k: usize| 0.002 * (12.9898 * k as f64).sin();
        let moving = |k: usize| 3.0 + noise(k) + (0.3 * (k as f64 - 300.0).max(0.0)).sin();
        let idle: Vec<f64> = (0..2000).map(noise).collect();
        let motion = [(0..2000).map(moving).collect(), idle];
        for block in [1, 7, 256, 2000] {
            assert_eq!(still(&motion, block), 301, "{block}");
        }
        assert_eq!(still(&[vec![0.5; 100]], 30), 100);
        assert_eq!(still(&[vec![0.0, 1.0, -1.0]], 3), 1);
    }
}
