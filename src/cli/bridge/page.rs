//! The summary of a bridge and the page that is made from it.

use super::super::output::OutputDir;
use super::super::report;
use super::super::report::folder::{REPORT, SUMMARY};
use super::summary::{BridgeRun, BridgeSummary};
use crate::error::Result;
use crate::study::bridge::{BridgeFlutter, BridgeStudy};
use crate::verdict::Verdict;

/// Leaves both.
pub(super) fn leave(
    ran: &BridgeRun,
    study: &BridgeStudy,
    results: &BridgeFlutter,
    verdict: &Verdict,
    out: &mut OutputDir,
) -> Result<BridgeSummary> {
    out.stage(REPORT)?;
    out.stage(SUMMARY)?;
    let summary = BridgeSummary::of(ran, study, results, verdict, out.targets())?;
    out.write_json(SUMMARY, &summary)?;
    report::leave(out)?;
    Ok(summary)
}
