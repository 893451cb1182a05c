//! A bridge file on the command line, and the files that commands of a bridge leave and its page takes up.

use crate::cli::vocabulary::{
    BridgeStudy, OutputDir, Progress, Result, folder_of, read_text, warn,
};
use crate::files::bridge::BridgeFile;
use std::path::{Path, PathBuf};

/// The FMU of a bridge.
pub(crate) const BRIDGE_FMU: &str = "bridge.fmu";
/// Stem of the figure of frequencies and damping ratios.
pub(crate) const FLUTTER_FIGURE: &str = "bridge_flutter";
/// Stem of the figure of eigenvalues.
pub(crate) const ROOTS_FIGURE: &str = "bridge_roots";
/// Stem of the figure of derivatives of a section, followed by its number.
pub(crate) const DERIVATIVES_FIGURE: &str = "bridge_derivatives_";
/// Stem of the figure of the motion at the onset.
pub(crate) const MOTION_FIGURE: &str = "flutter_motion";
/// Stem of the figure of the motion over time.
pub(crate) const RESPONSE_FIGURE: &str = "flutter_response";
/// The page of a response to turbulence.
pub(crate) const BUFFETING_PAGE: &str = "buffeting.html";
/// Frequencies and damping ratios as numbers.
pub(crate) const CURVES: &str = "bridge_curves.csv";

/// A bridge file and the folder of its results.
#[derive(clap::Args)]
pub(crate) struct BridgeArgs {
    /// The bridge file (bridge.toml; see docs/bridge.md).
    pub bridge: PathBuf,
    /// Folder of the results; by default the folder of the bridge file.
    #[arg(long)]
    pub out: Option<PathBuf>,
}

impl BridgeArgs {
    /// The file as it stands there.
    pub(super) fn text(&self) -> Result<String> {
        read_text(&self.bridge)
    }

    /// The bridge.
    pub(super) fn study(&self, progress: &Progress) -> Result<BridgeStudy> {
        read(&self.bridge, progress)
    }

    /// Where its results go.
    pub(super) fn out(&self) -> Result<OutputDir> {
        OutputDir::new(self.out.as_deref().unwrap_or(folder_of(&self.bridge)))
    }
}

/// The bridge of a file, with what a reader should know of it on the terminal.
pub(crate) fn read(file: &Path, progress: &Progress) -> Result<BridgeStudy> {
    let work = || BridgeFile::read(file).and_then(BridgeStudy::new);
    let study = progress.during("reading the bridge", work)?;
    warn(file, &study.warnings());
    Ok(study)
}
