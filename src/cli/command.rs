//! Every command with its arguments.

use super::vocabulary::StudyArgs;
use super::{
    bridge, campaign, compare, coverage, derivatives, fmu, monte_carlo, new, process, select,
    simulate, ssp, wind,
};
use clap::Subcommand;
use clap_complete::Shell;
use std::path::PathBuf;

/// What commands are for, and which they are, in the order in which a newcomer meets them.
pub(super) const GROUPS: [(&str, &str); 5] = [
    (
        "Answers",
        "demo study flutter bridge quasi-steady buffeting monte-carlo simulate",
    ),
    ("Data", "new derivatives campaign process tunnel"),
    ("Models", "train select coverage compare"),
    ("FMUs", "fmu ssp"),
    (
        "Reports and checks",
        "report plot validate thesis completions",
    ),
];

#[derive(Subcommand)]
pub(super) enum Command {
    /// Run the whole chain on a measured bridge deck (NTNU Langenuen LN21-5200), which is built in
    ///
    /// Example: aerodeck demo --out first-look
    /// Example: aerodeck demo --bridge --out first-bridge
    #[command(verbatim_doc_comment)]
    Demo {
        /// Where the results go.
        #[arg(long, default_value = "aerodeck-out")]
        out: PathBuf,
        /// The whole Langenuen bridge with this girder instead of a section of it: 39 modes, their flutter and the motion at it.
        #[arg(long)]
        bridge: bool,
        /// Replace a study file that differs from the demo's.
        #[arg(long)]
        force: bool,
    },
    New(new::NewArgs),
    /// Run the whole chain of a study file: records, training, flutter, FMU, onset by stepping the FMU
    ///
    /// Example: aerodeck study study.toml --out results
    #[command(verbatim_doc_comment)]
    Study {
        #[command(flatten)]
        study: StudyArgs,
        /// Export a model that grows below its onset, at reduced frequencies that were not tested.
        #[arg(long)]
        allow_unstable: bool,
        /// Replace a study.toml in the folder of results that differs; without, this study stands beside it as study_as_run.toml.
        #[arg(long)]
        force: bool,
    },
    /// Write report.html, one self-contained page, from a folder of results of `study`, `demo` or `bridge flutter`
    ///
    /// Example: aerodeck report aerodeck-out
    #[command(verbatim_doc_comment)]
    Report {
        /// The folder of results.
        folder: PathBuf,
        /// Print the page to report.pdf too, where a browser of the Chromium family is installed (AERODECK_BROWSER names another).
        #[arg(long)]
        pdf: bool,
    },
    /// Draw columns of a CSV file of results over one of them, as SVG and with --png as PNG
    ///
    /// Example: aerodeck plot aerodeck-out/curves.csv --x speed_m_s --y frequency_hz,damping_ratio
    #[command(verbatim_doc_comment)]
    Plot {
        /// The file (`curves.csv`, `simulation.csv`, a record, …). Columns of text tell curves apart.
        file: PathBuf,
        /// Abscissa; by default the first column of numbers.
        #[arg(long)]
        x: Option<String>,
        /// Columns to plot, one panel per column; by default all other columns of numbers, six at most.
        #[arg(long, value_delimiter = ',')]
        y: Vec<String>,
        /// Folder of the figure; by default that of the file.
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Rebuild the forced-vibration records of a study's deck and write them as CSV
    ///
    /// Example: aerodeck tunnel study.toml
    #[command(verbatim_doc_comment)]
    Tunnel(StudyArgs),
    #[command(subcommand)]
    Campaign(campaign::CampaignCommand),
    Process(process::ProcessArgs),
    /// Train the models of a study from its records (see `tunnel`) and tables
    ///
    /// Example: aerodeck train study.toml
    #[command(verbatim_doc_comment)]
    Train(StudyArgs),
    /// Frequencies, damping and flutter onset of the trained models of a study (see `train`)
    ///
    /// Example: aerodeck flutter study.toml --all
    #[command(verbatim_doc_comment)]
    Flutter {
        #[command(flatten)]
        study: StudyArgs,
        /// Every route side by side: eigenvalues, determinant, p-k iteration, quasi-steady limit, flat plate, Selberg and
        /// Rocard; with an onset card for each force model.
        #[arg(long)]
        all: bool,
    },
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
    /// Compute the reference cases and compare them with published or independently computed figures
    ///
    /// Example: aerodeck validate
    /// Example: aerodeck validate --case my_bridge.toml --case my_deck.toml
    #[command(verbatim_doc_comment)]
    Validate {
        /// One case by name; by default, all.
        name: Option<String>,
        /// A case of your own (`.toml`); may be given several times.
        #[arg(long = "case", value_name = "FILE", conflicts_with = "name")]
        files: Vec<PathBuf>,
        /// The table in Markdown, as it stands in docs/validation.md.
        #[arg(long)]
        markdown: bool,
    },
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
