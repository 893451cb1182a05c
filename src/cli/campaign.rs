//! `aerodeck campaign`: raw wind-tunnel campaigns.

mod check;
mod virtual_campaign;

use super::answer::Answer;
use super::progress::Progress;
use crate::error::Result;
use std::path::PathBuf;

/// Raw wind-tunnel campaigns: check the files of a laboratory, or invent a campaign with a known truth
#[derive(clap::Subcommand)]
pub(crate) enum CampaignCommand {
    /// Read a campaign file and all recordings it names: runs, channels, lengths, rates, speeds, densities, findings
    ///
    /// Example: aerodeck campaign check campaign.toml
    #[command(verbatim_doc_comment)]
    Check {
        /// The campaign file.
        campaign: PathBuf,
    },
    Virtual(virtual_campaign::VirtualCampaignArgs),
}

/// Runs the command.
pub(crate) fn run(command: &CampaignCommand, progress: &Progress) -> Result<Answer> {
    match command {
        CampaignCommand::Check { campaign } => check::run(campaign, progress),
        CampaignCommand::Virtual(args) => virtual_campaign::run(args, progress),
    }
}
