//! `aerodeck derivatives convert`: the same derivatives in another notation.

use super::TableArgs;
use crate::cli::answer::Answer;
use crate::cli::output::{OutputDir, list};
use crate::error::{Error, Result};
use crate::files::derivatives::workbook_bytes_in;
use crate::files::derivatives::write_csv_in;
use std::path::{Path, PathBuf};

/// Write a table of derivatives in another notation, argument or axes; the result states them
///
/// Example: aerodeck derivatives convert LN21-5200 polimi.csv --to polimi
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    #[command(flatten)]
    table: TableArgs,
    /// The result (.csv, .xlsx).
    out: PathBuf,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Answer> {
    let extension = args
        .out
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase());
    let is_workbook = extension.as_deref() == Some("xlsx");
    let known = is_workbook || extension.as_deref() == Some("csv");
    let name = args.out.file_name().filter(|_| known).ok_or_else(|| {
        let found = args.out.display().to_string();
        Error::input("out", "a file name that ends in .csv or .xlsx", found)
    })?;
    let (table, from) = args.table.read()?;
    let to = args.table.target();
    let bytes = if is_workbook {
        workbook_bytes_in(&table, &to)?
    } else {
        let mut bytes = Vec::new();
        write_csv_in(&table, &to, &mut bytes).map_err(|e| Error::io(&args.out, e))?;
        bytes
    };
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
