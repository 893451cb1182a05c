//! What the comparisons of the thesis share: arguments, tables, figures of metrics, the section of a page.

use crate::cli::vocabulary::{
    Dof, Figure, PageSection, PlottedSeries, Result, TextTable, TimePanel,
};
use crate::comparison::forces::{
    CompareOptions, ForceMetrics, Score, ScoreSummary, Scoring, Statement,
};
use crate::identification::DiscreteFit;
use crate::report::metrics_figure;
use std::path::PathBuf;

/// Arguments of both comparisons.
#[derive(clap::Args)]
pub(crate) struct Common {
    /// Train at the tested wind speed nearest to this one, m/s.
    #[arg(long, default_value_t = 8.0, allow_negative_numbers = true)]
    pub(super) speed: f64,
    /// Number of discrete Laguerre filters L.
    #[arg(long, default_value_t = 3)]
    pub(super) filters: usize,
    /// Decay factor of the discrete filters, 0 < α < 1.
    #[arg(long, default_value_t = 0.6, allow_negative_numbers = true)]
    pub(super) alpha: f64,
    /// Sway and drag as well: three motions, nine transfer functions.
    #[arg(long)]
    pub(super) lateral: bool,
    /// White noise on each force, as a fraction of its RMS.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub(super) noise: f64,
    /// Seed of the noise.
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,
    /// Phase lag that brings the phase metric to 1/e, degrees.
    #[arg(long, default_value_t = 5.0, allow_negative_numbers = true)]
    pub(super) significant_phase: f64,
    /// Folder of tables and figures.
    #[arg(long, default_value = "aerodeck-compare")]
    pub(super) out: PathBuf,
}

impl Common {
    pub(super) fn options(&self, decks: Vec<String>, trained_on: Option<String>) -> CompareOptions {
        CompareOptions {
            decks,
            trained_on,
            speed_m_s: self.speed,
            dofs: match self.lateral {
                true => Dof::THREE.to_vec(),
                false => Dof::TWO.to_vec(),
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

/// The thesis's three metrics of every force over frequency, one line per label (Figures 3.20, 3.27 and 3.28).
pub(super) fn metrics_of(
    title: &str,
    forces: &[Dof],
    scores: &[&Score],
    label: &dyn Fn(&Score) -> String,
) -> Result<Figure> {
    let mut panels = Vec::new();
    for &force in forces {
        for (name, pick) in [
            ("phase", (|s| s.metrics.phase) as fn(&Score) -> f64),
            ("peak", |s| s.metrics.peak),
            ("warped magnitude", |s| s.metrics.magnitude_warped),
        ] {
            let mut series: Vec<PlottedSeries> = Vec::new();
            for score in scores.iter().filter(|s| s.case.force == force) {
                let (label, point) = (label(score), (score.frequency_hz, pick(score)));
                match series.iter_mut().find(|s| s.label == label) {
                    Some(known) => known.points.push(point),
                    None => series.push(PlottedSeries::new(label, vec![point])),
                }
            }
            panels.push(TimePanel::new(
                format!("{}: {name}", force.force_name()),
                series,
            ));
        }
    }
    metrics_figure(title, &panels)
}

/// A section of the page of the thesis.
pub(super) fn section(
    title: &str,
    statements: &[Statement],
    figures: Vec<(String, Figure)>,
) -> PageSection {
    let row = |s: &Statement| vec![s.section.to_owned(), s.thesis.to_owned(), s.here.clone()];
    let rows = statements.iter().map(row).collect();
    let figures = figures.into_iter();
    let figures = figures.map(|(caption, figure)| (caption.replace('_', " "), figure));
    PageSection {
        figures: figures.collect(),
        ..PageSection::table(title, "section | thesis | here", rows)
    }
}

/// Mean of every metric over the frequencies, a line per deck or model, speed, motion and force.
pub(super) fn metrics_table(summaries: &[ScoreSummary], name: fn(&ScoreSummary) -> &str) -> String {
    let metrics = ForceMetrics::NAMES.join(" | >");
    let mut table = TextTable::new(&format!(
        "Means over frequencies | >V m/s | motion | force | >{metrics} | >lowest M_phi"
    ));
    for s in summaries {
        let held_out = if s.case.held_out { "*" } else { " " };
        let case = [
            name(s).to_owned(),
            format!("{:.2} {held_out}", s.case.speed_m_s),
            s.case.motion.name().to_owned(),
            s.case.force.name().to_owned(),
        ];
        let mean = s.mean.map(|mean| format!("{mean:.3}"));
        let lowest = format!("{:.3}", s.lowest[0]);
        table.row(case.into_iter().chain(mean).chain([lowest]));
    }
    let mut text = table.text();
    if summaries.iter().any(|s| s.case.held_out) {
        text.push_str("* not used for training\n");
    }
    text
}

/// The thesis's sentences and what is found.
pub(super) fn beside_the_thesis(statements: &[Statement]) -> String {
    let said = |s: &Statement| {
        let (section, thesis, here) = (s.section, s.thesis, &s.here);
        format!("thesis {section}: {thesis}\n      here: {here}\n")
    };
    statements.iter().map(said).collect()
}
