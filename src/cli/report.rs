//! `aerodeck report`: one self-contained page from a folder of results; `study` and `demo` end with it.

mod bridge;
pub(in crate::cli) mod folder;
mod parts;
mod printed;
mod variables;

use super::bridge::files::BRIDGE_FMU;
use super::buffeting;
use super::headline::own_onset;
use super::measured_forces::FORCES;
use super::result_files::{CURVES, DERIVATIVES, FIGURE, RESPONSE, ROOTS};
use super::stages::{FMU_FILE, MODEL_FILE};
use super::summary::Summary;
use super::vocabulary::{
    Answer, Error, OutputDir, Recommendation, Result, Study, read_text, rendered,
};
use crate::fmu::importer::Fmu;
use crate::fmu::package::{description_of, with_report};
use crate::report::{PageFigure, StudyPage, sections_of, summary_figure};
use folder::{REPORT, SUMMARY, digest, is_of_a_bridge, parsed};
use parts::{card, curves_of, first_derivatives, known, of_svg, round, row, sentence_row, sliders};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::Path;
use variables::variables_of;

/// What an FMU says of itself.
const DESCRIPTION: &str = "modelDescription.xml";

/// Runs the command.
pub(super) fn run(folder: &Path, pdf: bool) -> Result<Answer> {
    let page = page_of(folder)?;
    let mut out = OutputDir::new(folder)?;
    if pdf {
        let at = out.stage(REPORT)?;
        std::fs::write(&at, &page).map_err(|e| Error::io(&at, e))?;
        let pdf = out.stage("report.pdf")?;
        printed::print(&at, &pdf)?;
    }
    out.write(REPORT, page)?;
    out.answer(String::new(), serde_json::json!({}))
}

/// Writes the page of the results that are staged, beside their archive and into it.
///
/// # Errors
/// Those of reading and writing the results.
pub(super) fn leave(out: &mut OutputDir) -> Result<()> {
    for name in [FMU_FILE, BRIDGE_FMU] {
        let fmu = out.staging().join(name);
        if fmu.is_file() {
            let page = page(out.staging(), true)?;
            let bytes = std::fs::read(&fmu).map_err(|e| Error::io(&fmu, e))?;
            out.write(name, with_report(&bytes, &page)?)?;
        }
    }
    let page = page(out.staging(), false)?;
    out.write(REPORT, page)
}

/// The page of the results that stand in `folder`.
///
/// # Errors
/// Those of reading them.
pub(super) fn page_of(folder: &Path) -> Result<String> {
    page(folder, false)
}

/// The page of the results in `folder`; one `in_the_archive` says nothing of the archive itself.
///
/// # Errors
/// [`Error::Io`] and [`Error::Input`] for a folder without results of `study`, and for a study or a model that was changed since.
fn page(folder: &Path, in_the_archive: bool) -> Result<String> {
    let path = folder.join(SUMMARY);
    let text = std::fs::read_to_string(&path).map_err(|e| Error::io(&path, e))?;
    if is_of_a_bridge(&parsed(&path, &text)?) {
        return bridge::page(folder, &text, in_the_archive);
    }
    let summary: Summary = parsed(&path, &text)?;
    let study_text = study_of(folder, &summary)?;
    let study = Study::from_toml(&study_text, folder.to_path_buf())
        .map_err(|e| e.in_file(folder.join(&summary.study_file)))?;
    let read = |name: &str| std::fs::read(folder.join(name)).ok();
    let mut page = of_summary(&summary, &study);
    page.figures = figures(&|name| std::fs::read_to_string(folder.join(name)).ok());
    page.derivatives = first_derivatives(&mut page.figures);
    let path = folder.join(FMU_FILE);
    let described = path.exists().then(|| description_digest(&path));
    match described.transpose()? {
        own @ Some(_) if own.as_ref() == summary.sha1.get(DESCRIPTION) => {
            page.fmu = FMU_FILE.to_owned();
            page.variables = variables_of(&Fmu::open(&path)?);
        }
        Some(_) => page.whose.push_str(
            " The FMU beside this page is another one, of another model or with other options, and no part of it.",
        ),
        None => {}
    }
    if let Ok(curves) = std::fs::read_to_string(folder.join(CURVES)) {
        (page.speeds, page.curves) = curves_of(&curves, &summary.model)?;
    }
    page.summary = summary_figure(&page)?;
    page.live = sliders(&study, read(MODEL_FILE))?;
    let turbulent = read(buffeting::PAGE).filter(|_| summary.buffeting.is_some());
    let turbulent = turbulent.and_then(|bytes| String::from_utf8(bytes).ok());
    let sections = turbulent.and_then(|text| sections_of(&text, buffeting::OF_STUDY));
    page.taken_up = sections.unwrap_or_default();
    let own = (summary.study_file.clone(), digest(study_text.as_bytes()));
    page.hashes.push(own);
    let is_said = !in_the_archive && !page.fmu.is_empty();
    let said = |name: &&str| is_said || *name != FMU_FILE;
    for name in [MODEL_FILE, FMU_FILE, CURVES].into_iter().filter(said) {
        let hash = read(name).map(|bytes| (name.to_owned(), digest(&bytes)));
        page.hashes.extend(hash);
    }
    page.text = study_text;
    rendered(&page)
}

/// Digest of an FMU's description, whose identity follows from model, options and variables. That of the whole file is not known: the page
/// in it is written last.
fn description_digest(fmu: &Path) -> Result<String> {
    description_of(fmu).map(|bytes| digest(&bytes))
}

/// SHA-1 of what a page takes up of the results of a run that are staged in `folder`.
///
/// # Errors
/// Those of reading them.
pub(super) fn digests_of_run(folder: &Path) -> Result<BTreeMap<String, String>> {
    let mut found = digests(folder)?;
    let path = folder.join(FMU_FILE);
    if path.is_file() {
        found.insert(DESCRIPTION.to_owned(), description_digest(&path)?);
    }
    Ok(found)
}

/// SHA-1 of those files in a folder of results that its page takes up as they are, by name.
///
/// # Errors
/// [`Error::Io`] for a folder or a file that cannot be read.
fn digests(folder: &Path) -> Result<BTreeMap<String, String>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).map_err(|e| Error::io(folder, e))? {
        let path = entry.map_err(|e| Error::io(folder, e))?.path();
        let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
        if name.ends_with(".svg") || [MODEL_FILE, CURVES, buffeting::PAGE].contains(&name) {
            let bytes = std::fs::read(&path).map_err(|e| Error::io(&path, e))?;
            found.insert(name.to_owned(), digest(&bytes));
        }
    }
    Ok(found)
}

/// The text of the study, as it stands in the folder where it does: at the edges of the page people may state something else, but
/// what was computed is of the study, and the other files are those of the run.
fn study_of(folder: &Path, summary: &Summary) -> Result<String> {
    let refused = |name: &str, run: &str, now: &str| {
        let expected =
            format!("the file of the run (SHA-1 {run}), or `study` again for what it holds now");
        let found = format!("changed since the run (SHA-1 {now})");
        Error::input(folder.join(name).display().to_string(), expected, found)
    };
    for (name, now) in digests(folder)? {
        if let Some(run) = summary.sha1.get(&name).filter(|run| **run != now) {
            return Err(refused(&name, run, &now));
        }
    }
    let (name, ran) = (&summary.study_file, &summary.study_text);
    let Ok(text) = read_text(&folder.join(name)) else {
        return Ok(ran.clone());
    };
    let [run, now] = [ran, &text].map(|text| digest(text.as_bytes()));
    match computed_from(&text) == computed_from(ran) {
        true => Ok(text),
        false => Err(refused(name, &run, &now)),
    }
}

/// The keys of a study but for those of the edges of its page.
fn computed_from(text: &str) -> Option<toml::Table> {
    let mut keys: toml::Table = text.parse().ok()?;
    keys.remove("report");
    Some(keys)
}

fn of_summary(summary: &Summary, study: &Study) -> StudyPage {
    let (verdict, found) = (&summary.verdict, &summary.results);
    let own = own_onset(found, &summary.model);
    let selected = summary.selection.as_ref();
    let beside_table = selected.and_then(Recommendation::beside_table);
    let all = found.onsets.iter().chain(&found.undetermined);
    let unstable = found.unstable.iter();
    let unstable = unstable.map(|s| sentence_row(&s.at.model, s.at.method.name(), s.explain()));
    let stable = found.stable.iter();
    let stable = stable.map(|s| sentence_row(&s.model, s.method.name(), s.explain()));
    StudyPage {
        title: summary.study.clone(),
        subtitle: "Flutter of a bridge deck section",
        kind: "study",
        beyond: "The verdict leaves out amplitudes beyond the tests, turbulence and the third dimension.",
        generator: summary.generator.clone(),
        of: study.report.dated(summary.date.as_deref()),
        verdict: verdict.clone(),
        card: own.map_or(vec![], card),
        whose: format!(
            "The answer is that of the model “{}”{}; the other models and routes stand below for comparison.{}",
            summary.model,
            summary.fmu().map_or("", |_| ", which the FMU holds"),
            beside_table.map_or(String::new(), |said| format!(" {said}"))
        ),
        asked: asked(summary, study),
        onsets: all.map(row).chain(unstable).chain(stable).collect(),
        comparisons: summary.comparisons.clone(),
        fits: (summary.fits.iter())
            .map(|f| (f.model.clone(), f.report.clone()))
            .collect(),
        command: format!("aerodeck study {} --out results", summary.study_file),
        licence: summary.licence.lines().next().unwrap_or("").to_owned(),
        onset: own.map(|o| o.at.speed_m_s),
        interval: own.and_then(|o| known(&o.interval)),
        ..StudyPage::default()
    }
}

fn asked(summary: &Summary, study: &Study) -> Vec<(&'static str, String)> {
    let s = &study.section;
    let support =
        |inertia: String, frequency: Option<f64>, stiffness: Option<f64>, damping: f64| {
            let spring = match (frequency, stiffness) {
                (Some(f), _) => format!("{f} Hz in still air"),
                (None, Some(k)) => format!("stiffness {k} per metre"),
                (None, None) => "no spring".to_owned(),
            };
            let percent = round(100.0 * damping);
            format!("{inertia}, {spring}, damping ratio {percent} %")
        };
    let translation = |t: &crate::section::Translation| {
        let mass = format!("{} kg/m", t.mass_kg_m);
        support(mass, t.frequency_hz, t.stiffness_n_m2, t.damping_ratio)
    };
    let t = &s.torsion;
    let inertia = format!("{} kg·m²/m", t.inertia_kg_m2_m);
    let torsion = support(inertia, t.frequency_hz, t.stiffness_n, t.damping_ratio);
    let width = format!("{} m, {} kg/m³", s.width_m, s.air_density_kg_m3);
    let mut asked = vec![("deck", summary.deck.clone()), ("width B, air", width)];
    asked.push(("vertical", translation(&s.vertical)));
    asked.extend(s.lateral.iter().map(|l| ("lateral", translation(l))));
    asked.push(("torsion", torsion));
    if s.axis_offset_m.is_some() || s.mass_offset_m.is_some() {
        let [axis, mass] = [s.axis_offset_m, s.mass_offset_m].map(|x| x.unwrap_or(0.0));
        let text = format!(
            "axis {axis} m downwind of mid-chord, centre of mass {mass} m downwind of the axis"
        );
        asked.push(("offsets", text));
    }
    asked.push(("wind speeds", summary.speeds.explain()));
    let models: Vec<&str> = study.models.iter().map(|m| m.name.as_str()).collect();
    asked.push(("models", models.join(", ")));
    asked
}

fn figures(read: &dyn Fn(&str) -> Option<String>) -> Vec<PageFigure> {
    let all = [
        (
            DERIVATIVES,
            "Derivatives: measured and modelled",
            "Points: measured. Lines: the models, where they were tested. Bars: 95 % interval of the exported model.",
        ),
        (
            FIGURE,
            "Frequency and damping over wind speed",
            "A colour and dash per model, a width per mode; pale outside the tested range. Squares: onset of the FMU, stepped \
             through its C interface. The lowest panel magnifies the damping around zero, with the intervals of the onsets as bars.",
        ),
        (
            FORCES,
            "Records: forces and the model",
            "Three periods of the steady motion nearest the onset in reduced frequency, of one record per motion. Full: the record, \
             measured or made from the deck as the legend says. Dashes: the exported model under the same motion. Dots: what is left.",
        ),
        (
            ROOTS,
            "Root locus",
            "Eigenvalues as the wind rises; right of the upright line motions grow.",
        ),
        (
            RESPONSE,
            "Motion below, at and above the onset",
            "The exported model, released and left alone.",
        ),
    ];
    let drawn = |(stem, title, caption)| of_svg(&read(&format!("{stem}.svg"))?, title, caption);
    all.into_iter().filter_map(drawn).collect()
}
