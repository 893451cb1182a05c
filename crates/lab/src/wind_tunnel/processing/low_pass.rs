//! The low-pass: zero phase, and the same on motion and force, so that their ratio stays what it was.

use super::options::LowPassOptions;
use super::signals::{HarmonicSegment, highest_hz};
use crate::error::Result;
use crate::signal::ButterworthLowPass;
use serde::{Deserialize, Serialize};

/// Default cut-off over the highest frequency of motion.
const CUTOFF_OVER_HIGHEST: f64 = 2.8;
/// The default stays below this part of the sampling frequency.
const CUTOFF_OVER_SAMPLING: f64 = 0.4;
/// A test point that loses more than this is warned of.
const LOSS_AT_MOST: f64 = 0.01;

/// What the low-pass did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AppliedLowPass {
    /// Order of one passage.
    pub order: usize,
    /// Cut-off of one passage, Hz.
    pub cutoff_hz: f64,
    /// What motion and force keep of their amplitude at the highest frequency of motion, both passages.
    pub kept_at_highest: f64,
}

/// The filter for a run, one passage of it, and what both do; `None` when it is switched off or nothing says where it should cut.
///
/// # Errors
/// [`crate::Error::Input`] naming `run` for a cut-off at or above half the sampling frequency.
pub(super) fn design(
    run: &str,
    options: &LowPassOptions,
    segments: &[HarmonicSegment],
    sampling_hz: f64,
) -> Result<Option<(ButterworthLowPass, AppliedLowPass)>> {
    let highest = highest_hz(segments);
    let default = (CUTOFF_OVER_HIGHEST * highest).min(CUTOFF_OVER_SAMPLING * sampling_hz);
    let cutoff_hz = options.cutoff_hz.unwrap_or(default);
    if options.order == 0 || (options.cutoff_hz.is_none() && segments.is_empty()) {
        return Ok(None);
    }
    let filter = ButterworthLowPass::new(options.order, cutoff_hz, sampling_hz)
        .map_err(|e| e.within(format!("run {run}")))?;
    let applied = AppliedLowPass {
        order: options.order,
        cutoff_hz,
        kept_at_highest: filter.gain(highest, sampling_hz).powi(2),
    };
    Ok(Some((filter, applied)))
}

impl AppliedLowPass {
    /// A warning when a test point is cut down.
    pub(crate) fn warning(&self) -> Option<String> {
        (self.kept_at_highest < 1.0 - LOSS_AT_MOST).then(|| {
            format!(
                "the low-pass at {} Hz leaves {:.1} % of motion and force at the highest frequency of motion",
                self.cutoff_hz,
                100.0 * self.kept_at_highest
            )
        })
    }
}
