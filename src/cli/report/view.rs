//! What a report reads of `summary.json`.

use crate::flutter::Onset;
use crate::section::Dof;
use crate::study::SpeedRange;
use crate::units::ReducedFrequencyRange;
use crate::verdict::Verdict;
use serde::Deserialize;

/// What is read of `summary.json`.
#[derive(Deserialize)]
pub(super) struct SummaryView {
    pub(super) generator: String,
    pub(super) study: String,
    pub(super) study_file: String,
    pub(super) deck: String,
    pub(super) licence: String,
    /// The model that the verdict is about.
    pub(super) model: String,
    pub(super) verdict: Verdict,
    pub(super) comparisons: Vec<String>,
    pub(super) onsets: Vec<Onset>,
    pub(super) undetermined: Vec<Onset>,
    pub(super) fits: Vec<FitView>,
    pub(super) speeds: SpeedRange,
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
