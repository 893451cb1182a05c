//! `aerodeck fmu`: exporting, checking and replaying FMUs.

mod check;
mod export;
mod replay;

use super::answer::Answer;
use super::progress::Progress;
use crate::error::Result;

/// Export, check and replay FMUs
#[derive(clap::Subcommand)]
pub(super) enum FmuCommand {
    Export(Box<export::FmuExportArgs>),
    Check(check::FmuCheckArgs),
    Replay(replay::FmuReplayArgs),
}

/// Runs the command.
pub(super) fn run(command: &FmuCommand, progress: &Progress) -> Result<Answer> {
    match command {
        FmuCommand::Export(args) => export::run(args, progress),
        FmuCommand::Check(args) => check::run(args, progress),
        FmuCommand::Replay(args) => replay::run(args, progress),
    }
}
