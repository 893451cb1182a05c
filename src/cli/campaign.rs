//! `aerodeck campaign`: raw wind-tunnel campaigns.

mod check;
mod invent;

use super::answer::Answer;
use super::progress::Progress;
use crate::error::Result;

/// Raw wind-tunnel campaigns: check the files of a laboratory, or invent a campaign with a known truth
#[derive(clap::Subcommand)]
pub(crate) enum Campaign {
    Check(check::Args),
    Virtual(invent::Args),
}

/// Runs the command.
pub(crate) fn run(command: &Campaign, progress: &Progress) -> Result<Answer> {
    match command {
        Campaign::Check(args) => check::run(args, progress),
        Campaign::Virtual(args) => invent::run(args, progress),
    }
}
