//! Every command with its arguments.

use super::{
    bridge, campaign, common, compare, coverage, demo, derivatives, flutter, fmu, monte_carlo, new,
    plot, process, report, select, simulate, ssp, study, validate, wind,
};
use clap::Subcommand;
use clap_complete::Shell;
use std::path::PathBuf;

#[derive(Subcommand)]
pub(super) enum Command {
    Demo(demo::DemoArgs),
    New(new::NewArgs),
    Study(study::RunStudyArgs),
    Report(report::ReportArgs),
    Plot(plot::PlotArgs),
    /// Rebuild the forced-vibration records of a study's deck and write them as CSV
    ///
    /// Example: aerodeck tunnel study.toml
    #[command(verbatim_doc_comment)]
    Tunnel(common::StudyArgs),
    #[command(subcommand)]
    Campaign(campaign::CampaignCommand),
    Process(process::ProcessArgs),
    /// Train the models of a study from its records (see `tunnel`) and tables
    ///
    /// Example: aerodeck train study.toml
    #[command(verbatim_doc_comment)]
    Train(common::StudyArgs),
    Flutter(flutter::FlutterArgs),
    MonteCarlo(monte_carlo::MonteCarloArgs),
    Simulate(simulate::SimulateArgs),
    /// Static equilibrium over wind speed, linear quasi-steady model, its onset, and a nonlinear run in gusts
    ///
    /// Example: aerodeck quasi-steady wind.toml
    #[command(verbatim_doc_comment)]
    QuasiSteady(wind::WindArgs),
    /// RMS response to turbulence over wind speed, in the frequency and in the time domain
    ///
    /// Example: aerodeck buffeting wind.toml
    #[command(verbatim_doc_comment)]
    Buffeting(wind::WindArgs),
    #[command(subcommand)]
    Bridge(bridge::BridgeCommand),
    #[command(subcommand)]
    Fmu(fmu::FmuCommand),
    #[command(subcommand)]
    Ssp(ssp::SspCommand),
    #[command(subcommand)]
    Derivatives(derivatives::Derivatives),
    Validate(validate::ValidateArgs),
    /// Repeat the thesis's headline: discrete Laguerre and rational functions on its own deck, 37.6 m/s
    ///
    /// Example: aerodeck thesis --out thesis
    #[command(verbatim_doc_comment)]
    Thesis {
        /// Write thesis.html into this folder: every figure and table that can be computed, its numbers beside ours.
        #[arg(long)]
        out: Option<PathBuf>,
    },
    Select(select::SelectArgs),
    Coverage(coverage::CoverageArgs),
    #[command(subcommand)]
    Compare(compare::Compare),
    /// Print the completions of a shell
    ///
    /// Example: aerodeck completions bash > ~/.local/share/bash-completion/completions/aerodeck
    #[command(verbatim_doc_comment)]
    Completions {
        /// The shell.
        shell: Shell,
    },
}
