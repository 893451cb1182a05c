//! `summary.json` of a bridge and the page that is made from it.

use super::super::output::OutputDir;
use super::super::report::folder::{REPORT, SUMMARY};
use super::super::report::{self, BridgeFacts, ModeFacts, SectionFacts};
use super::account::beside_the_onset;
use crate::error::Result;
use crate::flutter::Onset;
use crate::plausibility::Finding;
use crate::section::Dof;
use crate::study::bridge::{BridgeFlutter, BridgeStudy};
use crate::verdict::Verdict;
use serde::Serialize;

/// What was run.
pub(super) struct BridgeRun {
    /// Text of the bridge file.
    pub(super) text: String,
    /// The command that makes the results again.
    pub(super) command: String,
    /// What was found beside the onset, in words.
    pub(super) comparisons: Vec<String>,
    /// Parts that failed, in words.
    pub(super) failed: Vec<String>,
}

/// What `summary.json` holds.
#[derive(Serialize)]
pub(super) struct BridgeSummary<'a> {
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

/// Leaves summary and page.
pub(super) fn leave<'a>(
    ran: &'a BridgeRun,
    study: &'a BridgeStudy,
    results: &'a BridgeFlutter,
    verdict: &Verdict,
    out: &mut OutputDir,
) -> Result<BridgeSummary<'a>> {
    out.stage(REPORT)?;
    out.stage(SUMMARY)?;
    let summary = BridgeSummary {
        facts: BridgeFacts {
            generator: format!("aerodeck {}", env!("CARGO_PKG_VERSION")),
            bridge: study.file.name.clone(),
            bridge_file: ran.text.clone(),
            command: ran.command.clone(),
            verdict: verdict.clone(),
            comparisons: [beside_the_onset(results), ran.comparisons.clone()].concat(),
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
        failed: &ran.failed,
    };
    out.write_json(SUMMARY, &summary)?;
    let page = report::page(out.staging(), &out.target(""))?;
    out.write(REPORT, page)?;
    Ok(summary)
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
