//! `aerodeck fmu`: exporting and checking FMUs.

mod check;
mod export;

use super::answer::Answer;
use super::progress::Progress;
use crate::error::Result;

/// Export and check FMUs
#[derive(clap::Subcommand)]
pub(super) enum Fmu {
    Export(Box<export::Args>),
    Check(check::Args),
}

/// Runs the command.
pub(super) fn run(command: &Fmu, progress: &Progress) -> Result<Answer> {
    match command {
        Fmu::Export(args) => export::run(args, progress),
        Fmu::Check(args) => check::run(args, progress),
    }
}
