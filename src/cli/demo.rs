//! `aerodeck demo`: the whole chain on an embedded measured deck.

use super::answer::Answer;
use super::output::OutputDir;
use super::progress::Progress;
use super::study::run_chain;
use crate::error::{Error, Result};
use crate::study::{Study, demo_study_text};
use std::path::PathBuf;

const STUDY_FILE: &str = "study.toml";

/// Run the whole chain on a measured bridge deck (NTNU Langenuen LN21-5200), which is built in
///
/// Example: aerodeck demo --out first-look
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Where the results go.
    #[arg(long, default_value = "aerodeck-out")]
    out: PathBuf,
}

/// Runs the command.
pub fn run(args: &Args, progress: &Progress) -> Result<Answer> {
    let path = args.out.join(STUDY_FILE);
    if path.exists() {
        let there = std::fs::read_to_string(&path).map_err(|e| Error::io(&path, e))?;
        if there != demo_study_text() {
            return Err(Error::input(
                "",
                "the demo's own study file; run yours with `aerodeck study`, or choose another --out",
                "a file that differs, which was left as it is",
            )
            .in_file(&path));
        }
    }
    let study = Study::from_toml(demo_study_text(), args.out.clone())?;
    let mut out = OutputDir::new(&args.out)?;
    out.write(STUDY_FILE, demo_study_text())?;
    run_chain(&study, out, progress)
}
