//! `aerodeck buffeting`: response to turbulence over wind speed, and the page of it.

use super::report::folder::today;
use super::vocabulary::{
    Answer, Error, Figure, OutputDir, PageSection, Progress, Result, SectionsPage, Study,
    TextTable, Verdict, WindStudy, counted, rendered,
};
use super::wind::WindArgs;
use super::{figures, headline};
use crate::buffeting::peak_factor;
use crate::files::report_block::ReportBlock;
use crate::plausibility::significant;
use crate::report::{buffeting_rms_figure, buffeting_spectra_figure, sections_of, shown_in};
use crate::study::{BuffetingStudy, SectionBuffetingBlock, buffeting_study};
use std::fmt::Write as _;
use std::path::Path;

/// The page of the response.
pub(super) const PAGE: &str = "buffeting.html";
/// Key of that page where it is part of a study.
pub(super) const OF_STUDY: &str = "study";
/// Length of record for which peaks are expected, s.
const DURATION_S: f64 = 600.0;

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
        let (factor, unit) = shown_in(*dof);
        format!("{} {:.4} {unit}", dof.symbol(), factor * rms)
    });
    let rms: Vec<String> = rms.collect();
    let speed = significant(last.speed_m_s);
    let line = format!("RMS at {speed} m/s: {}", rms.join(", "));
    let tested = tested(&results);
    let further = results.without_response().into_iter();
    let further = further.chain(tested.lines().map(str::to_owned));
    let line = std::iter::once(line).chain(further);
    let line = line.collect::<Vec<_>>().join("; ");
    write(&study.name, OF_STUDY, &results, Some(verdict), out)?;
    Ok(line)
}

/// What an earlier run of a study left of its response is not of this one, which has none.
pub(super) fn none_of_study(out: &mut OutputDir) {
    let page = std::fs::read_to_string(out.target(PAGE));
    if page.is_ok_and(|page| sections_of(&page, OF_STUDY).is_some()) {
        outdated(out);
    }
}

/// What an earlier run left here, figures at other wind speeds among it.
fn outdated(out: &mut OutputDir) {
    out.outdated(PAGE);
    out.outdated("buffeting.json");
    figures::outdated("buffeting", out);
    out.outdated_numbered("buffeting_spectra_");
}

/// The results, their figures and their page.
fn write(
    name: &str,
    key: &str,
    results: &BuffetingStudy,
    verdict: Option<&Verdict>,
    out: &mut OutputDir,
) -> Result<()> {
    outdated(out);
    out.write_json("buffeting.json", "buffeting-results", results)?;
    let mut drawn = Vec::new();
    let mut draw = |stem: &str, caption: String, figure: Figure| {
        drawn.push((caption, figure.clone()));
        figures::write(stem, out, || Ok(figure))
    };
    if !results.responses.is_empty() {
        let figure = buffeting_rms_figure(name, results)?;
        draw("buffeting", "RMS over wind speed.".to_owned(), figure)?;
    }
    for spectra in &results.spectra {
        let speed = significant(spectra.speed_m_s);
        let title = format!("{name} at {speed} m/s");
        let figure = buffeting_spectra_figure(&title, &results.dofs, &[], spectra)?;
        let caption = format!("Spectra at {speed} m/s times the frequency.");
        draw(&format!("buffeting_spectra_{speed}"), caption, figure)?;
    }
    let page = page(name, key, results, verdict, drawn)?;
    out.write(PAGE, rendered(&page)?)
}

fn text(study: &WindStudy, results: &BuffetingStudy) -> String {
    let dofs = &results.dofs;
    let rms = dofs.iter();
    let rms = rms.map(|d| format!(" | >RMS {} {}", d.symbol(), shown_in(*d).1));
    let crossing = dofs.iter().map(|d| format!(" | >ν {} Hz", d.symbol()));
    let heads: String = rms.chain(crossing).collect();
    let mut table = TextTable::new(&format!(">V m/s{heads}"));
    for response in results.shown() {
        let rms = dofs.iter().zip(&response.rms);
        let rms = rms.map(|(dof, rms)| format!("{:.5}", shown_in(*dof).0 * rms));
        let crossing = response.crossing_frequency_hz.iter();
        let speed = std::iter::once(format!("{:.2}", response.speed_m_s));
        table.row(speed.chain(rms).chain(crossing.map(|f| format!("{f:.4}"))));
    }
    let (name, forces, table) = (&study.name, &results.aerodynamics, table.text());
    let mut text = format!("{name}\nself-excited forces: {forces}\n\n{table}");
    let lines = results.without_response().into_iter();
    text.extend(lines.map(|line| format!("{line}\n")));
    text.push_str(&tested(results));
    text.push_str(&time_domain(results));
    text
}

/// Root mean squares, peaks and accelerations over the wind speed, with the figures; another page takes them up by the `key`.
fn page(
    name: &str,
    key: &str,
    results: &BuffetingStudy,
    verdict: Option<&Verdict>,
    figures: Vec<(String, Figure)>,
) -> Result<SectionsPage> {
    let mut rows = Vec::new();
    for r in results.shown() {
        let mut equilibria = results.mean.iter();
        let mean = equilibria.find(|m| m.speed_m_s == r.speed_m_s);
        for (i, dof) in results.dofs.iter().enumerate() {
            let (factor, unit) = shown_in(*dof);
            let g = peak_factor(r.crossing_frequency_hz[i], DURATION_S);
            let mean = mean.map(|m| format!("{:.5}", factor * m.displacement[i]));
            let about = mean.as_ref().map_or(String::new(), |m| format!("{m} "));
            rows.push(vec![
                format!("{:.2}", r.speed_m_s),
                format!("{}, {unit}", dof.name()),
                mean.unwrap_or("–".to_owned()),
                format!("{:.5}", factor * r.rms[i]),
                format!("{g:.2}"),
                format!("{about}±{:.5}", factor * g * r.rms[i]),
                format!("{:.5}", factor * r.acceleration_rms[i]),
            ]);
        }
    }
    let table = PageSection {
        title: "Response to turbulence".to_owned(),
        text: std::iter::once(format!(
            "RMS about the mean, in the frequency domain; self-excited forces: {}. Mean: by the static coefficients, where some are \
             stated. g: expected peak factor in {DURATION_S} s. The last column is the RMS of the acceleration, per s².",
            results.aerodynamics
        ))
        .chain(results.shortened())
        .chain(results.without_response().into_iter().map(|line| format!("No response {line}.")))
        .chain([tested(results), time_domain(results)].concat().lines().map(str::to_owned))
        .filter(|line| !line.is_empty())
        .collect(),
        header: "V m/s | motion | mean | RMS | g | mean ± expected peak | acceleration",
        rows,
        figures,
    };
    let answered = results.responses.len();
    Ok(SectionsPage {
        title: name.to_owned(),
        subtitle: "Response of a section to turbulence".to_owned(),
        verdict: verdict.cloned().unwrap_or_default(),
        answer: match results.left_out.len() {
            0 => format!("Response at {answered} wind speeds"),
            none => format!("Response at {answered} of {} wind speeds", answered + none),
        },
        of: ReportBlock::default().dated(Some(&today()?)),
        key: key.to_owned(),
        sections: vec![table],
    })
}

/// How much of the response lies inside the tested range, where it does least.
fn tested(results: &BuffetingStudy) -> String {
    let least = results
        .responses
        .iter()
        .filter_map(|r| Some((r.speed_m_s, r.part_in_tested_range.as_ref()?)))
        .map(|(v, parts)| (v, parts.iter().copied().fold(f64::INFINITY, f64::min)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    least.map_or(String::new(), |(speed, part)| {
        format!(
            "variance inside the tested range of K: {:.0} % at least (at {speed:.2} m/s); the rest is extrapolation\n",
            100.0 * part
        )
    })
}

/// Both domains side by side, at the speeds of the time domain.
fn time_domain(results: &BuffetingStudy) -> String {
    let mut text = String::new();
    for domain in &results.time {
        let e = &domain.ensemble;
        let (speed, records) = (e.speed_m_s, counted(e.rms_of_records.len(), "record"));
        let (seconds, step, warm_up) = (e.duration_s, e.step_s, e.warm_up_s);
        text += &format!("\ntime domain at {speed} m/s: {records} of {seconds:.0} s, ");
        text += &format!("step {step:.4} s, warm-up {warm_up:.0} s\n");
        for c in &domain.comparison {
            let (factor, unit) = shown_in(c.dof);
            let all = [c.time_rms, c.standard_error, c.frequency_rms];
            let ([rms, error, other], off) = (all.map(|x| factor * x), c.deviations);
            text += &format!("  {} RMS {rms:.5} ± {error:.5} {unit}, ", c.dof.symbol());
            text += &format!("frequency domain {other:.5}: {off:+.1} standard errors\n");
        }
        if let (Some(change), Some(fit)) = (&domain.model_change, &results.fit) {
            let of = results.dofs.iter().zip(change);
            let parts = of.map(|(dof, part)| format!("{} {:+.1} %", dof.symbol(), 100.0 * part));
            let parts: Vec<String> = parts.collect();
            let _ = writeln!(
                text,
                "  it takes a model ({fit}), whose RMS in the frequency domain differs from that of the table: {}",
                parts.join(", ")
            );
        }
    }
    text
}
