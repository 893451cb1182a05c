//! `aerodeck bridge`: whole bridges.

mod account;
mod args;
mod buffeting;
mod convert;
pub(super) mod demo;
mod files;
mod flutter;
mod show;
mod summary;

pub(crate) use args::read;
pub(crate) use files::{
    BRIDGE_FMU, CURVES, DERIVATIVES_FIGURE, FLUTTER_FIGURE, MOTION_FIGURE, ROOTS_FIGURE,
    shown_modes,
};

use super::answer::Answer;
use super::progress::Progress;
use crate::error::Result;

/// Flutter of whole bridges, their modes, and modes of finite-element programs
#[derive(clap::Subcommand)]
pub(super) enum Bridge {
    Flutter(flutter::Args),
    Show(show::Args),
    Buffeting(buffeting::Args),
    Convert(convert::Args),
}

/// Runs the command.
pub(super) fn run(command: &Bridge, progress: &Progress) -> Result<Answer> {
    match command {
        Bridge::Flutter(args) => flutter::run(args, progress),
        Bridge::Show(args) => show::run(args, progress),
        Bridge::Buffeting(args) => buffeting::run(args, progress),
        Bridge::Convert(args) => convert::run(args),
    }
}
