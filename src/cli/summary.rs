//! `summary.json` of a study.

use super::stages::FMU_FILE;
use super::vocabulary::{Finding, FlutterStudy, Recommendation, Verdict};
use crate::identification::FitReport;
use crate::study::{KnownUncertainty, SpeedRange, SteppedOnset};
use crate::verdict::StageFailure;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What `summary.json` holds.
#[derive(Serialize, Deserialize)]
pub(crate) struct Summary {
    /// Program and version.
    pub generator: String,
    /// Day of the run, unless a file of an earlier version says none.
    #[serde(default)]
    pub date: Option<String>,
    /// Name of the study.
    pub study: String,
    /// File of the study in this folder.
    pub study_file: String,
    /// Its text as it was run.
    pub study_text: String,
    /// SHA-1 of the files that its page takes up, by name; of the FMU, of the description in it.
    pub sha1: BTreeMap<String, String>,
    /// The model that the verdict is about.
    pub model: String,
    /// The one that the study has selected, where it does.
    #[serde(default)]
    pub selection: Option<Recommendation>,
    /// What it amounts to.
    pub verdict: Verdict,
    /// How models and routes compare.
    pub comparisons: Vec<String>,
    /// What the aerodynamics come from.
    pub deck: String,
    /// Licence of the data.
    pub licence: String,
    /// What was assumed in reading the deck, what looks wrong in it, and values of the study that look implausible.
    pub warnings: Vec<String>,
    /// The implausible ones among these, each with its place, value and reason.
    pub findings: Vec<Finding>,
    /// Wind speeds of curves and searches.
    pub speeds: SpeedRange,
    /// What was found, but for the curves, which are a file of their own.
    #[serde(flatten)]
    pub results: FlutterStudy,
    /// The fits in short.
    pub fits: Vec<FitSummary>,
    /// The FMU stepped through its C interface.
    pub stepped: Option<SteppedOnset>,
    /// Response to the turbulence of the study, in a line.
    #[serde(default)]
    pub buffeting: Option<String>,
    /// Stages that failed, and why; the others are complete.
    pub failed: Vec<StageFailure>,
    /// Files written.
    pub files: Vec<PathBuf>,
}

impl Summary {
    /// The FMU among the files; none where its export failed.
    pub(super) fn fmu(&self) -> Option<&PathBuf> {
        self.files.iter().find(|f| f.ends_with(FMU_FILE))
    }
}

/// A fit in short.
#[derive(Serialize, Deserialize)]
pub(crate) struct FitSummary {
    /// Name of the model.
    pub model: String,
    /// Full account.
    #[serde(flatten)]
    pub report: FitReport,
    /// Uncertainty, or why it is not known.
    pub uncertainty: KnownUncertainty,
}
