//! `summary.json` of a bridge and the page that is made from it.

use super::super::headline;
use super::super::output::OutputDir;
use super::super::report::{
    self, AnswerView, BridgeFacts, ModeFacts, REPORT, SUMMARY, SectionFacts,
};
use super::account::beside_the_onset;
use crate::error::Result;
use crate::flutter::{FlutterSearch, Onset};
use crate::plausibility::Finding;
use crate::section::Dof;
use crate::study::bridge::{BridgeFlutter, BridgeStudy};
use serde::Serialize;

/// What was run.
pub(super) struct BridgeRun {
    /// Text of the bridge file.
    pub(super) text: String,
    /// The command that makes the results again.
    pub(super) command: String,
}

/// What `summary.json` holds.
#[derive(Serialize)]
pub(super) struct Summary<'a> {
    #[serde(flatten)]
    facts: BridgeFacts,
    warnings: Vec<String>,
    findings: &'a [Finding],
    /// All onsets found, one entry per route.
    onsets: Vec<&'a Onset>,
    /// The full answer.
    flutter: &'a BridgeFlutter,
    failed: &'a [String],
}

/// Leaves summary and page; `said` is what else was found, in words.
pub(super) fn leave<'a>(
    ran: &BridgeRun,
    (study, results): (&'a BridgeStudy, &'a BridgeFlutter),
    (said, failed): (&[String], &'a [String]),
    out: &mut OutputDir,
) -> Result<Summary<'a>> {
    out.stage(REPORT)?;
    out.stage(SUMMARY)?;
    let summary = Summary {
        facts: BridgeFacts {
            generator: format!("aerodeck {}", env!("CARGO_PKG_VERSION")),
            bridge: study.file.name.clone(),
            bridge_file: ran.text.clone(),
            command: ran.command.clone(),
            answer: answer(results),
            limits: limits(study, results, failed),
            comparisons: [beside_the_onset(results), said.to_vec()].concat(),
            nodes: study.by_model.nodes.len(),
            length_m: study.by_model.nodes.iter().map(|n| n.length_m).sum(),
            width_m: study.by_model.width_m(),
            sections: sections(study),
            modes: modes(study),
            files: out.targets(),
        },
        warnings: study.warnings(),
        findings: &study.findings,
        onsets: results.onsets().collect(),
        flutter: results,
        failed,
    };
    out.write_json(SUMMARY, &summary)?;
    let page = report::page(out.staging(), &out.target(""))?;
    out.write(REPORT, page)?;
    Ok(summary)
}

/// The answer is that of the models, which is searched last.
fn own(results: &BridgeFlutter) -> Option<&FlutterSearch> {
    results.answers.last().map(|a| &a.search)
}

fn answer(results: &BridgeFlutter) -> AnswerView {
    let search = own(results);
    let onset = search.and_then(FlutterSearch::onset);
    let headline = match (onset, search) {
        (Some(onset), _) => onset.headline(),
        (None, Some(search)) => search.explain(),
        (None, None) => "no answer: nothing was searched".to_owned(),
    };
    AnswerView {
        model: "model".to_owned(),
        headline,
        speed_m_s: onset
            .filter(|o| o.headline_m_s().is_ok())
            .map(|o| o.at.speed_m_s),
        required_speed_m_s: None,
        required_speed_met: None,
    }
}

fn limits(study: &BridgeStudy, results: &BridgeFlutter, failed: &[String]) -> Vec<String> {
    let mut limits = Vec::new();
    if let Some(onset) = own(results).and_then(FlutterSearch::onset) {
        limits.extend(headline::limits_of(onset, "the models are"));
    }
    limits.extend(study.warnings());
    if let Some(why) = &results.curves.ended {
        limits.push(format!("The curves end early: {why}"));
    }
    limits.extend(failed.iter().map(|f| format!("failed: {f}")));
    limits
}

fn sections(study: &BridgeStudy) -> Vec<SectionFacts> {
    let both = study.file.sections.iter().zip(&study.sections);
    both.map(|(block, forces)| SectionFacts {
        name: block.name.clone(),
        width_m: block.width_m,
        source: forces.source.clone(),
        licence: forces.licence.clone(),
        tested_range: forces.tested,
    })
    .collect()
}

fn modes(study: &BridgeStudy) -> Vec<ModeFacts> {
    let bridge = &study.by_model;
    let all = bridge.modes.iter().enumerate();
    all.map(|(i, m)| ModeFacts {
        mode: m.number,
        frequency_hz: m.frequency_hz,
        generalised_mass: m.generalised_mass,
        damping_ratio: m.damping_ratio,
        main_motion: Dof::THREE[bridge.main_motion(i)].name().to_owned(),
    })
    .collect()
}
