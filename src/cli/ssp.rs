//! `aerodeck ssp`: a bridge as a system of FMUs.

use super::vocabulary::{Answer, Label, Progress, Result, Runtime, counted};
use super::{bridge, headline, stages};
use crate::fmu::package::write_archive;
use crate::study::bridge::BridgeExportOptions;
use std::path::PathBuf;

/// Systems of FMUs (SSP 1.0)
#[derive(clap::Subcommand)]
pub(super) enum SspCommand {
    /// Pack a bridge as a system: its structure and its wind forces as FMUs of their own, connected, with their parameters
    ///
    /// Example: aerodeck ssp export bridge.toml --out bridge.ssp
    #[command(verbatim_doc_comment)]
    Export {
        /// The bridge file (see docs/bridge.md).
        bridge: PathBuf,
        /// The system; by default `bridge.ssp` beside the bridge file.
        #[arg(long)]
        out: Option<PathBuf>,
        /// Replace a file that is there.
        #[arg(long)]
        force: bool,
        /// Export a bridge that grows below its onset, at reduced frequencies that were not tested.
        #[arg(long)]
        allow_unstable: bool,
    },
}

/// Runs the command.
pub(super) fn run(command: &SspCommand, progress: &Progress) -> Result<Answer> {
    let SspCommand::Export {
        bridge: file,
        out,
        force,
        allow_unstable,
    } = command;
    let study = bridge::read(file, progress)?;
    let stage = progress.stage("packing the system");
    let wanted = BridgeExportOptions {
        allow_unstable: *allow_unstable,
        ..BridgeExportOptions::default()
    };
    let verdict = study.verdict()?;
    let label = Label::default().dated()?;
    let system = study.system(&wanted, &verdict, &Runtime::available()?, &label);
    let system = system.map_err(stages::or_allow_unstable)?;
    let beside = || file.with_file_name("bridge.ssp");
    let path = out.clone().unwrap_or_else(beside);
    write_archive(&path, &system.package()?, *force)?;
    drop(stage);
    let names: Vec<&str> = system.components.iter().map(|c| c.name.as_str()).collect();
    let parameters: usize = system.components.iter().map(|c| c.values.len()).sum();
    let text = headline::text(&study.file.name, &verdict, &[]);
    let (units, joined) = (counted(names.len(), "unit"), names.join(", "));
    let connections = counted(system.connections.len(), "connection");
    let (place, values) = (path.display(), counted(parameters, "parameter"));
    let text = format!("{text}wrote {place}: {units} ({joined}), {connections}, {values}\n");
    let json = serde_json::json!({
        "ssp": path,
        "components": names,
        "connections": system.connections.len(),
        "parameters": parameters,
        "verdict": verdict,
    });
    Ok(Answer::new(text, &json)?.with_outcome_of(&verdict))
}
