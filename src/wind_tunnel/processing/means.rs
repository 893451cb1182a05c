//! Static and gravity means, from the rest before the motion.
//!
//! In still air a resting model leaves gravity and the offsets of the cells, in wind the static wind force on top: each
//! recording loses its own mean, and the difference of the two is the static wind force. The part of the gravity moment that
//! turns with the model (its centre of gravity swings by θ) is no mean: it is the same in both recordings and leaves with the
//! inertia. When the model never rests, the mean over the whole recording is taken. The motion, too, counts from where it rests.

use super::segmentation::HarmonicSegment;
use super::signals::SectionSignals;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A rest at least this long is used, s.
const REST_AT_LEAST_S: f64 = 0.5;

/// Means that were removed; each lift (N), drag (N), moment (N·m) on the whole model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RemovedMeans {
    /// In wind.
    pub in_wind: [f64; 3],
    /// In still air: gravity and offsets.
    pub still_air: [f64; 3],
    /// Difference of the two: static wind force, and what the offsets drifted between the recordings.
    pub static_wind: [f64; 3],
    /// The same over `½ρV²BL` and `½ρV²B²L`.
    pub static_coefficients: [f64; 3],
    /// Samples averaged over.
    pub samples: Range<usize>,
    /// Whether they are a rest.
    pub at_rest: bool,
}

/// The samples before the first segment if they are long enough, or all.
pub fn rest(segments: &[HarmonicSegment], signals: &SectionSignals) -> (Range<usize>, bool) {
    let first = segments.first().map_or(0.0, |s| s.segment.start_s);
    if first >= REST_AT_LEAST_S {
        (0..(first * signals.sampling_hz) as usize, true)
    } else {
        (0..signals.len(), false)
    }
}

/// Removes from each force and each motion its mean over `range`; returns those of the forces.
pub fn remove_means(signals: &mut SectionSignals, range: &Range<usize>) -> [f64; 3] {
    for motion in &mut signals.motion {
        remove_mean(motion, range);
    }
    std::array::from_fn(|d| remove_mean(&mut signals.force[d], range))
}

fn remove_mean(x: &mut [f64], range: &Range<usize>) -> f64 {
    let stretch = &x[range.start.min(x.len())..range.end.min(x.len())];
    let mean = stretch.iter().sum::<f64>() / stretch.len().max(1) as f64;
    x.iter_mut().for_each(|v| *v -= mean);
    mean
}
