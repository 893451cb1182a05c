//! What is no motion: noise of a motion channel while the model rests, and of the channels that nobody drives.
//!
//! A model learns from motion and force together, and a fit may weigh a stretch by the size of its force from the first motion on.
//! Noise of a sensor, or the foot of a filter, is not that first motion. So before the first and after the last segment the motion
//! is zero, and a channel that moves by less than a part of the driven one is zero throughout.

use super::segmentation::HarmonicSegment;
use super::signals::{SectionSignals, index, peak_and_rms};
use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// Motions that nobody drives, RMS over that of the driven one, both without dimensions: vertical, lateral, torsion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CrossTalk {
    /// The parts; 1 for the driven one.
    pub parts: [f64; 3],
    /// Whether the channel was set to zero.
    pub removed: [bool; 3],
}

/// Sets to zero what is no motion; nothing without segments.
pub fn still_the_rest(
    signals: &mut SectionSignals,
    driven: Dof,
    segments: &[HarmonicSegment],
    width_m: f64,
    negligible: f64,
) -> CrossTalk {
    let count = signals.len();
    let size = |d: Dof| {
        let (_, rms) = peak_and_rms(&signals.motion[index(d)]);
        rms * d.motion_scale(width_m)
    };
    let own = size(driven).max(f64::MIN_POSITIVE);
    let parts = Dof::THREE.map(|d| size(d) / own);
    let removed = parts.map(|p| p < negligible);
    let (Some(first), Some(last)) = (segments.first(), segments.last()) else {
        return CrossTalk {
            parts,
            removed: [false; 3],
        };
    };
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
