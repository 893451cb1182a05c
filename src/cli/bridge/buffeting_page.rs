//! The page of a response to turbulence; the report of the bridge takes it up.

use crate::cli::report::folder::{digest, today};
use crate::cli::vocabulary::{
    BridgeStudy, Dof, PageSection, Result, SectionsPage, Verdict, counted,
};
use crate::report::{buffeting_spectra_figure, envelope_figure};
use crate::study::bridge::BridgeBuffeting;
use std::fmt::Write as _;

/// Motions with their unit and the factor to it.
const MOTIONS: [(&str, f64); 3] = [
    ("vertical,\u{a0}m", 1.0),
    ("lateral,\u{a0}m", 1.0),
    ("rotation,\u{a0}°", 180.0 / std::f64::consts::PI),
];

/// A section a wind speed; `text` is that of the bridge file, and `unstable` says why other speeds have no response.
pub(super) fn page(
    study: &BridgeStudy,
    text: &str,
    all: &[BridgeBuffeting],
    unstable: &[String],
    verdict: Option<&Verdict>,
) -> Result<SectionsPage> {
    let speeds = all.iter().map(|b| b.frequency.speed_m_s.to_string());
    let speeds = speeds.collect::<Vec<_>>().join(", ");
    let answer = [format!("Response to turbulence at {speeds} m/s")];
    let sections = all.iter().map(section);
    Ok(SectionsPage {
        title: study.file.name.clone(),
        subtitle: "Response of the whole bridge to turbulence".to_owned(),
        verdict: verdict.cloned().unwrap_or_default(),
        answer: [&answer[..], unstable].concat().join("; "),
        of: study.file.report.dated(Some(&today()?)),
        key: digest(text.as_bytes()),
        sections: sections.collect::<Result<_>>()?,
    })
}

/// A figure of a motion, of which there is none where nothing moves.
pub(super) fn of_motion(rms: f64, figure: String) -> String {
    if rms > 0.0 { figure } else { "–".to_owned() }
}

/// Which forces each domain takes, how far those of the time domain leave the answer, its records, and what was tested.
pub(super) fn forces(results: &BridgeBuffeting) -> String {
    let mut text = String::new();
    if let Some(models) = &results.models {
        text += "frequency domain: tables between their points (or the flat plate, exactly)\n";
        let fits = models.fits.join("; ");
        let _ = writeln!(text, "time domain: models ({fits})");
        if let Some((n, i, change)) = models.largest() {
            let _ = writeln!(
                text,
                "  in the frequency domain their RMS differs from that of the tables by up to {:+.1} % ({} at node {})",
                100.0 * change,
                MOTIONS[i].0.split(',').next().unwrap_or_default(),
                results.nodes[n]
            );
        }
    }
    if let Some(time) = &results.time {
        let (plan, seconds, peak_s) = (&time.plan, time.record_s, time.plan.peak_s());
        let records = counted(plan.records, "record");
        let (step_s, seed) = (plan.step_s, plan.seed);
        let _ = writeln!(
            text,
            "time domain: {records} of {seconds} s, every {step_s} s, seed {seed}; peaks in {peak_s} s"
        );
        text.extend(time.too_short.iter().map(|why| format!("  {why}\n")));
    }
    let no_time = results.no_time.iter();
    text.extend(no_time.map(|why| format!("no time domain: {why}\n")));
    let parts = results.frequency.part_in_tested_range.iter().flatten();
    let least = parts.flatten().copied().reduce(f64::min);
    if let Some(percent) = least.map(|least| 100.0 * least) {
        let _ = writeln!(
            text,
            "variance inside the tested range of K: {percent:.0} % at least; the rest is extrapolation"
        );
    }
    text
}

fn section(of: &BridgeBuffeting) -> Result<PageSection> {
    let speed = of.frequency.speed_m_s;
    let mut rows = Vec::new();
    for (n, name) in of.nodes.iter().enumerate() {
        let at = of.frequency.nodes[n];
        for (i, (motion, factor)) in MOTIONS.into_iter().enumerate() {
            let rms = of.frequency.rms[n][i];
            let (mean, g) = (of.envelope.mean[at][i], of.expected_peak_factor[n][i]);
            let number = |x: f64| format!("{:.4}", factor * x);
            let time = of.time.as_ref().map(|t| number(t.rms[n][i]));
            rows.push(vec![
                name.clone(),
                motion.to_owned(),
                number(mean),
                number(rms),
                time.unwrap_or("–".to_owned()),
                of_motion(rms, format!("{g:.2}")),
                number(mean - g * rms),
                number(mean + g * rms),
                number(of.envelope.acceleration_rms[at][i]),
            ]);
        }
    }
    let envelope = envelope_figure(of, &format!("Along the span at {speed} m/s"))?;
    let title = format!("Spectra at {speed} m/s");
    let spectra = buffeting_spectra_figure(&title, &Dof::THREE, &of.nodes, &of.spectra)?;
    let captions = [
        "Mean, and mean ± expected peak, along the girder.",
        "Spectra of the displacements times the frequency.",
    ];
    let captions = captions.into_iter().map(str::to_owned);
    let figures = captions.zip([envelope, spectra]);
    let of_sections = of.envelope.section_forces.iter().map(|f| {
        let peak = f.peak_factor * f.rms;
        format!(
            "{} of {}: RMS {:.4e}, expected peak ±{peak:.4e} about its mean",
            f.force, f.element, f.rms
        )
    });
    let mut text = vec![
        "Mean by the static coefficients; RMS and peak factor g in the frequency domain, with the RMS of the records beside it; the last \
         column is the RMS of the acceleration, per s²."
            .to_owned(),
    ];
    text.extend(forces(of).lines().map(|line| line.trim().to_owned()));
    text.extend(of_sections);
    Ok(PageSection {
        title: format!("Buffeting at {speed} m/s"),
        text,
        header: "node | motion | mean | RMS | RMS, records | g | mean − peak | mean + peak | acceleration",
        rows,
        figures: figures.collect(),
    })
}
