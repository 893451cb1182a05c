//! What the commands on a wind file have in common.

use super::common::warn;
use super::output::OutputDir;
use crate::error::{Error, Result};
use crate::report::Figure;
use crate::study::{WindStudy, example_wind_study_text, section_warnings};
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
        let section = study.section.as_ref();
        warn(file, &section.map_or_else(Vec::new, section_warnings));
        let beside = file.parent().filter(|p| !p.as_os_str().is_empty());
        let directory = self.out.as_deref().or(beside).unwrap_or(Path::new("."));
        Ok((study, OutputDir::new(directory)?))
    }
}

/// Writes a figure as SVG and PNG.
pub(crate) fn write_figure(out: &mut OutputDir, stem: &str, figure: &Figure) -> Result<()> {
    super::figures::write(stem, out, || Ok(figure.clone()))
}

/// A result as indented JSON.
pub(crate) fn write_json(
    out: &mut OutputDir,
    name: &str,
    value: &impl serde::Serialize,
) -> Result<()> {
    let mut text =
        serde_json::to_string_pretty(value).map_err(|e| Error::Numerical(e.to_string()))?;
    text.push('\n');
    out.write(name, text)
}
