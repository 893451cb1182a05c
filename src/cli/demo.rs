//! `aerodeck demo`: the whole chain on an embedded measured deck.

use super::study::run_chain;
use super::vocabulary::{Answer, OutputDir, Progress, Result, Study};
use crate::study::demo_study_text;
use std::path::Path;

const STUDY_FILE: &str = "study.toml";

/// Runs the command.
pub(crate) fn run(out: &Path, bridge: bool, force: bool, progress: &Progress) -> Result<Answer> {
    if bridge {
        return super::bridge::demo::run(out, force, progress);
    }
    let study = Study::from_toml(demo_study_text(), out.to_path_buf())?;
    let mut out = OutputDir::new(out)?;
    out.write(STUDY_FILE, demo_study_text())?;
    let instead = "run yours with `aerodeck study`, choose another --out";
    out.refuse_edited(STUDY_FILE, force, instead)?;
    // what differs is to be replaced from here on
    out.replace(STUDY_FILE);
    run_chain(study, demo_study_text(), None, out, false, progress)
}
