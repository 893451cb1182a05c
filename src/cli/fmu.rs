//! `aerodeck fmu`: exporting, checking and replaying FMUs.

mod check;
mod export;
mod replay;

use super::answer::Answer;
use super::progress::Progress;
use crate::error::Result;
use std::path::PathBuf;

/// Export, check and replay FMUs
#[derive(clap::Subcommand)]
pub(super) enum FmuCommand {
    Export(Box<export::FmuExportArgs>),
    /// Check any co-simulation FMU (FMI 2.0 or 3.0) and step it; fails when something is wrong
    ///
    /// The code of the FMU runs in this process, with all your rights: check an archive that you do not trust with --no-run.
    ///
    /// Example: aerodeck fmu check deck_section.fmu
    /// Example: aerodeck fmu check foreign.fmu --no-run
    #[command(verbatim_doc_comment)]
    Check {
        /// The FMU.
        fmu: PathBuf,
        /// Check archive and description alone; no code of the FMU is loaded.
        #[arg(long)]
        no_run: bool,
    },
    /// Repeat the reference runs that an FMU carries (FMI-LS-REF) and say whether it does what its exporter meant
    ///
    /// Every binary that loads on this machine is run; fails when one differs by more than rounding. Its code runs in this process, with
    /// all your rights.
    ///
    /// Example: aerodeck fmu replay deck_section.fmu
    #[command(verbatim_doc_comment)]
    Replay {
        /// The FMU.
        fmu: PathBuf,
    },
}

/// Runs the command.
pub(super) fn run(command: &FmuCommand, progress: &Progress) -> Result<Answer> {
    match command {
        FmuCommand::Export(args) => export::run(args, progress),
        FmuCommand::Check { fmu, no_run } => check::run(fmu, *no_run, progress),
        FmuCommand::Replay { fmu } => replay::run(fmu, progress),
    }
}
