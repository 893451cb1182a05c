//! `aerodeck derivatives convert`: the same derivatives in another notation.

use super::TableArgs;
use crate::aerodynamics::derivatives::write_csv_in;
use crate::cli::answer::Answer;
use crate::cli::output::{OutputDir, list};
use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// Write a table of derivatives in another notation, argument or axes; the header of the result states them
///
/// Example: aerodeck derivatives convert LN21-5200 polimi.csv --to polimi
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    #[command(flatten)]
    table: TableArgs,
    /// The result (.csv).
    out: PathBuf,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Answer> {
    let is_csv = args
        .out
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    let name = args.out.file_name().filter(|_| is_csv).ok_or_else(|| {
        Error::input(
            "out",
            "a file name that ends in .csv",
            args.out.display().to_string(),
        )
    })?;
    let (table, from) = args.table.read()?;
    let to = args.table.target();
    let mut bytes = Vec::new();
    write_csv_in(&table, &to, &mut bytes).map_err(|e| Error::io(&args.out, e))?;
    let folder = match args.out.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut out = OutputDir::new(folder)?;
    out.write(name, bytes)?;
    let written = out.commit()?;
    let mut text = format!(
        "{}: {} derivatives\n  from {from}\n  to   {to}\n",
        table.name,
        table.derivatives().count()
    );
    text.push_str(&list(&written));
    Answer::new(
        text,
        &serde_json::json!({ "table": table.name, "from": from, "to": to, "files": written }),
    )
}
