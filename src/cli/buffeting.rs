//! `aerodeck buffeting`: response to turbulence over wind speed.

use super::answer::Answer;
use super::output::OutputDir;
use super::progress::Progress;
use super::text_table::TextTable;
use super::wind::WindArgs;
use super::{buffeting_page, figures, headline};
use crate::error::{Error, Result};
use crate::report::{buffeting_rms_figure, buffeting_spectra_figure, rendered};
use crate::study::{BuffetingStudy, SectionBuffetingBlock, Study, WindStudy, buffeting_study};
use crate::verdict::Verdict;
use std::fmt::Write as _;
use std::path::Path;

/// The page of the response.
pub(super) const PAGE: &str = "buffeting.html";
/// Key of that page where it is part of a study.
pub(super) const OF_STUDY: &str = "study";

/// Runs the command.
pub(crate) fn run(args: &WindArgs, progress: &Progress) -> Result<Answer> {
    let (study, mut out) = args.open()?;
    let speeds = study.speed_range()?.curve_speeds_m_s();
    let results = response(&study, &speeds, progress)?;
    // a requirement is judged where it is stated, also beside a response to turbulence
    let required = study.speeds.required();
    let verdict = required.map(|_| study.verdict()).transpose()?;
    write(&study.name, "", &results, verdict.as_ref(), &mut out)?;
    let text = headline::stated(&study.name, verdict.as_ref()) + &text(&study, &results);
    let value = serde_json::json!({ "verdict": verdict, "buffeting": results, "findings": study.findings() });
    let answer = out.answer(text, value)?;
    Ok(answer.with_outcome_of(verdict.as_ref()))
}

fn response(study: &WindStudy, speeds: &[f64], progress: &Progress) -> Result<BuffetingStudy> {
    progress.counting("records in the time domain", |on_done| {
        buffeting_study(study, speeds, on_done)
    })
}

/// The response of a study's section to the turbulence that it states, and the same in a line; `model` is the file of the
/// exported model.
pub(super) fn of_study(
    study: &Study,
    block: &SectionBuffetingBlock,
    model: &Path,
    verdict: &Verdict,
    out: &mut OutputDir,
    progress: &Progress,
) -> Result<String> {
    let model = std::path::absolute(model).map_err(|e| Error::io(model, e))?;
    let speeds = match block.speeds_m_s.is_empty() {
        true => study.speeds().curve_speeds_m_s(),
        false => block.speeds_m_s.clone(),
    };
    let wind = WindStudy::of_study(study, block, &model);
    let mut results = response(&wind, &speeds, progress)?;
    results.aerodynamics = study.exported()?.name.clone();
    let Some(last) = results.responses.last() else {
        let reason = results.left_out.first().map_or("", |s| &s.reason);
        return Err(Error::Numerical(format!("at no wind speed: {reason}")));
    };
    let rms = results.dofs.iter().zip(&last.rms).map(|(dof, rms)| {
        let (factor, unit) = dof.shown_in();
        format!("{} {:.4} {unit}", dof.symbol(), factor * rms)
    });
    let rms: Vec<String> = rms.collect();
    let line = format!("RMS at {} m/s: {}", last.speed_m_s, rms.join(", "));
    let tested = buffeting_page::tested(&results);
    let further = results.without_response().into_iter();
    let further = further.chain(tested.lines().map(str::to_owned));
    let line = std::iter::once(line).chain(further);
    let line = line.collect::<Vec<_>>().join("; ");
    write(&study.name, OF_STUDY, &results, Some(verdict), out)?;
    Ok(line)
}

/// The results, their figures and their page.
fn write(
    name: &str,
    key: &str,
    results: &BuffetingStudy,
    verdict: Option<&Verdict>,
    out: &mut OutputDir,
) -> Result<()> {
    out.write_json("buffeting.json", "buffeting-results", results)?;
    if !results.responses.is_empty() {
        figures::write("buffeting", out, || buffeting_rms_figure(name, results))?;
    }
    for spectra in &results.spectra {
        let title = format!("{name} at {} m/s", spectra.speed_m_s);
        let stem = format!("buffeting_spectra_{}", spectra.speed_m_s);
        figures::write(&stem, out, || {
            buffeting_spectra_figure(&title, &results.dofs, &[], spectra)
        })?;
    }
    let page = buffeting_page::page(name, key, results, verdict)?;
    out.write(PAGE, rendered(&page)?)
}

fn text(study: &WindStudy, results: &BuffetingStudy) -> String {
    let dofs = &results.dofs;
    let rms = dofs
        .iter()
        .map(|d| format!(" | >RMS {} {}", d.symbol(), d.shown_in().1));
    let crossing = dofs.iter().map(|d| format!(" | >ν {} Hz", d.symbol()));
    let heads: String = rms.chain(crossing).collect();
    let mut table = TextTable::new(&format!(">V m/s{heads}"));
    for response in results.shown() {
        let rms = dofs.iter().zip(&response.rms);
        let rms = rms.map(|(dof, rms)| format!("{:.5}", dof.shown_in().0 * rms));
        let crossing = response.crossing_frequency_hz.iter();
        let speed = std::iter::once(format!("{:.2}", response.speed_m_s));
        table.row(speed.chain(rms).chain(crossing.map(|f| format!("{f:.4}"))));
    }
    let mut text = format!(
        "{}\nself-excited forces: {}\n\n{}",
        study.name,
        results.aerodynamics,
        table.text()
    );
    for line in results.without_response() {
        let _ = writeln!(text, "{line}");
    }
    text.push_str(&buffeting_page::tested(results));
    text.push_str(&buffeting_page::time_domain(results));
    text
}
