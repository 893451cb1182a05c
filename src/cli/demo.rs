//! `aerodeck demo`: the whole chain on an embedded measured deck.

use super::study::run_chain;
use super::{Answer, OutputDir, Progress};
use crate::error::Result;
use crate::fmu::package::GrowthPolicy;
use crate::study::{Study, demo_study_text};
use std::path::PathBuf;

const STUDY_FILE: &str = "study.toml";

/// Run the whole chain on a measured bridge deck (NTNU Langenuen LN21-5200), which is built in
///
/// Example: aerodeck demo --out first-look
/// Example: aerodeck demo --bridge --out first-bridge
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct DemoArgs {
    /// Where the results go.
    #[arg(long, default_value = "aerodeck-out")]
    out: PathBuf,
    /// The whole Langenuen bridge with this girder instead of a section of it: 39 modes, their flutter and the motion at it.
    #[arg(long)]
    bridge: bool,
    /// Replace a study file that differs from the demo's.
    #[arg(long)]
    force: bool,
}

/// Runs the command.
pub(crate) fn run(args: &DemoArgs, progress: &Progress) -> Result<Answer> {
    if args.bridge {
        return super::bridge::demo::run(&args.out, args.force, progress);
    }
    let study = Study::from_toml(demo_study_text(), args.out.clone())?;
    let mut out = OutputDir::new(&args.out)?;
    out.write(STUDY_FILE, demo_study_text())?;
    let instead = "run yours with `aerodeck study`, choose another --out";
    out.refuse_edited(STUDY_FILE, args.force, instead)?;
    // what differs is to be replaced from here on
    out.replace(STUDY_FILE);
    let (text, growing) = (demo_study_text(), GrowthPolicy::Refuse);
    run_chain(study, text, None, out, growing, progress)
}
