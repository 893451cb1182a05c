//! `aerodeck fmu`: exporting and checking FMUs.

mod check;
mod export;

use super::answer::Answer;
use super::progress::Progress;
use crate::error::Result;

/// Export and check FMUs
#[derive(clap::Subcommand)]
pub(super) enum FmuCommand {
    Export(Box<export::FmuExportArgs>),
    Check(check::FmuCheckArgs),
}

/// Runs the command.
pub(super) fn run(command: &FmuCommand, progress: &Progress) -> Result<Answer> {
    match command {
        FmuCommand::Export(args) => export::run(args, progress),
        FmuCommand::Check(args) => check::run(args, progress),
    }
}
