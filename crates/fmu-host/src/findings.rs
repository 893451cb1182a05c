//! What a check has found: a list that can be printed, counted and saved.

use serde::Serialize;
use std::collections::HashSet;

/// How much a finding matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FmuSeverity {
    /// Worth knowing; nothing is wrong.
    Note,
    /// Legal or tolerated, but some importer will stumble.
    Warning,
    /// Against the standard, or it does not run.
    Error,
}

impl FmuSeverity {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FmuFinding {
    /// How much it matters.
    pub severity: FmuSeverity,
    /// Where: file with line, variable, or function.
    pub place: String,
    /// What the standard or common sense asks for.
    pub expected: String,
    /// What was there.
    pub found: String,
}

impl std::fmt::Display for FmuFinding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (severity, place) = (self.severity.name(), &self.place);
        let (expected, found) = (&self.expected, &self.found);
        write!(f, "{severity}: {place}: expected {expected}, found {found}")
    }
}

/// Findings in the order in which they were made.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct FmuFindings(pub Vec<FmuFinding>);

impl FmuFindings {
    pub(super) fn add(
        &mut self,
        severity: FmuSeverity,
        place: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) {
        self.0.push(FmuFinding {
            severity,
            place: place.into(),
            expected: expected.into(),
            found: found.into(),
        });
    }

    pub(super) fn error(
        &mut self,
        place: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) {
        self.add(FmuSeverity::Error, place, expected, found);
    }

    pub(super) fn warning(
        &mut self,
        place: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) {
        self.add(FmuSeverity::Warning, place, expected, found);
    }

    /// An error for every text that comes more than once.
    pub(super) fn each_once<'a>(
        &mut self,
        place: &str,
        expected: &str,
        all: impl Iterator<Item = &'a str>,
    ) {
        let (mut seen, mut reported) = (HashSet::new(), HashSet::new());
        for one in all {
            if !seen.insert(one) && reported.insert(one) {
                self.error(place, expected, format!("`{one}` twice"));
            }
        }
    }
}

/// One thing that was tried with the running FMU.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Trial {
    /// What was tried, in words.
    pub name: String,
    /// Whether it went as the standard says.
    pub passed: bool,
    /// Numbers of the trial, or why it was left out.
    pub detail: String,
}

/// Result of checking an FMU.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CheckReport {
    /// The file.
    pub file: String,
    /// Name of the model.
    pub model_name: String,
    /// Program that made it, as it says.
    pub generation_tool: String,
    /// Platforms with a binary, folder names below `binaries/`.
    pub platforms: Vec<String>,
    /// Number of variables.
    pub variables: usize,
    /// Everything that was found.
    pub findings: Vec<FmuFinding>,
    /// The binary whose code was loaded and run in this process; `None` where none was.
    pub ran: Option<String>,
    /// What was tried by running it; empty when it could not be loaded.
    pub trials: Vec<Trial>,
    /// Messages the FMU logged during the trials, at most a few hundred.
    pub messages: Vec<String>,
}

impl CheckReport {
    /// Whether there is no finding of [`FmuSeverity::Error`] and no trial failed.
    pub fn passed(&self) -> bool {
        self.count(FmuSeverity::Error) == 0 && self.trials.iter().all(|t| t.passed)
    }

    /// Number of findings of one severity.
    pub fn count(&self, severity: FmuSeverity) -> usize {
        let of_severity = |f: &&FmuFinding| f.severity == severity;
        self.findings.iter().filter(of_severity).count()
    }
}
