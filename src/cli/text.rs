//! Results in words and tables, for people.

use super::headline;
use super::study_run::BESIDE;
use super::summary::Summary;
use super::vocabulary::{
    Dof, FlutterStudy, OnsetMethod, Recommendation, Study, TextTable, Written, counted, list,
    speed_or,
};
use crate::flutter::{Onset, OnsetInterval, UnwantedGrowth};
use crate::identification::{ConstraintReport, FitReport};
use crate::study::{Deck, KnownUncertainty};
use crate::verdict::{Divergence, StageFailure};
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// The whole chain: the answer, and what stands beside it; everything else with `verbose`, and on the page.
pub(crate) fn chain(
    study: &Study,
    deck: &Deck,
    summary: &Summary,
    written: &[Written],
    verbose: bool,
) -> String {
    // what was assumed in reading the deck stands beside the deck
    let assumed = deck.warnings();
    let mut text = match verbose {
        true => headline::text(&study.name, &summary.verdict, &assumed),
        false => headline::short(&study.name, &summary.verdict),
    };
    let _ = writeln!(text, "Deck      {}", deck.description());
    // nobody signs for what was taken for granted without having read it
    text.push_str(&deck_warnings(deck));
    text.push_str(&selected(summary.selection.as_ref()));
    let rest = details(study, summary);
    if verbose {
        text.push_str(&rest);
    } else {
        let kind = summary.fits.iter().find(|f| f.model == summary.model);
        let kind = kind.map_or(String::new(), |f| format!(" ({})", f.report.method));
        let held = summary.fmu().map_or("", |_| ", held by the FMU");
        let _ = writeln!(text, "Model     {}{kind}{held}\n", summary.model);
        let found = &summary.results;
        text.push_str(&table(found, &[]));
        for o in &found.undetermined {
            let (model, method) = (&o.at.model, o.at.method.name());
            let _ = writeln!(text, "{model}, {method}: not determined by these data");
        }
        // of the answer itself; those of the others with all of it
        let own = found.onsets.iter().find(|o| o.at.model == summary.model);
        for warning in own.map_or(&[][..], |o| &o.warnings) {
            let _ = writeln!(text, "warning: {}: {warning}", summary.model);
        }
    }
    let buffeting = summary.buffeting.iter();
    text.extend(buffeting.map(|line| format!("Gusts     {line}\n")));
    text.push_str(&failures(&summary.failed));
    let others = rest.lines().filter(|l| l.starts_with("warning: "));
    let warnings = others.filter(|l| !text.contains(l)).count();
    let more = match warnings {
        0 => "fits, intervals, divergence".to_owned(),
        some => format!("{}, fits, intervals, divergence", counted(some, "warning")),
    };
    if summary.study_file == BESIDE {
        let _ = writeln!(
            text,
            "Study     {BESIDE} beside the page is the one that ran, study.toml is another"
        );
    }
    text + "\n" + &ending(written, &more, verbose)
}

/// What the table says of the onset of the model that was selected.
pub(super) fn selected(recommended: Option<&Recommendation>) -> String {
    let said = recommended.and_then(Recommendation::beside_table);
    said.map_or(String::new(), |said| format!("Selected  {said}\n"))
}

/// Where the page stands, files that were left, and what else there is; with `verbose` all files.
pub(super) fn ending(written: &[Written], more: &str, verbose: bool) -> String {
    let page = |w: &&Written| w.path.ends_with(super::report::folder::REPORT);
    let page = written.iter().find(page).map(|w| w.path.display());
    let mut text = page.map_or(String::new(), |page| format!("Page      {page}\n"));
    if verbose {
        return text + "Files\n" + &list(written);
    }
    let kept: Vec<Written> = written.iter().filter(|w| w.kept).cloned().collect();
    text.push_str(&list(&kept));
    let files = counted(written.len(), "file");
    let _ = writeln!(text, "More      {more} and {files} with --verbose");
    text
}

/// What a reader asks for who does not take the answer as it is.
fn details(study: &Study, summary: &Summary) -> String {
    let mut text = String::new();
    let s = &study.section;
    let (width, density) = (to_tenths_of_mm(s.width_m), s.air_density_kg_m3);
    let (mass, inertia) = (s.vertical.mass_kg_m, s.torsion.inertia_kg_m2_m);
    text +=
        &format!("Section   B {width} m, m {mass} kg/m, J {inertia} kg·m²/m, ρ {density} kg/m³; ");
    text += "y and lift up, θ and moment nose-up, per metre\n";
    let _ = writeln!(text, "Speeds    {}\n", study.speeds().explain());
    let fits = summary.fits.iter();
    text.extend(fits.map(|of| fit(&of.model, &of.report, &of.uncertainty)));
    text.push('\n');
    text.push_str(&found(&summary.results));
    let stepped = summary.stepped.iter();
    text.extend(stepped.map(|stepped| format!("{}\n", stepped.explain())));
    text
}

/// One fit.
pub(crate) fn fit(name: &str, report: &FitReport, uncertainty: &KnownUncertainty) -> String {
    let mut text = format!("Fit       {name}: {}\n", report.method);
    let residuals = report.entries.iter().filter_map(|e| {
        let (force, motion) = (force_symbol(e.force), e.motion.symbol());
        Some(format!("{force}{motion} {:.1} %", 100.0 * e.relative_rms?))
    });
    let residuals: Vec<String> = residuals.collect();
    let poles = distinct_poles(report).join(", ");
    let poles = match &poles[..] {
        "" => String::new(),
        some => format!("; poles {some}"),
    };
    let (residuals, condition) = (residuals.join(", "), report.condition_in_words());
    text += &format!("          residual rms {residuals}; {condition}{poles}\n");
    let range = report.tested_range;
    let [low, high] = [range.min, range.max].map(|k| k.full_width());
    let [slow, fast] = [high, low].map(|k| TAU / k);
    text += &format!("          tested K {low:.3} to {high:.3} (V* {slow:.2} to {fast:.2})\n");
    text.extend(report.constraints.iter().map(held));
    match uncertainty {
        Ok(known) => text.extend(known.explain().map(|line| format!("          {line}\n"))),
        Err(reason) => text.push_str(&format!("          no interval of the onset: {reason}\n")),
    }
    let notes = report.notes.iter();
    text.extend(notes.map(|note| format!("          note: {note}\n")));
    text
}

/// What held the fit back, what that costs and what it does to the onset.
fn held(constraints: &ConstraintReport) -> String {
    let mut text = String::new();
    for sentence in &constraints.sentences {
        let _ = writeln!(text, "          held: {sentence}");
    }
    if let Some((cost, points)) = constraints.dearest() {
        let (force, motion) = (force_symbol(cost.force), cost.motion.symbol());
        let _ = write!(
            text,
            "          constraints raise residuals by at most {points:.2} percentage points ({force}{motion})"
        );
    }
    if let Some(onset) = &constraints.onset {
        let [without, with] = [onset.without_m_s, onset.with_m_s].map(|v| speed_or("not found", v));
        let _ = write!(text, "; onset {without} without them, {with} with them");
    }
    text.push('\n');
    text
}

fn distinct_poles(report: &FitReport) -> Vec<String> {
    let poles = report.entries.iter().flat_map(|e| e.poles.clone());
    let mut poles: Vec<f64> = poles.collect();
    poles.sort_by(f64::total_cmp);
    poles.dedup();
    poles.iter().map(|p| format!("{p:.3}")).collect()
}

fn force_symbol(dof: Dof) -> &'static str {
    match dof {
        Dof::Vertical => "L",
        Dof::Lateral => "D",
        Dof::Torsion => "M",
    }
}

/// Everything that was found on the models of a study.
pub(super) fn found(results: &FlutterStudy) -> String {
    let growths = results.growth.iter().map(|g| growth(&g.model, g));
    let growths: String = growths.collect();
    let (divergence, deviations) = (divergence(&results.divergence), deviations(results));
    onsets(results) + &growths + &divergence + &deviations
}

/// The onsets side by side, with what is to be said of each.
pub(crate) fn onsets(results: &FlutterStudy) -> String {
    let mut text = table(results, &results.undetermined);
    let warnings = |model: &str, all: &[String]| -> String {
        let all = all.iter();
        all.map(|w| format!("warning: {model}: {w}\n")).collect()
    };
    for o in &results.onsets {
        text.push_str(&without_interval(o));
        text.push_str(&warnings(&o.at.model, &o.warnings));
    }
    let unstable = results.unstable.iter();
    text.extend(unstable.map(|s| warnings(&s.at.model, &s.warnings)));
    text
}

/// A line per model and route, with those of the onsets that are not determined.
fn table(results: &FlutterStudy, undetermined: &[Onset]) -> String {
    let mut table = of_onsets("Flutter onset | method");
    let name = |model: &str, method: OnsetMethod| [model.to_owned(), method.name().to_owned()];
    for o in &results.onsets {
        let name = name(&o.at.model, o.at.method);
        table.row(name.into_iter().chain(figures(o)));
    }
    let mut without = |model: &str, method: OnsetMethod, why: &str| {
        table.sentence(name(model, method), why);
    };
    for o in undetermined {
        let reason = o.headline_m_s().err().unwrap_or_default();
        without(&o.at.model, o.at.method, reason);
    }
    for s in &results.unstable {
        without(&s.at.model, s.at.method, &s.explain());
    }
    for s in &results.stable {
        without(&s.model, s.method, &s.explain());
    }
    table.text()
}

/// A table of onsets: what says whose they are, then their [`figures`].
pub(super) fn of_onsets(whose: &str) -> TextTable {
    TextTable::new(&format!(
        "{whose} | >V m/s | >95 % interval | >f Hz | >V* | tested"
    ))
}

/// The cells of an onset in its columns.
pub(super) fn figures(o: &Onset) -> [String; 5] {
    let tested = match o.in_tested_range {
        Some(true) => "yes",
        Some(false) => "NO",
        None => "exact",
    };
    [
        format!("{:.3}", o.at.speed_m_s),
        interval(&o.interval).replace(" – ", "–"),
        format!("{:.4}", o.at.frequency_hz),
        format!("{:.2}", o.at.reduced_velocity.v_star()),
        tested.to_owned(),
    ]
}

/// What the interval is made of, or why there is no 95 % interval, or none at all.
fn without_interval(o: &Onset) -> String {
    let place = format!("{} ({})", o.at.model, o.at.method.name());
    match &o.interval {
        OnsetInterval::None { reason } => format!("no interval: {place}: {reason}\n"),
        OnsetInterval::Spread { of, .. } => {
            format!("in brackets, no 95 % interval: {place}: {of}\n")
        }
        OnsetInterval::Undetermined { reason, .. } => format!("{place}: {reason}\n"),
        OnsetInterval::Known(error) => {
            format!("standard error: {place}: {}\n", error.parts.explain())
        }
    }
}

/// The ends of an interval.
pub(crate) fn interval(of: &OnsetInterval) -> String {
    match of {
        OnsetInterval::Spread {
            low_m_s, high_m_s, ..
        } => format!("[{low_m_s:.3} – {high_m_s:.3}]"),
        OnsetInterval::Known(error) => format!("{:.3} – {:.3}", error.low_m_s, error.high_m_s),
        OnsetInterval::Undetermined { .. } => "not determined".to_owned(),
        OnsetInterval::None { .. } => "none".to_owned(),
    }
}

/// What the scan for growth below the onset found.
pub(crate) fn growth(model: &str, growth: &UnwantedGrowth) -> String {
    let mark = if growth.is_none() { "" } else { "warning: " };
    format!("{mark}{model}: {}\n", growth.explain())
}

/// Stages that failed.
pub(crate) fn failures(all: &[StageFailure]) -> String {
    all.iter().map(|f| f.explain() + "\n").collect()
}

/// Divergence of each model.
fn divergence(all: &[Divergence]) -> String {
    let assumed = |d: &Divergence| Some(format!("  {}: {}\n", d.forces, d.assumed.as_ref()?));
    let assumed: String = all.iter().filter_map(assumed).collect();
    let speed = |d: &Divergence| format!("{} {}", d.forces, speed_or("none", d.speed_m_s));
    let speeds: Vec<String> = all.iter().map(speed).collect();
    format!("Divergence: {}\n{assumed}", speeds.join(", "))
}

/// What was assumed in reading the deck, and what looks wrong in it.
pub(crate) fn deck_warnings(deck: &Deck) -> String {
    let warnings = deck.warnings().into_iter();
    warnings.map(|w| format!("warning: deck: {w}\n")).collect()
}

/// Deviations from the deck's own onset.
pub(crate) fn deviations(results: &FlutterStudy) -> String {
    let all = results.deviations.iter();
    all.map(|d| d.explain() + "\n").collect()
}

/// A length without the digits that its computation left behind, m.
pub(crate) fn to_tenths_of_mm(length_m: f64) -> f64 {
    (length_m * 1e4).round() / 1e4
}
