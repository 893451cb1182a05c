//! `aerodeck bridge`: whole bridges.

mod account;
mod buffeting;
mod convert;
pub(super) mod demo;
mod flutter;
mod show;
mod summary;

use super::answer::Answer;
use super::common::warn;
use super::output::OutputDir;
use super::progress::Progress;
use crate::error::{Error, Result};
use crate::files::bridge::BridgeFile;
use crate::study::bridge::BridgeStudy;
use std::path::{Path, PathBuf};

use account::card;
pub(crate) use flutter::{CURVES, FLUTTER_FIGURE, MOTION_FIGURE, shown_modes};
use flutter::{computed, staged};

/// The FMU of a bridge.
pub(crate) const BRIDGE_FMU: &str = "bridge.fmu";

/// Flutter of whole bridges, their modes, and modes of finite-element programs
#[derive(clap::Subcommand)]
pub enum Bridge {
    Flutter(flutter::Args),
    Show(show::Args),
    Buffeting(buffeting::Args),
    Convert(convert::Args),
}

/// Runs the command.
pub fn run(command: &Bridge, progress: &Progress) -> Result<Answer> {
    match command {
        Bridge::Flutter(args) => flutter::run(args, progress),
        Bridge::Show(args) => show::run(args, progress),
        Bridge::Buffeting(args) => buffeting::run(args, progress),
        Bridge::Convert(args) => convert::run(args),
    }
}

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
    fn text(&self) -> Result<String> {
        std::fs::read_to_string(&self.bridge).map_err(|e| Error::io(&self.bridge, e))
    }

    fn study(&self, progress: &Progress) -> Result<BridgeStudy> {
        let stage = progress.stage("reading the bridge");
        let study = BridgeStudy::new(BridgeFile::read(&self.bridge)?);
        drop(stage);
        let study = study?;
        warn(&self.bridge, &study.notes);
        Ok(study)
    }

    fn out(&self) -> Result<OutputDir> {
        let parent = self.bridge.parent().filter(|p| !p.as_os_str().is_empty());
        let beside = parent.unwrap_or(Path::new("."));
        OutputDir::new(self.out.as_deref().unwrap_or(beside))
    }
}
