//! `aerodeck validate`: the reference cases, expected against found.

use super::vocabulary::{Answer, Progress, Result};
use crate::reference::{CaseResult, UserCase, run as run_case, run_all, validation_table};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Runs the command.
pub(crate) fn run(
    name: Option<&str>,
    files: &[PathBuf],
    markdown: bool,
    progress: &Progress,
) -> Result<Answer> {
    let results = progress.during("reference cases", || match name {
        Some(name) => run_case(name),
        None if files.is_empty() => run_all(),
        None => {
            // all are read before the first is computed
            let cases = files.iter().map(|file| UserCase::read(file));
            let cases = cases.collect::<Result<Vec<_>>>()?;
            Ok(cases.iter().flat_map(UserCase::run).collect())
        }
    })?;
    let passed = results.iter().all(|r| r.passed);
    let value = serde_json::json!({ "cases": results });
    let answer = match markdown {
        true => Answer::new(validation_table(&results), &value)?.verbatim(),
        false => Answer::new(table(&results), &value)?,
    };
    Ok(answer.passed_if(passed))
}

fn table(results: &[CaseResult]) -> String {
    let mut text = String::new();
    let mut case = "";
    for r in results {
        if r.name != case {
            case = &r.name;
            let _ = writeln!(text, "{case}: {}", r.what);
        }
        let _ = writeln!(text, "  {}", line(r));
    }
    let failed = results.iter().filter(|r| !r.passed).count();
    let all = results.len();
    text += &format!("{all} figures, {failed} outside their tolerance\n");
    text
}

fn line(r: &CaseResult) -> String {
    let verdict = if r.passed { "ok    " } else { "FAILED" };
    let decimals = r.decimals;
    let found = match (r.found, &r.problem) {
        (Some(found), _) => format!("{found:.*}", decimals + 1),
        (None, Some(problem)) => problem.clone(),
        (None, None) => "nothing".to_owned(),
    };
    let deviation = r.deviation;
    let deviation = deviation.map_or(String::new(), |d| format!(" ({d:+.1e})"));
    let source = r.source.words();
    let reason = match &r.reason[..] {
        "" => String::new(),
        reason => format!(": {reason}"),
    };
    format!(
        "{verdict} {}: expected {:.decimals$} {}, found {found}{deviation}, allowed ±{:.1e}{reason}; {source}",
        r.quantity, r.expected, r.unit, r.tolerance
    )
}
