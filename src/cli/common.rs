//! Arguments that several commands share.

use crate::error::{Error, Result};
use crate::study::{Study, study_warnings};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Says at once what is hardly meant in a file, since it may be the cause of a failure to come.
pub(crate) fn warn(file: &Path, warnings: &[String]) {
    for warning in warnings {
        // standard error may be closed
        let _ = writeln!(std::io::stderr(), "warning: {}: {warning}", file.display());
    }
}

/// A study file and the folder of its results.
#[derive(clap::Args)]
pub(crate) struct StudyArgs {
    /// The study file.
    pub study: PathBuf,
    /// Folder of the results; by default the folder of the study file.
    #[arg(long)]
    pub out: Option<PathBuf>,
}

impl StudyArgs {
    /// Reads the study.
    pub(crate) fn read(&self) -> Result<Study> {
        let study = Study::read(&self.study)?;
        warn(&self.study, &study_warnings(&study));
        Ok(study)
    }

    /// Reads the study and keeps its text.
    pub(crate) fn read_with_text(&self) -> Result<(Study, String)> {
        let study = self.read()?;
        let text = std::fs::read_to_string(&self.study).map_err(|e| Error::io(&self.study, e))?;
        Ok((study, text))
    }

    /// The file of the study.
    pub(crate) fn file(&self) -> Option<&Path> {
        Some(&self.study)
    }

    /// Folder of the results.
    pub(crate) fn directory(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| self.beside())
    }

    /// Folder of the study file.
    pub(crate) fn beside(&self) -> PathBuf {
        let parent = self.study.parent().filter(|p| !p.as_os_str().is_empty());
        parent.unwrap_or(Path::new(".")).to_path_buf()
    }
}
