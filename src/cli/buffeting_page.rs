//! The page of the response of a section to turbulence.

use super::report::folder::today;
use crate::buffeting::peak_factor;
use crate::error::{Result, counted};
use crate::files::report_block::ReportBlock;
use crate::report::{PageSection, SectionsPage, buffeting_rms_figure, buffeting_spectra_figure};
use crate::study::BuffetingStudy;
use crate::verdict::Verdict;
use std::fmt::Write as _;

/// Length of record for which peaks are expected, s.
const DURATION_S: f64 = 600.0;

/// Root mean squares, peaks and accelerations over the wind speed, with the figures; another page takes them up by the `key`.
pub(super) fn page(
    name: &str,
    key: &str,
    results: &BuffetingStudy,
    verdict: Option<&Verdict>,
) -> Result<SectionsPage> {
    let mut rows = Vec::new();
    for r in results.shown() {
        let mut equilibria = results.mean.iter();
        let mean = equilibria.find(|m| m.speed_m_s == r.speed_m_s);
        for (i, dof) in results.dofs.iter().enumerate() {
            let (factor, unit) = dof.shown_in();
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
    let mut figures = Vec::new();
    if !results.responses.is_empty() {
        let figure = buffeting_rms_figure(name, results)?;
        figures.push(("RMS over wind speed.".to_owned(), figure.svg().to_owned()));
    }
    for spectra in &results.spectra {
        let title = format!("{name} at {} m/s", spectra.speed_m_s);
        let figure = buffeting_spectra_figure(&title, &results.dofs, &[], spectra)?;
        let caption = format!("Spectra at {} m/s times the frequency.", spectra.speed_m_s);
        figures.push((caption, figure.svg().to_owned()));
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
    Ok(SectionsPage {
        title: name.to_owned(),
        subtitle: "Response of a section to turbulence".to_owned(),
        verdict: verdict.cloned().unwrap_or_default(),
        answer: match results.left_out.len() {
            0 => format!("Response at {} wind speeds", results.responses.len()),
            none => format!(
                "Response at {} of {} wind speeds",
                results.responses.len(),
                results.responses.len() + none
            ),
        },
        of: ReportBlock::default().dated(Some(&today()?)),
        key: key.to_owned(),
        sections: vec![table],
    })
}

/// How much of the response lies inside the tested range, where it does least.
pub(super) fn tested(results: &BuffetingStudy) -> String {
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
pub(super) fn time_domain(results: &BuffetingStudy) -> String {
    let mut text = String::new();
    for domain in &results.time {
        let e = &domain.ensemble;
        let _ = writeln!(
            text,
            "\ntime domain at {} m/s: {} of {:.0} s, step {:.4} s, warm-up {:.0} s",
            e.speed_m_s,
            counted(e.rms_of_records.len(), "record"),
            e.duration_s,
            e.step_s,
            e.warm_up_s
        );
        for c in &domain.comparison {
            let (factor, unit) = c.dof.shown_in();
            let _ = writeln!(
                text,
                "  {} RMS {:.5} ± {:.5} {}, frequency domain {:.5}: {:+.1} standard errors",
                c.dof.symbol(),
                factor * c.time_rms,
                factor * c.standard_error,
                unit,
                factor * c.frequency_rms,
                c.deviations
            );
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
