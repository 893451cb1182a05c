//! `aerodeck campaign`: raw wind-tunnel campaigns.

mod check;
mod virtual_campaign;

use super::answer::Answer;
use super::progress::Progress;
use crate::error::Result;

/// Raw wind-tunnel campaigns: check the files of a laboratory, or invent a campaign with a known truth
#[derive(clap::Subcommand)]
pub(crate) enum CampaignCommand {
    Check(check::CampaignCheckArgs),
    Virtual(virtual_campaign::VirtualCampaignArgs),
}

/// Runs the command.
pub(crate) fn run(command: &CampaignCommand, progress: &Progress) -> Result<Answer> {
    match command {
        CampaignCommand::Check(args) => check::run(args, progress),
        CampaignCommand::Virtual(args) => virtual_campaign::run(args, progress),
    }
}
