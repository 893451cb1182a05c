//! The rest of the model: what its means are before the motion, and what of its motion channels is no motion.
//!
//! In still air a resting model leaves gravity and the offsets of the cells, in wind the static wind force on top: each
//! recording loses its own mean, and the difference of the two is the static wind force. The part of the gravity moment that
//! turns with the model (its centre of gravity swings by θ) is no mean: it is the same in both recordings and leaves with the
//! inertia. When the model never rests, the mean over the whole recording is taken. The motion, too, counts from where it rests.
//!
//! A model learns from motion and force together, and a fit may weigh a stretch by the size of its force from the first motion on.
//! Noise of a sensor, or the foot of a filter, is not that first motion. So before the first and after the last segment the motion
//! is zero, and a channel that moves by less than a part of the driven one is zero throughout.

use super::signals::{HarmonicSegment, SectionSignals, index};
use crate::section::Dof;
use crate::signal::{mean, root_mean_square};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Motions that nobody drives, RMS over that of the driven one, both without dimensions: vertical, lateral, torsion.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CrossTalk {
    /// The parts; 1 for the driven one.
    pub parts: [f64; 3],
    /// Whether the channel was set to zero.
    pub removed: [bool; 3],
}

/// Stage 11: sets to zero what is no motion; nothing without segments.
pub(super) fn still_the_rest(
    signals: &mut SectionSignals,
    driven: Dof,
    segments: &[HarmonicSegment],
    width_m: f64,
    negligible: f64,
) -> CrossTalk {
    let count = signals.len();
    let size = |d: Dof| root_mean_square(&signals.motion[index(d)]) * d.motion_scale(width_m);
    let own = size(driven).max(f64::MIN_POSITIVE);
    let parts = Dof::THREE.map(|d| size(d) / own);
    let (Some(first), Some(last)) = (segments.first(), segments.last()) else {
        let removed = [false; 3];
        return CrossTalk { parts, removed };
    };
    let removed = parts.map(|p| p < negligible);
    let rate = signals.sampling_hz;
    let (from, to) = (first.range(rate, count).start, last.range(rate, count).end);
    for (motion, removed) in signals.motion.iter_mut().zip(removed) {
        if removed {
            motion.fill(0.0);
        }
        motion[..from].fill(0.0);
        motion[to..].fill(0.0);
    }
    CrossTalk { parts, removed }
}

/// A rest at least this long is used, s.
const REST_AT_LEAST_S: f64 = 0.5;

/// Means that were removed; each lift (N), drag (N), moment (N·m) on the whole model.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
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

/// The samples that means are taken of, and whether nothing moves there: those before the first segment if they are long enough, or all.
pub(super) fn rest(segments: &[HarmonicSegment], signals: &SectionSignals) -> (Range<usize>, bool) {
    let first = segments.first().map_or(0.0, |s| s.segment.start_s);
    match first >= REST_AT_LEAST_S {
        true => (0..(first * signals.sampling_hz) as usize, true),
        false => (0..signals.len(), false),
    }
}

/// Removes from each force and each motion its mean over `range`; returns those of the forces.
pub(crate) fn remove_means(signals: &mut SectionSignals, range: &Range<usize>) -> [f64; 3] {
    let remove = |x: &mut Vec<f64>| {
        let mean = mean(&x[range.start.min(x.len())..range.end.min(x.len())]);
        x.iter_mut().for_each(|v| *v -= mean);
        mean
    };
    for motion in &mut signals.motion {
        remove(motion);
    }
    signals.force.each_mut().map(remove)
}
