//! Results in words and tables, for people.

use super::study::Summary;
use crate::flutter::{Onset, OnsetInterval};
use crate::identification::FitReport;
use crate::study::{Deck, Deviation, Divergence, KnownUncertainty, OnsetSummary, Study};
use std::fmt::Write as _;

/// The whole chain.
pub fn chain(study: &Study, deck: &Deck, summary: &Summary, files: &str) -> String {
    let mut text = format!("{}\n\n", study.name);
    let s = &study.section;
    let _ = writeln!(text, "Deck      {}", deck.description());
    let _ = writeln!(
        text,
        "Section   B {} m, m {} kg/m, J {} kg·m²/m, ρ {} kg/m³; y and lift up, θ and moment nose-up, per metre of span",
        to_tenths_of_mm(s.width_m),
        s.vertical.mass_kg_m,
        s.torsion.inertia_kg_m2_m,
        s.air_density_kg_m3
    );
    text.push('\n');
    for fit_summary in &summary.fits {
        text.push_str(&fit(
            &fit_summary.model,
            &fit_summary.report,
            &fit_summary.uncertainty,
        ));
    }
    text.push('\n');
    text.push_str(&onsets(&summary.onsets, &summary.stable));
    text.push_str(&divergence(&summary.divergence));
    text.push_str(&deviations(&summary.deviations));
    if let Some(stepped) = &summary.stepped {
        let _ = writeln!(text, "{}", stepped.explain());
    }
    let _ = writeln!(text, "\nFiles");
    text.push_str(files);
    text
}

/// One fit.
pub fn fit(name: &str, report: &FitReport, uncertainty: &KnownUncertainty) -> String {
    let mut text = format!("Fit       {name}: {}\n", report.method);
    let residuals: Vec<String> = report
        .entries
        .iter()
        .filter_map(|e| {
            let rms = e.relative_rms?;
            Some(format!(
                "{}{} {:.1} %",
                force_symbol(e.force),
                e.motion.symbol(),
                100.0 * rms
            ))
        })
        .collect();
    let poles: Vec<String> = distinct_poles(report);
    let _ = writeln!(
        text,
        "          residual rms {}; condition {:.0}{}",
        residuals.join(", "),
        report.condition,
        if poles.is_empty() {
            String::new()
        } else {
            format!("; poles {}", poles.join(", "))
        }
    );
    let _ = writeln!(
        text,
        "          tested K {:.3} to {:.3} (V* {:.2} to {:.2})",
        report.tested_range.min.full_width(),
        report.tested_range.max.full_width(),
        std::f64::consts::TAU / report.tested_range.max.full_width(),
        std::f64::consts::TAU / report.tested_range.min.full_width(),
    );
    match uncertainty {
        Ok(known) => {
            if let Some(line) = known.explain() {
                let _ = writeln!(text, "          {line}");
            }
        }
        Err(reason) => {
            let _ = writeln!(text, "          no interval of the onset: {reason}");
        }
    }
    for note in &report.notes {
        let _ = writeln!(text, "          note: {note}");
    }
    text
}

fn distinct_poles(report: &FitReport) -> Vec<String> {
    let mut poles: Vec<f64> = report
        .entries
        .iter()
        .flat_map(|e| e.poles.clone())
        .collect();
    poles.sort_by(f64::total_cmp);
    poles.dedup();
    poles.iter().map(|p| format!("{p:.3}")).collect()
}

fn force_symbol(dof: crate::section::Dof) -> &'static str {
    match dof {
        crate::section::Dof::Vertical => "L",
        crate::section::Dof::Lateral => "D",
        crate::section::Dof::Torsion => "M",
    }
}

/// The onsets side by side.
pub fn onsets(onsets: &[Onset], stable: &[OnsetSummary]) -> String {
    let mut text = format!(
        "{:<22} {:<12} {:>9} {:>16} {:>8} {:>8} {:>8} {:>8}  {:<9} {}\n",
        "Flutter onset",
        "method",
        "V m/s",
        "95 % interval",
        "f Hz",
        "V*",
        "|y|/B|θ|",
        "phase °",
        "branch",
        "in tested range"
    );
    for o in onsets {
        let _ = writeln!(
            text,
            "{:<22} {:<12} {:>9.3} {:>16} {:>8.4} {:>8.3} {:>8.4} {:>8.1}  {:<9} {}",
            o.model,
            o.method.name(),
            o.speed_m_s,
            interval(&o.interval),
            o.frequency_hz,
            o.reduced_velocity.v_star(),
            o.mode_ratio,
            o.phase_deg,
            o.branch,
            match o.in_tested_range {
                Some(true) => "yes",
                Some(false) => "NO",
                None => "exact",
            }
        );
    }
    for s in stable {
        let _ = writeln!(
            text,
            "{:<22} {:<12} no flutter up to {} m/s",
            s.model,
            s.method.name(),
            s.stable_up_to_m_s
        );
    }
    for o in onsets {
        if let OnsetInterval::None { reason } = &o.interval {
            let _ = writeln!(
                text,
                "no interval: {} ({}): {reason}",
                o.model,
                o.method.name()
            );
        }
        for warning in &o.warnings {
            let _ = writeln!(text, "warning: {}: {warning}", o.model);
        }
    }
    text
}

/// The ends of an interval, with as many digits as it leaves meaning.
pub fn interval(of: &OnsetInterval) -> String {
    match of {
        OnsetInterval::Known {
            low_m_s, high_m_s, ..
        } => {
            let digits = if high_m_s - low_m_s < 0.2 { 3 } else { 2 };
            format!("{low_m_s:.digits$} – {high_m_s:.digits$}")
        }
        OnsetInterval::None { .. } => "none".to_owned(),
    }
}

/// Divergence of each model.
pub fn divergence(all: &[Divergence]) -> String {
    let speeds: Vec<String> = all
        .iter()
        .map(|d| match d.speed_m_s {
            Some(v) => format!("{} {v:.2} m/s", d.model),
            None => format!("{} none", d.model),
        })
        .collect();
    format!("Divergence: {}\n", speeds.join(", "))
}

/// Deviations from the deck's own onset.
pub fn deviations(all: &[Deviation]) -> String {
    all.iter().map(|d| d.explain() + "\n").collect()
}

/// A length without the digits that its computation left behind, m.
pub fn to_tenths_of_mm(length_m: f64) -> f64 {
    (length_m * 1e4).round() / 1e4
}
