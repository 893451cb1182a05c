//! Arguments that several commands share.

use crate::error::Result;
use crate::study::Study;
use std::path::{Path, PathBuf};

/// A study file and the folder of its results.
#[derive(clap::Args)]
pub struct StudyArgs {
    /// The study file.
    pub study: PathBuf,
    /// Folder of the results; by default the folder of the study file.
    #[arg(long)]
    pub out: Option<PathBuf>,
}

impl StudyArgs {
    /// Reads the study.
    pub fn read(&self) -> Result<Study> {
        Study::read(&self.study)
    }

    /// Folder of the results.
    pub fn directory(&self) -> PathBuf {
        let beside = self.study.parent().unwrap_or(Path::new(""));
        match &self.out {
            Some(out) => out.clone(),
            None if beside.as_os_str().is_empty() => PathBuf::from("."),
            None => beside.to_path_buf(),
        }
    }
}
