//! `aerodeck fmu`: exporting, checking and replaying FMUs.

mod export;
mod replay;

use super::vocabulary::{Answer, Progress, Result};
use crate::fmu::importer::{CheckReport, Fmu};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Export, check and replay FMUs
#[derive(clap::Subcommand)]
pub(super) enum FmuCommand {
    Export(Box<export::FmuExportArgs>),
    /// Check any co-simulation FMU (FMI 2.0 or 3.0) and step it; fails when something is wrong
    ///
    /// The code of the FMU runs in this process, with all your rights: check an archive that you do not trust with --no-run.
    ///
    /// Example: aerodeck fmu check deck_section.fmu
    /// Example: aerodeck fmu check foreign.fmu --no-run
    #[command(verbatim_doc_comment)]
    Check {
        /// The FMU.
        fmu: PathBuf,
        /// Check archive and description alone; no code of the FMU is loaded.
        #[arg(long)]
        no_run: bool,
    },
    /// Repeat the reference runs that an FMU carries (FMI-LS-REF) and say whether it does what its exporter meant
    ///
    /// Every binary that loads on this machine is run; fails when one differs by more than rounding. Its code runs in this process, with
    /// all your rights.
    ///
    /// Example: aerodeck fmu replay deck_section.fmu
    #[command(verbatim_doc_comment)]
    Replay {
        /// The FMU.
        fmu: PathBuf,
    },
}

/// Runs the command.
pub(super) fn run(command: &FmuCommand, progress: &Progress) -> Result<Answer> {
    match command {
        FmuCommand::Export(args) => export::run(args, progress),
        FmuCommand::Check { fmu, no_run } => check(fmu, *no_run, progress),
        FmuCommand::Replay { fmu } => replay::run(fmu, progress),
    }
}

/// Static checks and a run of any co-simulation FMU, FMI 2.0 or 3.0; none of the code in the archive with `no_run`.
fn check(path: &Path, no_run: bool, progress: &Progress) -> Result<Answer> {
    let fmu = Fmu::open(path)?;
    let report = progress.during("checking the FMU", || match no_run {
        true => fmu.check_without_running(),
        false => fmu.check(),
    });
    let passed = report.passed();
    Ok(Answer::new(text(&report), &report)?.passed_if(passed))
}

fn text(report: &CheckReport) -> String {
    let binaries = match report.platforms.join(", ") {
        none if none.is_empty() => "no binaries".to_owned(),
        platforms => format!("binaries for {platforms}"),
    };
    let (file, name, tool) = (&report.file, &report.model_name, &report.generation_tool);
    let count = report.variables;
    let mut text = format!("{file}\n{name} by {tool}, {count} variables, {binaries}\n");
    let _ = match &report.ran {
        Some(binary) => writeln!(text, "its code was run in this process: {binary}"),
        None => writeln!(text, "none of its code was run"),
    };
    for f in &report.findings {
        let (severity, place) = (f.severity.name(), &f.place);
        let (expected, found) = (&f.expected, &f.found);
        text += &format!("  {severity}: {place}: expected {expected}, found {found}\n");
    }
    for t in &report.trials {
        let verdict = if t.passed { "ok    " } else { "FAILED" };
        let _ = writeln!(text, "  {verdict} {}: {}", t.name, t.detail);
    }
    let verdict = match report.passed() {
        true => "passed",
        false => "did not pass",
    };
    let _ = writeln!(text, "{verdict}");
    text
}
