//! What a report reads of `summary.json`.

use crate::flutter::Onset;
use crate::section::Dof;
use crate::study::SpeedRange;
use crate::units::ReducedFrequencyRange;
use serde::{Deserialize, Serialize};

/// What is read of `summary.json`.
#[derive(Deserialize)]
pub(super) struct SummaryView {
    pub(super) generator: String,
    pub(super) study: String,
    pub(super) study_file: String,
    pub(super) deck: String,
    pub(super) licence: String,
    pub(super) answer: AnswerView,
    pub(super) limits: Vec<String>,
    pub(super) comparisons: Vec<String>,
    pub(super) onsets: Vec<Onset>,
    pub(super) undetermined: Vec<Onset>,
    pub(super) fits: Vec<FitView>,
    pub(super) speeds: SpeedRange,
}

/// The answer of a study in words, as `summary.json` holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct AnswerView {
    /// The model the answer is of.
    pub(crate) model: String,
    /// Speed, interval, tested range, in one line.
    pub(crate) headline: String,
    /// Onset, where the data determine one, m/s.
    pub(crate) speed_m_s: Option<f64>,
    /// What the study requires, m/s.
    pub(crate) required_speed_m_s: Option<f64>,
    /// Whether the lower end of the interval (the onset itself where there is none) lies above it.
    pub(crate) required_speed_met: Option<bool>,
}

#[derive(Deserialize)]
pub(super) struct FitView {
    pub(super) model: String,
    pub(super) method: String,
    pub(super) condition: f64,
    pub(super) tested_range: ReducedFrequencyRange,
    pub(super) entries: Vec<EntryView>,
    pub(super) constraints: Option<ConstraintView>,
    pub(super) notes: Vec<String>,
}

#[derive(Deserialize)]
pub(super) struct EntryView {
    pub(super) force: Dof,
    pub(super) motion: Dof,
    pub(super) relative_rms: Option<f64>,
    pub(super) poles: Vec<f64>,
}

#[derive(Deserialize)]
pub(super) struct ConstraintView {
    pub(super) sentences: Vec<String>,
}
