//! `aerodeck bridge`: whole bridges.

mod buffeting;
mod buffeting_page;
mod convert;
pub(super) mod demo;
pub(in crate::cli) mod files;
mod flutter;
mod show;
pub(in crate::cli) mod summary;
mod text;

pub(crate) use files::read;

use super::vocabulary::{Answer, Progress, Result};

/// Flutter of whole bridges, their modes, and modes of finite-element programs
#[derive(clap::Subcommand)]
pub(super) enum BridgeCommand {
    Flutter(flutter::BridgeFlutterArgs),
    /// Draw the modes of a bridge and state how alike vertical and torsional modes are
    ///
    /// Example: aerodeck bridge show bridge.toml --out modes
    #[command(verbatim_doc_comment)]
    Show(files::BridgeArgs),
    Buffeting(buffeting::BridgeBuffetingArgs),
    Convert(convert::BridgeConvertArgs),
}

/// Runs the command.
pub(super) fn run(command: &BridgeCommand, progress: &Progress) -> Result<Answer> {
    match command {
        BridgeCommand::Flutter(args) => flutter::run(args, progress),
        BridgeCommand::Show(args) => show::run(args, progress),
        BridgeCommand::Buffeting(args) => buffeting::run(args, progress),
        BridgeCommand::Convert(args) => convert::run(args),
    }
}
