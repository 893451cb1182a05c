//! `aerodeck bridge convert`: modes of any readable format as one compact file.

use super::super::answer::Answer;
use super::super::common::warn;
use crate::error::{Error, Result, counted};
use crate::files::bridge::{BridgeFile, write_modes};
use crate::plausibility::{Finding, FindingSeverity, sentences};
use std::path::PathBuf;

/// Write the modes that a bridge file names as one compact CSV file, in the signs of this program
///
/// Example: aerodeck bridge convert bridge.toml modes.csv --every 4
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct BridgeConvertArgs {
    /// The bridge file, whose modes are read.
    bridge: PathBuf,
    /// The file to be written.
    output: PathBuf,
    /// Keep every n-th node only, and both ends.
    #[arg(long, default_value_t = 1)]
    every: usize,
    /// Where the figures come from, for the header; left out, the path of the files.
    #[arg(long)]
    source: Option<String>,
    /// Licence of the figures, for the header.
    #[arg(long, default_value = "not stated")]
    licence: String,
}

/// Refuses to leave out the nodes that a doubt is seen by: what is written is judged as what was read.
fn keeps_doubts(whole: &[Finding], thinned: &[Finding]) -> Result<()> {
    let key = |f: &Finding| (f.severity, f.kind, f.place.clone());
    let mut doubts = whole
        .iter()
        .filter(|f| f.severity == FindingSeverity::Doubt);
    let Some(lost) = doubts.find(|d| !thinned.iter().any(|f| key(f) == key(d))) else {
        return Ok(());
    };
    let expected = "as many nodes as show what is odd about all of them";
    Err(Error::input("--every", expected, lost.to_string()))
}

/// Runs the command.
pub(super) fn run(args: &BridgeConvertArgs) -> Result<Answer> {
    if args.every == 0 {
        return Err(Error::input("--every", "a number from 1 on", "0"));
    }
    let file = BridgeFile::read(&args.bridge)?;
    let whole = file.read_modes()?;
    let mut modes = whole.thinned(args.every);
    let found = modes.findings();
    keeps_doubts(&whole.findings(), &found)?;
    warn(&args.bridge, &sentences(&found));
    if let Some(source) = &args.source {
        modes.source.clone_from(source);
    }
    let mut bytes = Vec::new();
    let generator = format!("aerodeck bridge convert --every {}", args.every);
    let wrote = write_modes(&modes, &args.licence, &generator, &mut bytes);
    wrote
        .and_then(|()| std::fs::write(&args.output, &bytes))
        .map_err(|e| Error::io(&args.output, e))?;
    let (nodes, count) = (modes.nodes.len(), modes.modes.len());
    let text = format!(
        "{}: {}, {}\n",
        args.output.display(),
        counted(nodes, "node"),
        counted(count, "mode")
    );
    Answer::new(
        text,
        &serde_json::json!({ "file": args.output, "nodes": nodes, "modes": count }),
    )
}
