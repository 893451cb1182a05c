//! Inertia, and what gravity does to the turning model, removed by subtracting the still-air recording.
//!
//! `F_se = F_wind − F_still`, sample by sample, after both are in global axes, about the centre of rotation and in step. The mass
//! of the air that moves with the model in still air leaves with it: the derivatives are those of wind against still air, as
//! in every such test.

use super::signals::{SectionSignals, peak_and_rms};
use serde::{Deserialize, Serialize};

/// What the subtraction took.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RemovedInertia {
    /// RMS of what was subtracted: N, N, N·m.
    pub removed_rms: [f64; 3],
    /// RMS of what is left.
    pub left_rms: [f64; 3],
}

/// `in_wind − still_air`.
pub fn subtract(in_wind: &mut SectionSignals, still_air: &SectionSignals) -> RemovedInertia {
    for (wind, still) in in_wind.force.iter_mut().zip(&still_air.force) {
        wind.iter_mut().zip(still).for_each(|(w, s)| *w -= s);
    }
    let rms = |s: &SectionSignals| std::array::from_fn(|d| peak_and_rms(&s.force[d]).1);
    RemovedInertia {
        removed_rms: rms(still_air),
        left_rms: rms(in_wind),
    }
}
