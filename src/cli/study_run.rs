//! The study that was run, left with its results: a folder of results can be run again by itself.

use super::vocabulary::{Error, OutputDir, Result, Study};
use crate::files::derivatives::{file_and_sheet, is_table_file, named_sheet};
use std::path::{Path, PathBuf};

/// Its usual name.
pub(super) const STUDY: &str = "study.toml";
/// Its name where another study stands.
pub(super) const BESIDE: &str = "study_as_run.toml";
/// Folder of the files that it reads.
const INPUTS: &str = "inputs";

/// Leaves the study in the folder of results, with the files that it names; the name under which it stands there, and its text.
pub(crate) fn leave(
    study: &Study,
    text: &str,
    file: Option<&Path>,
    out: &mut OutputDir,
) -> Result<(String, String)> {
    let same = |a: &Path, b: &Path| match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    };
    if let Some(name) = file.and_then(Path::file_name)
        && file.is_some_and(|file| same(file, &out.target(name)))
    {
        return Ok((name.to_string_lossy().into_owned(), text.to_owned()));
    }
    out.outdated(BESIDE);
    let text = self_contained(study, text, file, out)?;
    out.write(STUDY, &text)?;
    if out.keep_edited(STUDY, false)? {
        out.write(BESIDE, &text)?;
        return Ok((BESIDE.to_owned(), text));
    }
    Ok((STUDY.to_owned(), text))
}

/// The text, with copies of what it reads; as it is where it reads nothing.
fn self_contained(
    ran: &Study,
    text: &str,
    file: Option<&Path>,
    out: &mut OutputDir,
) -> Result<String> {
    let mut study = ran.clone();
    let mut copied = 0;
    let mut copy = |path: &Path| -> Result<PathBuf> {
        copied += 1;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        // two folders may hold files of one name
        let at = Path::new(INPUTS).join(format!("{copied:02}_{name}"));
        let from = ran.directory.join(path);
        let bytes = std::fs::read(&from).map_err(|e| Error::io(&from, e))?;
        out.write(&at, bytes)?;
        Ok(at)
    };
    let portable = |path: PathBuf| path.to_string_lossy().replace('\\', "/");
    if is_table_file(&study.deck.source) {
        let (file, sheet) = file_and_sheet(study.deck.source.trim());
        let copied = portable(copy(Path::new(file))?);
        study.deck.source = named_sheet(&copied, sheet);
    }
    for record in &mut study.deck.records {
        *record = copy(record)?;
    }
    if let Some(block) = &mut study.coefficients
        && block.source.ends_with(".csv")
    {
        block.source = portable(copy(Path::new(&block.source))?);
    }
    if let Some(Some(table)) = study.coefficients.as_mut().map(|c| &mut c.arms_from)
        && is_table_file(table)
    {
        *table = portable(copy(Path::new(table.as_str()))?);
    }
    if copied == 0 {
        return Ok(text.to_owned());
    }
    let text = toml::to_string_pretty(&study).map_err(|e| Error::Numerical(e.to_string()))?;
    let file = file.unwrap_or(Path::new(STUDY)).display();
    Ok(format!(
        "# {file} as it was run, with copies of the files that it reads in {INPUTS}/\n{text}"
    ))
}
