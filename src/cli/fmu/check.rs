//! `aerodeck fmu check`: static checks and a run of any co-simulation FMU, FMI 2.0 or 3.0.

use crate::cli::answer::Answer;
use crate::cli::progress::Progress;
use crate::error::Result;
use crate::fmu::importer::{CheckReport, Fmu};
use std::fmt::Write as _;
use std::path::Path;

/// Runs the command; none of the code in the archive with `no_run`.
pub(super) fn run(path: &Path, no_run: bool, progress: &Progress) -> Result<Answer> {
    let fmu = Fmu::open(path)?;
    let report = progress.during("checking the FMU", || match no_run {
        true => fmu.check_without_running(),
        false => fmu.check(),
    });
    let passed = report.passed();
    Ok(Answer::new(text(&report), &report)?.passed_if(passed))
}

fn text(report: &CheckReport) -> String {
    let mut text = format!(
        "{}\n{} by {}, {} variables, {}\n",
        report.file,
        report.model_name,
        report.generation_tool,
        report.variables,
        match report.platforms.join(", ") {
            none if none.is_empty() => "no binaries".to_owned(),
            platforms => format!("binaries for {platforms}"),
        }
    );
    let _ = match &report.ran {
        Some(binary) => writeln!(text, "its code was run in this process: {binary}"),
        None => writeln!(text, "none of its code was run"),
    };
    for f in &report.findings {
        let _ = writeln!(
            text,
            "  {}: {}: expected {}, found {}",
            f.severity.name(),
            f.place,
            f.expected,
            f.found
        );
    }
    for t in &report.trials {
        let verdict = if t.passed { "ok    " } else { "FAILED" };
        let _ = writeln!(text, "  {verdict} {}: {}", t.name, t.detail);
    }
    let verdict = if report.passed() {
        "passed"
    } else {
        "did not pass"
    };
    let _ = writeln!(text, "{verdict}");
    text
}
