//! `aerodeck compare`: the thesis's comparisons on the embedded decks, and any two time histories.

mod decks;
mod figures;
mod models;
mod signals;

use super::answer::Answer;
use super::output::OutputDir;
use super::progress::Progress;
use crate::comparison::forces::{CompareOptions, ForceMetrics, ScoreSummary, Scoring, Statement};
use crate::error::Result;
use crate::identification::DiscreteFit;
use crate::report::{Figure, PageSection};
use crate::section::Dof;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Predicted against measured forces: one model on several decks, several models on one, or two signals of a file
#[derive(clap::Subcommand)]
pub(crate) enum Compare {
    Decks(decks::Args),
    Models(models::Args),
    Signals(signals::Args),
}

/// Arguments of both comparisons.
#[derive(clap::Args)]
struct Common {
    /// Train at the tested wind speed nearest to this one, m/s.
    #[arg(long, default_value_t = 8.0)]
    speed: f64,
    /// Number of discrete Laguerre filters L.
    #[arg(long, default_value_t = 3)]
    filters: usize,
    /// Decay factor of the discrete filters, 0 < α < 1.
    #[arg(long, default_value_t = 0.6)]
    alpha: f64,
    /// Sway and drag as well: three motions, nine transfer functions.
    #[arg(long)]
    lateral: bool,
    /// White noise on each force, as a fraction of its RMS.
    #[arg(long, default_value_t = 0.0)]
    noise: f64,
    /// Seed of the noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Phase lag that brings the phase metric to 1/e, degrees.
    #[arg(long, default_value_t = 5.0)]
    significant_phase: f64,
    /// Folder of tables and figures.
    #[arg(long, default_value = "aerodeck-compare")]
    out: PathBuf,
}

impl Common {
    fn options(&self, decks: Vec<String>, trained_on: Option<String>) -> CompareOptions {
        CompareOptions {
            decks,
            trained_on,
            speed_m_s: self.speed,
            dofs: if self.lateral {
                Dof::THREE.to_vec()
            } else {
                Dof::TWO.to_vec()
            },
            laguerre: DiscreteFit {
                filters: self.filters,
                alpha: self.alpha,
                ..DiscreteFit::default()
            },
            noise_fraction: self.noise,
            seed: self.seed,
            scoring: Scoring {
                significant_phase_deg: self.significant_phase,
                ..Scoring::default()
            },
        }
    }
}

/// Sections 3.5.4 to 3.5.6 of the thesis on rebuilt records: its sentences beside what is found, and the figures.
///
/// # Errors
/// Those of the comparisons and figures.
pub(super) fn thesis_comparisons(progress: &Progress) -> Result<[PageSection; 2]> {
    let common = Common {
        speed: 8.0,
        filters: 3,
        alpha: 0.6,
        lateral: false,
        noise: 0.0,
        seed: 1,
        significant_phase: 5.0,
        out: PathBuf::new(),
    };
    Ok([
        decks::section(&common, progress)?,
        models::section(&common, progress)?,
    ])
}

/// A section of the page of the thesis.
fn section(title: &str, statements: &[Statement], figures: Vec<(String, Figure)>) -> PageSection {
    PageSection {
        title: title.to_owned(),
        header: vec!["section", "thesis", "here"],
        rows: statements
            .iter()
            .map(|s| vec![s.section.to_owned(), s.thesis.to_owned(), s.here.clone()])
            .collect(),
        figures: figures
            .into_iter()
            .map(|(caption, figure)| (caption.replace('_', " "), figure.svg().to_owned()))
            .collect(),
        ..PageSection::default()
    }
}

/// Runs the command.
pub fn run(command: &Compare, progress: &Progress) -> Result<Answer> {
    match command {
        Compare::Decks(args) => decks::run(args, progress),
        Compare::Models(args) => models::run(args, progress),
        Compare::Signals(args) => signals::run(args, progress),
    }
}

/// Mean of every metric over the frequencies, a line a deck or model, speed, motion and force.
fn metrics_table(summaries: &[ScoreSummary], name: fn(&ScoreSummary) -> String) -> String {
    let widest = summaries.iter().map(|s| name(s).chars().count()).max();
    let width = widest.unwrap_or(0);
    let mut text = format!(
        "{:<width$} {:>6}    {:<9} {:<9}",
        "Means over frequencies",
        "V m/s",
        "motion",
        "force",
        width = width.max(22)
    );
    for metric in ForceMetrics::NAMES {
        let _ = write!(text, " {metric:>6}");
    }
    text.push_str("   lowest M_phi\n");
    for s in summaries {
        let _ = write!(
            text,
            "{:<width$} {:>6.2}{:<3} {:<9} {:<9}",
            name(s),
            s.speed_m_s,
            if s.held_out { " *" } else { "" },
            s.motion.name(),
            s.force.name(),
            width = width.max(22)
        );
        for mean in s.mean {
            let _ = write!(text, " {mean:>6.3}");
        }
        let _ = writeln!(text, "   {:.3}", s.lowest[0]);
    }
    if summaries.iter().any(|s| s.held_out) {
        text.push_str("* not used for training\n");
    }
    text
}

/// The thesis's sentences and what is found.
fn beside_the_thesis(statements: &[Statement]) -> String {
    let mut text = String::new();
    for s in statements {
        let _ = writeln!(
            text,
            "thesis {}: {}\n      here: {}",
            s.section, s.thesis, s.here
        );
    }
    text
}

/// A figure as SVG and PNG.
fn draw(out: &mut OutputDir, stem: &str, figure: &Figure) -> Result<()> {
    crate::cli::figures::write(stem, out, || Ok(figure.clone()))
}
