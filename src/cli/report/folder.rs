//! What a folder of results holds, and whose results they are.

use crate::cli::vocabulary::{Error, Label, Result};
use crate::json;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::Path;

/// The page.
pub(in crate::cli) const REPORT: &str = "report.html";
/// What the page is made from.
pub(in crate::cli) const SUMMARY: &str = "summary.json";

/// Whether a study, and no bridge, has left its summary at `path`.
pub(in crate::cli) fn is_of_a_study(path: &Path) -> bool {
    let text = std::fs::read_to_string(path).ok();
    let summary = text.and_then(|text| serde_json::from_str(&text).ok());
    summary.is_some_and(|summary: Value| summary.is_object() && !is_of_a_bridge(&summary))
}

/// Whether a bridge, and no study, has left the summary.
pub(super) fn is_of_a_bridge(summary: &Value) -> bool {
    summary["bridge"].is_string()
}

/// The day of the run, or that of the variable `SOURCE_DATE_EPOCH`, `YYYY-MM-DD`.
///
/// # Errors
/// [`Error::Input`] where the variable holds no number of seconds.
pub(in crate::cli) fn today() -> Result<String> {
    let now = Label::default().dated()?.generated.unwrap_or_default();
    Ok(now.chars().take(10).collect())
}

/// The summary in `text`, which was read from `path`, as far as it is asked for.
pub(super) fn parsed<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T> {
    json::read("summary", text).map_err(|e| {
        let expected = "the summary of `study`, `demo` or `bridge flutter` of this version";
        Error::json(expected, &e).in_file(path)
    })
}

/// A fingerprint of the bytes of a file.
pub(in crate::cli) fn digest(bytes: &[u8]) -> String {
    sha1_smol::Sha1::from(bytes).digest().to_string()
}
