//! `aerodeck process`: from the raw runs of a campaign to records, derivatives and a study.

use super::figures;
use super::laboratory::{laboratory_page, processing_text};
use super::result_files::{lines_of, over_v_hat};
use super::stages::RECORDS;
use super::vocabulary::{
    Answer, DerivativePlot, Dof, Error, Figure, Finding, OutputDir, PlottedSeries, Progress,
    Result, Study, derivative_lines, ensure, file_name, rendered, sentences,
};
use crate::aerodynamics::derivatives::notation::Convention;
use crate::aerodynamics::derivatives::{Derivative, TableHeader};
use crate::aerodynamics::quasi_steady::{Arms, LinearQuasiSteady, QuasiSteady};
use crate::aerodynamics::{FlatPlate, Transfer};
use crate::files::coefficients::named_coefficients;
use crate::files::derivatives::{workbook_bytes_in, write_csv, write_points};
use crate::files::toml_lines;
use crate::identification::derivatives::{
    DerivativeEstimate, DerivativeOptions, IdentifiedDerivatives, identify_derivatives,
};
use crate::json;
use crate::plausibility::{FindingKind, FindingSeverity, of_table};
use crate::report::processing_figure;
use crate::study::{processed_study_text, read_section};
use crate::units::group_of;
use crate::wind_tunnel::campaign::Campaign;
use crate::wind_tunnel::processing::{Processed, ProcessingOptions, ProcessingReport, process};
use crate::wind_tunnel::{RawCampaign, RecordSource};
use std::path::{Path, PathBuf};

/// File of the table of derivatives.
const TABLE: &str = "derivatives.csv";
/// File of what was done.
const REPORT: &str = "processing.json";
/// The page; not the name of a study's, which may stand in the same folder.
const PAGE: &str = "processing.html";
/// File of the study.
const STUDY: &str = "study.toml";

/// Process the raw runs of a campaign into records, derivatives and a study that `aerodeck study` can run
///
/// Example: aerodeck process campaign.toml --out results
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct ProcessArgs {
    /// The campaign file.
    campaign: PathBuf,
    /// Folder of the results.
    #[arg(long)]
    out: PathBuf,
    /// Options of processing (TOML; see docs/processing.md); left out, the defaults.
    #[arg(long)]
    options: Option<PathBuf>,
    /// Cut-off of the low-pass filter, Hz; overrides the options file.
    #[arg(long)]
    cutoff_hz: Option<f64>,
    /// Lag of the force channels, s, instead of an estimate; overrides the options file.
    #[arg(long, allow_negative_numbers = true)]
    lag_s: Option<f64>,
    /// A study whose section, models and search go into the new one.
    #[arg(long)]
    study: Option<PathBuf>,
    /// A file with the [section] that is to be built, for the new study (before that of --study); with neither, the new
    /// study has a marked place for it.
    #[arg(long)]
    section: Option<PathBuf>,
    /// Replace a study file that differs from what is written.
    #[arg(long)]
    force: bool,
    /// Static coefficients, whose quasi-steady limits are drawn beside the derivatives: an embedded table or a .csv file.
    #[arg(long)]
    static_coefficients: Option<String>,
}

/// Runs the command.
pub(crate) fn run(args: &ProcessArgs, progress: &Progress) -> Result<Answer> {
    let options = args.options()?;
    let base = args.study.as_ref().map(|p| Study::read(p)).transpose()?;
    let section = args.section.as_ref().map(|p| read_section(p)).transpose()?;
    let work = || Campaign::read(&args.campaign)?.load();
    let raw = progress.during("reading the campaign", work)?;
    let mut notes = raw.words(FindingSeverity::Note);
    let mut doubts = raw.words(FindingSeverity::Doubt);
    let processed = progress.counting("processing", |on_done| process(&raw, &options, on_done));
    let processed = processed.map_err(|e| e.in_file(&args.campaign))?;
    doubts.extend(processed.report.doubts());
    notes.extend(processed.report.warnings());
    let derivatives = progress.during("derivatives", || derivatives(&processed, &mut notes))?;
    let known = derivatives.iter();
    doubts.extend(known.flat_map(IdentifiedDerivatives::contradictions));
    let mut out = OutputDir::new(&args.out)?;
    outdate(&raw.section, args.force, &mut out);
    let names = write_records(&processed, &mut out)?;
    draw_stages(&processed, &mut out, progress)?;
    out.write_json(REPORT, "processing", &processed.report)?;
    let mut tabled = false;
    if let Some(found) = &derivatives {
        write_derivatives(args, &raw, found, &mut out)?;
        match write_table(&raw.section, found, header(&raw, &notes, &doubts), &mut out) {
            Ok(odd) => {
                tabled = true;
                notes.extend(sentences(&odd));
                let (base, section) = (base.as_ref(), section.as_ref());
                let text = processed_study_text(&raw, base, section, TABLE, &names, found)?;
                let named = base.is_some() || section.is_some();
                notes.extend(write_study(&text, args.force, named, &mut out)?);
            }
            Err(Error::Input(e)) => notes.push(format!("no complete table and no study: {e}")),
            Err(e) => return Err(e),
        }
    }
    if !tabled && !args.force && out.target(STUDY).exists() {
        let note = format!("{STUDY} of an earlier run is left; --force removes it");
        notes.push(note);
    }
    let found = derivatives.as_ref();
    let remarks = [&doubts[..], &notes].concat();
    let page = laboratory_page(&raw, &processed.report, found, &remarks, &out);
    out.write(PAGE, rendered(&page)?)?;
    let mut text = processing_text(&raw, &processed.report, found);
    for (what, texts) in [("doubt", &doubts), ("note", &notes)] {
        text.extend(texts.iter().map(|t| format!("  {what}: {t}\n")));
    }
    let value = serde_json::json!({
        "report": processed.report, "derivatives": derivatives, "doubts": doubts, "notes": notes
    });
    // broadband runs give records, and are not asked for more
    let mut runs = processed.report.runs.iter();
    let stated = &options.segments.frequencies_hz;
    let broadband = stated.is_empty() && runs.all(|run| run.segments.is_empty());
    let passed = derivatives.is_some() || broadband;
    Ok(out.answer(text, value)?.passed_if(passed))
}

/// What an earlier run left of results goes where this one has none of the name; a study, which users edit, only where it is replaced.
fn outdate(section: &str, force: bool, out: &mut OutputDir) {
    let workbook = workbook_name(section);
    for name in [TABLE, "derivatives.json", &workbook] {
        out.outdated(name);
    }
    figures::outdated("derivatives", out);
    if force {
        out.outdated(STUDY);
    }
    let text = std::fs::read_to_string(out.target(REPORT)).unwrap_or_default();
    let Ok(earlier) = json::read::<ProcessingReport>("processing", &text) else {
        return;
    };
    out.outdated(workbook_name(&earlier.section));
    for run in &earlier.runs {
        figures::outdated(&format!("processing/{}", file_name(&run.run)), out);
        out.outdated(record_path(&run.run));
        for segment in &run.segments {
            out.outdated(record_path(&segment.record_name(&run.run)));
        }
    }
}

fn workbook_name(section: &str) -> String {
    format!("AerodynamicDerivatives_{}.xlsx", file_name(section))
}

/// Path of a record from the folder of the results.
fn record_path(name: &str) -> PathBuf {
    Path::new(RECORDS).join(format!("{}.csv", file_name(name)))
}

impl ProcessArgs {
    fn options(&self) -> Result<ProcessingOptions> {
        let mut options = match &self.options {
            None => ProcessingOptions::default(),
            Some(path) => toml_lines::read(path, |text, _| {
                let check = |options: &mut ProcessingOptions| options.validate();
                toml_lines::parse("options of processing", text, check)
            })?,
        };
        options.low_pass.cutoff_hz = self.cutoff_hz.or(options.low_pass.cutoff_hz);
        options.lag_s = self.lag_s.or(options.lag_s);
        options.validate()?;
        Ok(options)
    }

    /// Quasi-steady theory about no rotation, without arms.
    fn quasi_steady(&self, dofs: &[Dof]) -> Result<Option<LinearQuasiSteady>> {
        let Some(name) = &self.static_coefficients else {
            return Ok(None);
        };
        let coefficients = named_coefficients(name, Path::new(""))?;
        QuasiSteady::new(coefficients, Arms::default(), dofs)?
            .linearised(0.0)
            .map(Some)
    }
}

/// The derivatives of the processed records; `None` with a note where these give none.
fn derivatives(
    processed: &Processed,
    notes: &mut Vec<String>,
) -> Result<Option<IdentifiedDerivatives>> {
    let sources: Vec<&dyn RecordSource> = processed.records.iter().map(|r| r as _).collect();
    match identify_derivatives(&sources, &DerivativeOptions::default()) {
        Ok(found) => {
            notes.extend(found.warnings.iter().cloned());
            Ok(Some(found))
        }
        Err(Error::Input(e)) => {
            notes.push(format!("no derivatives: {e}"));
            Ok(None)
        }
        Err(e) => Err(e),
    }
}

/// A figure of the stages of every run.
fn draw_stages(processed: &Processed, out: &mut OutputDir, progress: &Progress) -> Result<()> {
    let count = processed.stages.len();
    let runs = processed.report.runs.iter().zip(&processed.stages);
    progress.counting("figures", |on_done| {
        for ((run, stages), done) in runs.zip(1..) {
            let stem = format!("processing/{}", file_name(&run.run));
            figures::write(&stem, out, || processing_figure(run, stages))?;
            on_done(done, count);
        }
        Ok(())
    })
}

/// The derivatives with all that is known of them, and their figure.
fn write_derivatives(
    args: &ProcessArgs,
    raw: &RawCampaign,
    found: &IdentifiedDerivatives,
    out: &mut OutputDir,
) -> Result<()> {
    out.write_json("derivatives.json", "derivatives", found)?;
    let theory = args.quasi_steady(&found.dofs)?;
    let draw = || plot(raw, found, theory.as_ref());
    figures::write("derivatives", out, draw)
}

/// Writes the study, unless one that was edited stands there; a note when its section is still to be stated.
fn write_study(
    text: &str,
    force: bool,
    section_named: bool,
    out: &mut OutputDir,
) -> Result<Option<String>> {
    out.write(STUDY, text)?;
    let kept = out.keep_edited(STUDY, force)?;
    Ok((!kept && !section_named).then(|| {
        format!(
            "state the section that is to be built in {STUDY}, at the marked place, before `aerodeck study` (or process \
             with --section FILE)"
        )
    }))
}

/// Writes the records; their paths from the folder of the results.
fn write_records(processed: &Processed, out: &mut OutputDir) -> Result<Vec<PathBuf>> {
    let mut names = Vec::with_capacity(processed.records.len());
    for record in &processed.records {
        let name = record_path(&record.header.name);
        let expected = "a name of its own for every run";
        let found = format_args!("`{}` a second time", record.header.name);
        ensure(!names.contains(&name), "campaign", expected, found)?;
        names.push(name);
    }
    out.write_records(names.iter().cloned().zip(&processed.records))?;
    Ok(names)
}

/// What a study of the table has to know.
fn header(raw: &RawCampaign, notes: &[String], doubts: &[String]) -> TableHeader {
    TableHeader {
        source: raw.source.clone(),
        licence: raw.licence.clone(),
        generator: concat!("aerodeck ", env!("CARGO_PKG_VERSION")).to_owned(),
        model_length_m: Some(raw.rig.model_length_m),
        notes: notes.to_vec(),
        doubts: doubts.to_vec(),
        ..TableHeader::default()
    }
}

/// Writes the table, and says what is odd about it beside the doubts of its header.
fn write_table(
    section: &str,
    found: &IdentifiedDerivatives,
    header: TableHeader,
    out: &mut OutputDir,
) -> Result<Vec<Finding>> {
    let table = match found.table(section, header.clone()) {
        Ok(table) => table,
        Err(e) => {
            // one motion alone: its column, in the same columns
            let (points, mut text) = (found.points(), Vec::new());
            write_points(section, found.width_m, &header, &points, &mut text)
                .map_err(|e| Error::io(TABLE, e))?;
            out.write(TABLE, text)?;
            return Err(e);
        }
    };
    let mut text = Vec::new();
    write_csv(&table, &mut text).map_err(|e| Error::io(TABLE, e))?;
    out.write(TABLE, text)?;
    out.write(
        workbook_name(section),
        workbook_bytes_in(&table, &Convention::default())?,
    )?;
    let mut odd = of_table(&table, &Convention::default());
    odd.retain(|f| f.kind != FindingKind::Contradiction);
    Ok(odd)
}

/// Measured points of each speed with the lines of the flat plate and of quasi-steady theory.
fn plot(
    raw: &RawCampaign,
    found: &IdentifiedDerivatives,
    quasi_steady: Option<&LinearQuasiSteady>,
) -> Result<Figure> {
    let largest = found.estimates.iter().map(|e| e.v_hat).fold(0.0, f64::max);
    let lines = |name: &str, model: &dyn Transfer| -> Result<_> {
        Ok((name.to_owned(), derivative_lines(model, largest)?))
    };
    let mut theories = vec![lines("flat plate", &FlatPlate::default())?];
    if let Some(model) = quasi_steady {
        theories.push(lines("quasi-steady", model)?);
    }
    let title = format!("{}: aerodynamic derivatives", raw.section);
    over_v_hat(&title, "95 % interval", |d| DerivativePlot {
        name: d.name().to_owned(),
        measured: measured(found, d),
        bars: found.each(d).map(bar).collect(),
        reference: lines_of(&theories, d),
        ..DerivativePlot::default()
    })
}

/// The estimates of a derivative, one series per mean speed.
fn measured(found: &IdentifiedDerivatives, d: Derivative) -> Vec<PlottedSeries> {
    let (all, groups) = (found.each(d).collect::<Vec<_>>(), found.speed_groups());
    let group = |e: &DerivativeEstimate| group_of(&groups, e.mean_speed_m_s);
    let of_group = |all: &[&DerivativeEstimate]| {
        let points = all.iter().map(|e| (e.v_hat, e.value));
        PlottedSeries::new(speeds_label(&groups[group(all[0])]), points.collect())
    };
    let by_speed = all.chunk_by(|a, b| group(a) == group(b));
    by_speed.map(of_group).collect()
}

/// A 95 % interval from many samples.
fn bar(e: &DerivativeEstimate) -> (f64, f64, f64) {
    const NORMAL_QUANTILE: f64 = 1.96;
    let half = NORMAL_QUANTILE * e.standard_error;
    (e.v_hat, e.value - half, e.value + half)
}

/// Speeds of one group of test points in words.
fn speeds_label(group: &[f64]) -> String {
    match (group[0], group[group.len() - 1]) {
        (low, high) if high - low < 0.05 => format!("{low:.1} m/s"),
        (low, high) => format!("{low:.1} to {high:.1} m/s"),
    }
}
