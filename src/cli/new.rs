//! `aerodeck new`: a commented study to begin with.

use super::answer::Answer;
use super::output::{OutputDir, list};
use crate::aerodynamics::derivatives::notation::{Argument, Axes, Notation, StatedConvention};
use crate::error::{Error, Result};
use crate::files::derivatives::named_sheet;
use crate::study::{Deck, Study, new_study_text};
use std::path::{Path, PathBuf};

/// Write a commented study file for an embedded deck, the flat plate or a table of your own
///
/// Example: aerodeck new --workbook AerodynamicDerivatives_LN21_5200.xlsx --out my-bridge.toml
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct NewArgs {
    /// An embedded deck (see `aerodeck derivatives show --help`) or `flat plate`.
    #[arg(long, default_value = "LN21-5200")]
    deck: String,
    /// A table of derivatives of your own (.xlsx, .xls, .ods, .csv).
    #[arg(long, conflicts_with = "deck")]
    workbook: Option<PathBuf>,
    /// The sheet of the workbook that is meant, where several hold derivatives.
    #[arg(long, requires = "workbook")]
    sheet: Option<String>,
    /// Notation of the table, where it does not state it: scanlan, classical, polimi, starossek.
    #[arg(long, value_name = "NOTATION", requires = "workbook")]
    from: Option<Notation>,
    /// What the table is tabulated over: v_hat = V/(omega B), v_star = V/(f B), k_full = omega B/V, k_semi = omega b/V.
    #[arg(long, value_name = "ARGUMENT", requires = "workbook")]
    from_argument: Option<Argument>,
    /// Direction of heave and lift in the table: heave_up, heave_down.
    #[arg(long, value_name = "AXES", requires = "workbook")]
    from_axes: Option<Axes>,
    /// The study file.
    #[arg(long, default_value = "study.toml")]
    out: PathBuf,
    /// Replace a study file that differs.
    #[arg(long)]
    force: bool,
}

/// Runs the command.
pub(crate) fn run(args: &NewArgs) -> Result<Answer> {
    let folder = args.out.parent().filter(|p| !p.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let name = args.out.file_name().ok_or_else(|| {
        let found = args.out.display().to_string();
        Error::input("--out", "the name of a file", found)
    })?;
    let source = match &args.workbook {
        Some(table) => named_sheet(&beside(table, folder)?, args.sheet.as_deref()),
        None => args.deck.clone(),
    };
    let convention = StatedConvention {
        notation: args.from,
        argument: args.from_argument,
        axes: args.from_axes,
    };
    let text = new_study_text(&source, &convention);
    let study = Study::from_toml(&text, folder.to_path_buf())?;
    let deck = Deck::load(&study)?;
    let mut out = OutputDir::new(folder)?;
    out.write(name, &text)?;
    let instead = "choose another --out";
    out.refuse_edited(&name.to_string_lossy(), args.force, instead)?;
    let written = out.commit()?;
    let mut said = format!("{}\n", deck.description());
    for warning in deck.warnings() {
        said.push_str(&format!("warning: deck: {warning}\n"));
    }
    said.push_str(&format!(
        "{}state your section in it, then run `aerodeck study {}`\n",
        list(&written),
        args.out.display()
    ));
    Answer::new(
        said,
        &serde_json::json!({ "deck": deck.description(), "warnings": deck.warnings(), "files": written }),
    )
}

/// The path of a table as the study in `folder` has to name it.
fn beside(table: &Path, folder: &Path) -> Result<String> {
    let full = |path: &Path| path.canonicalize().map_err(|e| Error::io(path, e));
    let here = table.parent().filter(|p| !p.as_os_str().is_empty());
    let table_folder = full(here.unwrap_or(Path::new(".")))?;
    std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
    let name = Path::new(table.file_name().unwrap_or_default());
    let inside = table_folder.strip_prefix(full(folder)?);
    let path = match inside {
        Ok(below) => below.join(name),
        Err(_) => table_folder.join(name),
    };
    Ok(path.to_string_lossy().replace('\\', "/"))
}
