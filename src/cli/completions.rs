//! `aerodeck completions`: what a shell needs to complete commands and options.

use super::Cli;
use super::answer::Answer;
use crate::error::Result;
use clap::CommandFactory as _;
use clap_complete::Shell;

/// Print the completions of a shell
///
/// Example: aerodeck completions bash > ~/.local/share/bash-completion/completions/aerodeck
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// The shell.
    shell: Shell,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Answer> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "aerodeck", &mut script);
    let script = String::from_utf8_lossy(&script).into_owned();
    let value = serde_json::json!({ "shell": args.shell.to_string(), "script": script });
    Answer::new(script, &value)
}
