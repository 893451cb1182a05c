//! The summary of a bridge and the page that is made from it.

use super::super::output::OutputDir;
use super::super::report;
use super::super::report::folder::{REPORT, SUMMARY};
use super::summary::BridgeSummary;
use crate::error::Result;
use std::path::Path;

/// Leaves both, with the names of all files in the summary.
pub(super) fn leave(summary: &mut BridgeSummary, out: &mut OutputDir) -> Result<()> {
    out.stage(REPORT)?;
    out.stage(SUMMARY)?;
    summary.files = out.targets();
    out.write_json(SUMMARY, "summary", summary)?;
    report::leave(out)
}

/// Writes the report of `folder` again where it is of the bridge file with this text: it takes up what was computed since.
pub(super) fn renew(folder: &Path, text: &str) -> Result<()> {
    let summary = std::fs::read_to_string(folder.join(SUMMARY)).unwrap_or_default();
    let summary = serde_json::from_str::<serde_json::Value>(&summary).unwrap_or_default();
    if summary["bridge_file"] != text {
        return Ok(());
    }
    let page = report::page_of(folder)?;
    let mut out = OutputDir::new(folder)?;
    out.write(REPORT, page)?;
    out.commit().map(drop)
}
