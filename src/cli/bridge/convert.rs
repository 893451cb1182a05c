//! `aerodeck bridge convert`: modes of any readable format as one compact file.

use super::summary::named;
use crate::bridge::BridgeMode;
use crate::cli::vocabulary::{Answer, Error, Finding, Result, counted, sentences, warn};
use crate::files::bridge::{BridgeFile, BridgeModes, ModesFormat, write_modes};
use crate::plausibility::FindingSeverity;
use std::path::{Path, PathBuf};

/// Part of the girder's share in the mass of a mode by which nodes that are left out may change what the wind acts on.
const SHARE_WITHIN: f64 = 0.01;
/// Files of our folder of tables; others in it are not read.
const TABLES: [&str; 3] = ["nodes.csv", "modes.csv", "shapes.csv"];

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
    /// Replace a file that is there.
    #[arg(long)]
    force: bool,
}

/// Refuses to leave out the nodes that a doubt is seen by: what is written is judged as what was read.
fn keeps_doubts(whole: &[Finding], thinned: &[Finding]) -> Result<()> {
    let key = |f: &Finding| (f.severity, f.kind, f.place.clone());
    let doubts = whole.iter();
    let mut doubts = doubts.filter(|f| f.severity == FindingSeverity::Doubt);
    let Some(lost) = doubts.find(|d| !thinned.iter().any(|f| key(f) == key(d))) else {
        return Ok(());
    };
    let expected = "as many nodes as show what is odd about all of them";
    Err(Error::input("--every", expected, lost.to_string()))
}

/// Refuses to leave out nodes without which the wind acts on other shapes: `∫φ²` of a mode, rotations times half the width. A change
/// counts by what the girder has of the mass of the mode, so that modes of cables and towers need no finer nodes than others.
fn keeps_shapes(whole: &BridgeModes, thinned: &BridgeModes, width_m: f64) -> Result<()> {
    let square = |of: &BridgeModes, mode: &BridgeMode| -> f64 {
        let of_node = |s: &[f64; 3]| s[0].powi(2) + s[1].powi(2) + (0.5 * width_m * s[2]).powi(2);
        let nodes = of.nodes.iter().zip(&mode.shape);
        nodes.map(|(n, s)| n.length_m * of_node(s)).sum()
    };
    let squares: Vec<f64> = whole.modes.iter().map(|m| square(whole, m)).collect();
    let masses = whole.modes.iter().zip(&squares);
    let per_length = masses.map(|(m, square)| m.generalised_mass / square);
    let least = per_length.fold(f64::INFINITY, f64::min);
    for ((mode, fewer), all) in whole.modes.iter().zip(&thinned.modes).zip(squares) {
        let change = square(thinned, fewer) - all;
        if (change * least / mode.generalised_mass).abs() > SHARE_WITHIN {
            let found = format!(
                "mode {}, of which ∫φ² over the girder would change by {:+.1} %",
                mode.number,
                100.0 * change / all
            );
            let expected = "as many nodes as carry the shapes of all modes";
            return Err(Error::input("--every", expected, found));
        }
    }
    Ok(())
}

/// Refuses to write over what is read, and over another file unless `--force` says so.
fn may_write(args: &BridgeConvertArgs, file: &BridgeFile) -> Result<()> {
    let Ok(target) = args.output.canonicalize() else {
        return Ok(());
    };
    let is_target = |path: &Path| path.canonicalize().is_ok_and(|path| path == target);
    let tables = file.modes.format == ModesFormat::Csv;
    let is_read = |path: &PathBuf| {
        let beside = tables && path.parent() == Some(&file.modes.path);
        let name = path.file_name().unwrap_or_default();
        (!beside || TABLES.iter().any(|t| *t == name)) && is_target(&file.directory.join(path))
    };
    let (expected, found) = if is_target(&args.bridge) || named(file)?.iter().any(is_read) {
        (
            "another file than those the bridge is read from",
            "one of them, which was left as it is",
        )
    } else if args.force {
        return Ok(());
    } else {
        (
            "no file there yet (or --force)",
            "one, which was left as it is",
        )
    };
    Err(Error::input("", expected, found).in_file(&args.output))
}

/// Runs the command.
pub(super) fn run(args: &BridgeConvertArgs) -> Result<Answer> {
    if args.every == 0 {
        return Err(Error::input("--every", "a number from 1 on", "0"));
    }
    let file = BridgeFile::read(&args.bridge)?;
    may_write(args, &file)?;
    let whole = file.read_modes()?;
    let mut modes = whole.thinned(args.every);
    let found = modes.findings();
    keeps_doubts(&whole.findings(), &found)?;
    keeps_shapes(&whole, &modes, file.sections[0].width_m)?;
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
    let value = serde_json::json!({ "file": args.output, "nodes": nodes, "modes": count });
    Answer::new(text, &value)
}
