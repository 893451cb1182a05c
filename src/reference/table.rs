//! The results as a Markdown table.

use super::CaseResult;
use std::fmt::Write;

/// Markdown table of the headline figures, and a sentence that counts all of them.
pub fn validation_table(results: &[CaseResult]) -> String {
    let mut text = String::from(
        "| case | figure | reference | computed | allowed | source |\n|---|---|---|---|---|---|\n",
    );
    let mut last = "";
    for r in results.iter().filter(|r| r.headline) {
        let case = if r.what == last { "" } else { &r.what };
        last = &r.what;
        let found = match r.found {
            Some(found) => with_unit(found, r.decimals, &r.unit),
            None => "no result".into(),
        };
        let mark = if r.passed { "" } else { " **failed**" };
        let _ = writeln!(
            text,
            "| {case} | {} | {} | {found}{mark} | ±{} | {} |",
            escaped(&r.quantity),
            with_unit(r.expected, r.decimals, &r.unit),
            allowed(r),
            escaped(&r.source.words())
        );
    }
    let passed = results.iter().filter(|r| r.passed).count();
    let _ = write!(
        text,
        "\n{passed} of {} reference figures are met; `aerodeck validate` computes and prints all of them.\n",
        results.len()
    );
    text
}

fn with_unit(value: f64, decimals: usize, unit: &str) -> String {
    match unit {
        "" => format!("{value:.decimals$}"),
        "°" => format!("{value:.decimals$}°"),
        _ => format!("{value:.decimals$} {unit}"),
    }
}

fn allowed(result: &CaseResult) -> String {
    // one digit more than the reference shows half of its last digit
    let text = format!("{:.*}", result.decimals + 1, result.tolerance);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A bar would end the cell.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}
