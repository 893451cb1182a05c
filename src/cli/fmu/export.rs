//! `aerodeck fmu export`: a trained model as an FMU.

use crate::cli::account;
use crate::cli::answer::Answer;
use crate::cli::progress::Progress;
use crate::cli::stages;
use crate::error::{Error, Result};
use crate::fmu::package::{Overwrite, Runtime, growth_of, write_fmu};
use std::path::PathBuf;

/// Pack a trained model (`model.json`, see `train`) as an FMI 2.0 co-simulation FMU
///
/// Example: aerodeck fmu export model.json --out deck_section.fmu
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// The trained model.
    model: PathBuf,
    /// The FMU; by default `deck_section.fmu` beside the model.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Replace a file that is there.
    #[arg(long)]
    force: bool,
    /// Export a model that grows below its onset, at reduced frequencies that were not tested.
    #[arg(long)]
    allow_unstable: bool,
}

/// Runs the command.
pub fn run(args: &Args, progress: &Progress) -> Result<Answer> {
    let model = stages::read_model(&args.model)?;
    let path = args
        .out
        .clone()
        .unwrap_or_else(|| args.model.with_file_name(stages::FMU_FILE));
    let runtimes = Runtime::available()?;
    let overwrite = if args.force {
        Overwrite::Replace
    } else {
        Overwrite::Refuse
    };
    let stage = progress.stage("packing the FMU");
    let growing = stages::growing(args.allow_unstable);
    write_fmu(&path, &model, &runtimes, overwrite, growing).map_err(|e| match e {
        Error::Input(mut input) if !args.force && path.exists() => {
            input.expected.push_str(" (or --force)");
            Error::Input(input)
        }
        other => stages::or_allow_unstable(other),
    })?;
    drop(stage);
    let growth = growth_of(&model)?;
    let platforms: Vec<_> = runtimes.iter().map(|r| r.platform.to_string()).collect();
    let mut text = format!(
        "wrote {}: {}, {}, for {}\n",
        path.display(),
        model.name,
        crate::trained_model::Model::kind(&model.model),
        platforms.join(", ")
    );
    text.push_str(&account::growth(&model.name, &growth));
    Answer::new(
        text,
        &serde_json::json!({ "fmu": path, "model": model.name, "platforms": platforms, "growth": growth }),
    )
}
