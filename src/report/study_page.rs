//! The report of a study, or of a whole bridge, as one page that loads nothing from elsewhere.

use super::axes_sketch::axes_sketch;
use super::page_head::{at_edges, capital, class, doubts, required_colour, stated};
use super::sections_page::PageSection;
use super::vocabulary::{COLOURS, Figure, branch_width, dash};
use crate::files::report_block::ReportBlock;
use crate::identification::{EntryReport, FitReport};
use crate::units::ReducedFrequency;
use crate::verdict::{Severity, Verdict};
use askama::Template;
use serde_json::{Value, json};

const UPLOT_JS: &str = include_str!("../../templates/uplot/uPlot.iife.min.js");
/// Has to go wherever the library goes.
const UPLOT_LICENCE: &str = include_str!("../../templates/uplot/LICENSE");
const UPLOT_CSS: &str = include_str!("../../templates/uplot/uPlot.min.css");

/// A figure with what a reader has to know.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PageFigure {
    pub(crate) title: String,
    pub(crate) caption: &'static str,
    pub(crate) figure: Figure,
}

/// A curve whose values are shown under the cursor; `None` where it is not known.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PageCurve {
    pub(crate) model: usize,
    pub(crate) branch: usize,
    /// Whether it is one of the answer.
    pub(crate) own: bool,
    pub(crate) label: String,
    /// Hz.
    pub(crate) frequency: Vec<Option<f64>>,
    /// Per cent.
    pub(crate) damping: Vec<Option<f64>>,
}

/// Everything on the page, in words.
#[derive(Debug, Clone, PartialEq, Default, Template)]
#[template(path = "study_report.html")]
pub(crate) struct StudyPage {
    pub(crate) title: String,
    /// What the flutter is of.
    pub(crate) subtitle: &'static str,
    /// The file that was run: `study`, `bridge file`.
    pub(crate) kind: &'static str,
    /// What is no part of the analysis, a sentence.
    pub(crate) beyond: &'static str,
    pub(crate) generator: String,
    pub(crate) of: ReportBlock,
    pub(crate) verdict: Verdict,
    pub(crate) card: Vec<(&'static str, String)>,
    /// Which of the models the answer is of, and why.
    pub(crate) whose: String,
    pub(crate) asked: Vec<(&'static str, String)>,
    pub(crate) onsets: Vec<Vec<String>>,
    pub(crate) comparisons: Vec<String>,
    /// Further tables of the answer.
    pub(crate) sections: Vec<PageSection>,
    /// Frequency and damping of the answer; none without curves.
    pub(crate) summary: Option<Figure>,
    /// The figure of derivatives in the summary.
    pub(crate) derivatives: Option<PageFigure>,
    pub(crate) figures: Vec<PageFigure>,
    /// Sections of other pages, as HTML.
    pub(crate) taken_up: String,
    /// Tables behind the evidence.
    pub(crate) appendix: Vec<PageSection>,
    /// Names of the models and the accounts of their fits.
    pub(crate) fits: Vec<(String, FitReport)>,
    pub(crate) fmu: String,
    /// Name, causality, unit, meaning.
    pub(crate) variables: Vec<[String; 4]>,
    pub(crate) command: String,
    pub(crate) licence: String,
    pub(crate) hashes: Vec<(String, String)>,
    /// Text of the file that was run.
    pub(crate) text: String,
    /// Wind speeds of the curves, m/s.
    pub(crate) speeds: Vec<f64>,
    pub(crate) curves: Vec<PageCurve>,
    /// m/s.
    pub(crate) onset: Option<f64>,
    /// 95 % interval of the onset, m/s.
    pub(crate) interval: Option<(f64, f64)>,
    /// What the sliders start from and the module they ask, as JSON; they need the curves.
    pub(crate) live: Option<String>,
}

/// Reduced frequencies of the tests behind a fit.
fn tested(fit: &FitReport) -> String {
    let k = |k: ReducedFrequency| format!("{:.3}", k.full_width());
    format!("{} to {}", k(fit.tested_range.min), k(fit.tested_range.max))
}

/// Force by motion, residual and poles.
fn entry(of: &EntryReport) -> [String; 3] {
    let residual = of.relative_rms.map(|r| format!("{:.1} %", 100.0 * r));
    let poles: Vec<String> = of.poles.iter().map(|p| format!("{p:.3}")).collect();
    let name = format!("{} by {}", of.force.name(), of.motion.name());
    [name, residual.unwrap_or("–".to_owned()), poles.join(", ")]
}

/// Active constraints and notes.
fn remarks(fit: &FitReport) -> Vec<String> {
    let held = fit.constraints.iter().flat_map(|c| &c.sentences);
    let held = held.map(|s| format!("constraint: {s}"));
    held.chain(fit.notes.iter().cloned()).collect()
}

/// JSON as it may stand in a script: `<` cannot end it.
fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

impl StudyPage {
    /// The curves as a value of JavaScript.
    fn charts(&self) -> String {
        let charts = json!({
            "speeds": self.speeds,
            "onset": self.onset,
            "interval": self.interval,
            "required": self.verdict.against.map(|r| r.speed_m_s),
            "required_colour": required_colour(&self.verdict),
            "series": self.curves.iter().map(series).collect::<Vec<_>>(),
        });
        in_script(&charts.to_string())
    }
}

fn series(of: &PageCurve) -> Value {
    let numbers = |d: &str| d.split(' ').filter_map(|x| x.parse().ok()).collect();
    let dash: Vec<f64> = dash(of.model).map_or(vec![], numbers);
    json!({
        "label": of.label,
        "colour": COLOURS[of.model % COLOURS.len()],
        "width": branch_width(of.branch),
        "dash": dash,
        "frequency": of.frequency,
        "damping": of.damping,
    })
}
