//! `aerodeck fmu replay`: the runs that an archive carries, repeated.

use crate::cli::vocabulary::{Answer, Error, Progress, Result};
use crate::fmu::importer::{Fmu, LS_REF, LS_REF_MANIFEST, ReplayedRun, replay};
use crate::fmu::package::COMPONENT;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// What the binary of one platform did.
#[derive(Serialize)]
struct PlatformReplay {
    platform: String,
    /// Whether it loads on this machine.
    ran: bool,
    /// Whether every run was the same but for rounding.
    same: bool,
    runs: Vec<ReplayedRun>,
    /// Why it could not be run to its end.
    refusal: Option<String>,
}

/// Runs the command.
pub(super) fn run(path: &Path, progress: &Progress) -> Result<Answer> {
    let stage = progress.stage("repeating the runs of the FMU");
    let fmu = Fmu::open(path)?;
    if !fmu.entries().iter().any(|e| e == LS_REF_MANIFEST) {
        let expected =
            format!("reference runs in {LS_REF} (`fmu export` without --no-reference packs them)");
        return Err(Error::input("archive", expected, "none").in_file(path));
    }
    let mut platforms = Vec::new();
    for platform in fmu.platforms() {
        let on = fmu.on(&platform);
        let done = on.binary().is_ok().then(|| replay(&on));
        let ran = done.is_some();
        let (runs, refusal) = match done.transpose() {
            Ok(runs) => (runs.unwrap_or_default(), None),
            Err(e) => (Vec::new(), Some(e.to_string())),
        };
        platforms.push(PlatformReplay {
            platform,
            ran,
            same: ran && refusal.is_none() && runs.iter().all(|r| r.same),
            runs,
            refusal,
        });
    }
    drop(stage);
    // says which there are
    if platforms.iter().all(|p| !p.ran) {
        fmu.binary()?;
    }
    let same = platforms.iter().all(|p| !p.ran || p.same);
    let file = path.display().to_string();
    let json =
        serde_json::json!({ "fmu": file, "as_the_exporter_meant": same, "platforms": platforms });
    Ok(Answer::new(text(&file, &platforms), &json)?.passed_if(same))
}

/// The run that is furthest off.
fn worst(runs: &[ReplayedRun]) -> Option<&ReplayedRun> {
    runs.iter()
        .max_by(|a, b| a.difference.total_cmp(&b.difference))
}

fn difference(worst: Option<&ReplayedRun>) -> String {
    match worst {
        Some(w) if w.difference > 0.0 => format!(
            "largest difference {:.1e} of the largest value (`{}` at {} s of the run `{}`)",
            w.difference, w.variable, w.time_s, w.name
        ),
        _ => "largest difference 0, to the last bit".to_owned(),
    }
}

fn text(file: &str, platforms: &[PlatformReplay]) -> String {
    let mut text = String::new();
    for p in platforms {
        let platform = &p.platform;
        let why_not = match platform == COMPONENT {
            true => "a component for WebAssembly needs a host of its own",
            false => "it does not load on this machine",
        };
        let _ = match (p.ran, &p.refusal, worst(&p.runs)) {
            (false, ..) => writeln!(text, "{platform}: not run, {why_not}"),
            (true, Some(why), _) => {
                writeln!(text, "{file}, {platform}: not as the exporter meant: {why}")
            }
            (true, None, Some(w)) if !w.same => writeln!(
                text,
                "{file}, {}: not as the exporter meant: in the run `{}` `{}` is {} at {} s, and the archive says {}: they differ by \
                 {:.1e} of its largest value, and rounding makes 1e-9 at most",
                p.platform, w.name, w.variable, w.found, w.time_s, w.expected, w.difference
            ),
            (true, None, worst) => writeln!(
                text,
                "{file}, {}: as the exporter meant: {} runs, {} values, {}",
                p.platform,
                p.runs.len(),
                p.runs.iter().map(|r| r.values).sum::<usize>(),
                difference(worst)
            ),
        };
    }
    text
}
