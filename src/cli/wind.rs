//! What the commands on a wind file have in common.

use super::vocabulary::{OutputDir, Result, WindStudy, folder_of, sentences, warn};
use crate::study::example_wind_study_text;
use std::path::{Path, PathBuf};

/// Name under which the example is left with the user.
const EXAMPLE_FILE: &str = "wind.toml";

/// The wind file, and where results go.
#[derive(clap::Args)]
pub(crate) struct WindArgs {
    /// The wind file: section, aerodynamics, turbulence. Left out, an example is used and written beside the results.
    pub file: Option<PathBuf>,
    /// Folder of the results; by default that of the file, or `aerodeck-out`.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Replace a wind file that differs from the example, when the example is used.
    #[arg(long)]
    pub force: bool,
}

impl WindArgs {
    /// The wind file or the example, and the folder of the results, in which the example then stands.
    pub(crate) fn open(&self) -> Result<(WindStudy, OutputDir)> {
        let Some(file) = &self.file else {
            let text = example_wind_study_text();
            let study = WindStudy::from_toml(text, PathBuf::new())?;
            let directory = self.out.as_deref().unwrap_or(Path::new("aerodeck-out"));
            let mut out = OutputDir::new(directory)?;
            out.write(EXAMPLE_FILE, text)?;
            let instead = "name yours to use it, choose another --out";
            out.refuse_edited(EXAMPLE_FILE, self.force, instead)?;
            return Ok((study, out));
        };
        let study = WindStudy::read(file)?;
        warn(file, &sentences(&study.findings()));
        let directory = self.out.as_deref().unwrap_or(folder_of(file));
        Ok((study, OutputDir::new(directory)?))
    }
}
