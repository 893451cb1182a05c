//! The laboratory's report of `process`, printed and as a page: what was found odd, every run, the derivatives with their errors, the
//! stages of each run.

use super::vocabulary::{Dof, Figure, OutputDir, PageSection, SectionsPage, counted, file_name};
use crate::aerodynamics::derivatives::Derivative;
use crate::identification::derivatives::{DerivativeEstimate, IdentifiedDerivatives};
use crate::signal::median;
use crate::wind_tunnel::RawCampaign;
use crate::wind_tunnel::processing::{ProcessingReport, RunReport};
use std::fmt::Write as _;

/// The page; its figures are those that stand in `out`.
pub(super) fn laboratory_page(
    raw: &RawCampaign,
    report: &ProcessingReport,
    found: Option<&IdentifiedDerivatives>,
    notes: &[String],
    out: &OutputDir,
) -> SectionsPage {
    let estimates = found.map_or(&[][..], |f| &f.estimates);
    let caption = "Points: test points of each mean speed, with 95 % intervals. Lines: theory.";
    let derivatives = drawn(out, "derivatives").map(|figure| (caption.to_owned(), figure));
    let stages = report.runs.iter().filter_map(|run| {
        let figure = drawn(out, &format!("processing/{}", file_name(&run.run)))?;
        Some((run.run.clone(), figure))
    });
    let section = |title| PageSection::table(title, "", Vec::new());
    let lag = format!("Lag of the force channels {:.3} ms.", 1e3 * report.lag_s);
    let (count, values) = (
        counted(report.runs.len(), "run"),
        counted(estimates.len(), "value"),
    );
    let remarks = counted(notes.len(), "remark");
    let runs = report.runs.iter().map(run_row);
    SectionsPage {
        title: format!("{}: processing of a campaign", raw.section),
        subtitle: format!(
            "{}; licence: {}",
            raw.source,
            raw.licence.lines().next().unwrap_or("")
        ),
        answer: format!("{count}, {values} of derivatives, {remarks}"),
        sections: vec![
            PageSection {
                text: notes.to_vec(),
                ..section("Remarks")
            },
            PageSection {
                text: vec![lag],
                ..PageSection::table("Runs", "run | what was found", runs.collect())
            },
            PageSection {
                text: vec![
                    "Scanlan's with ½ρV² and K², heave and lift up, over V̂ = V/(ωB).".to_owned(),
                ],
                figures: derivatives.into_iter().collect(),
                ..section("Derivatives")
            },
            PageSection {
                figures: stages.collect(),
                ..section("Stages of the runs")
            },
            PageSection::table(
                "Every derivative at every test point",
                "derivative | V m/s | f Hz | V̂ | value | standard error",
                estimates.iter().map(estimate_row).collect(),
            ),
        ],
        ..SectionsPage::default()
    }
}

fn run_row(run: &RunReport) -> Vec<String> {
    let said = line(run);
    let rest = said.strip_prefix(&format!("{}: ", run.run));
    vec![run.run.clone(), rest.unwrap_or(&said).to_owned()]
}

fn estimate_row(e: &DerivativeEstimate) -> Vec<String> {
    vec![
        e.derivative.name().to_owned(),
        format!("{:.2}", e.mean_speed_m_s),
        format!("{:.3}", e.frequency_hz),
        format!("{:.4}", e.v_hat),
        format!("{:.4}", e.value),
        format!("{:.4}", e.standard_error),
    ]
}

/// A figure that was drawn.
pub(super) fn drawn(out: &OutputDir, stem: &str) -> Option<Figure> {
    let text = std::fs::read_to_string(out.staging().join(format!("{stem}.svg")));
    Figure::of_file(&text.ok()?)
}

/// A run in one line.
fn line(run: &RunReport) -> String {
    let at = crate::wind_tunnel::processing::index(run.dof);
    let replaced: usize = run.replaced.iter().map(|r| r.samples).sum();
    let (unit, way) = match run.dof {
        Dof::Torsion => ("kg·m²", ""),
        Dof::Vertical => ("kg", "downwind of"),
        Dof::Lateral => ("kg", "above"),
    };
    let inertia = run.still_air.as_ref().map(|s| {
        let centre = s.centre_of_mass_m.map(|m| {
            // no zero with a sign
            let mm = (1e4 * m).round() / 10.0 + 0.0;
            format!(" at {mm:.1} mm {way} the axis")
        });
        format!(
            "inertia {:.4} {unit}{}",
            s.inertia,
            centre.unwrap_or_default()
        )
    });
    let inertia = inertia.unwrap_or("no inertia seen".to_owned());
    let still_air = run.alignment.as_ref();
    let still_air = still_air.map(|a| format!("still air {:+.2} samples", a.offset_samples));
    let still_air = still_air.unwrap_or("no still air".to_owned());
    format!(
        "{}: {} at {:.2} m/s, {}, {still_air}, {inertia}, signal {:.0} dB above the noise, {} replaced",
        run.run,
        run.dof.name(),
        run.dimensionless.speed_m_s,
        counted(run.segments.len(), "test point"),
        run.signal_to_noise.after_low_pass_db[at],
        counted(replaced, "sample"),
    )
}

/// What is printed: the lag, every run, the derivatives in all.
pub(super) fn processing_text(
    raw: &RawCampaign,
    report: &ProcessingReport,
    derivatives: Option<&IdentifiedDerivatives>,
) -> String {
    let mut text = format!("{}\n", raw.section);
    let error = report.lag_standard_error_s;
    let error = error.map(|e| format!(" ± {:.3}", 1e3 * e));
    let (lag_ms, error) = (1e3 * report.lag_s, error.unwrap_or_default());
    let _ = writeln!(text, "  lag of the force channels {lag_ms:.3}{error} ms");
    text.extend(report.runs.iter().map(|run| format!("  {}\n", line(run))));
    if let Some(found) = derivatives {
        let estimates = found.estimates.iter().filter(|e| e.value != 0.0);
        let relative = estimates.map(|e| (e.standard_error / e.value).abs());
        let percent = 100.0 * median(&relative.collect::<Vec<_>>());
        let known = Derivative::ALL.into_iter();
        let known = known.filter(|d| found.each(*d).next().is_some()).count();
        let all = found.estimates.len();
        let _ = writeln!(
            text,
            "  {known} derivatives, {all} numbers in all, median standard error {percent:.2} %"
        );
    }
    text
}
