//! The files that a bridge file reads, left beside its results.

use super::summary::InputFile;
use crate::cli::output::OutputDir;
use crate::cli::report::folder::digest;
use crate::error::{Error, Result};
use crate::files::bridge::{BridgeFile, ModesFormat};
use crate::files::derivatives::{file_and_sheet, is_table_file};
use std::path::{Component, Path, PathBuf};

/// Folder of the copies, laid out as the files lie around the bridge file.
const INPUTS: &str = "inputs";

/// Leaves the bridge file `at` and what it reads in the folder of results; a file outside the folder of the bridge file is named
/// with its fingerprint alone, and nothing is copied where results and bridge file share a folder.
pub(super) fn leave(at: &Path, file: &BridgeFile, out: &mut OutputDir) -> Result<Vec<InputFile>> {
    let own = PathBuf::from(at.file_name().unwrap_or_default());
    let same = match (out.target("").canonicalize(), file.directory.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    };
    let mut read = vec![own];
    read.extend(named(file)?);
    let mut inputs = Vec::with_capacity(read.len());
    for path in read {
        let from = file.directory.join(&path);
        let bytes = std::fs::read(&from).map_err(|e| Error::io(&from, e))?;
        let below = path.components().all(|c| matches!(c, Component::Normal(_)));
        let sha1 = digest(&bytes);
        let name = match below && !same {
            true => Path::new(INPUTS).join(&path),
            false => path,
        };
        if below && !same {
            out.write(&name, bytes)?;
        }
        let name = name.to_string_lossy().replace('\\', "/");
        inputs.push(InputFile { name, sha1 });
    }
    Ok(inputs)
}

/// The accounts of the fit of a model, from which its interval follows: in `fits/` beside it, or beside its folder.
fn accounts(directory: &Path, model: &Path) -> Vec<PathBuf> {
    let stem = model.file_stem().unwrap_or_default().to_string_lossy();
    let folders = model.ancestors().skip(1).take(2).map(|f| f.join("fits"));
    let names = [".json", ".uncertainty.json"].map(|ending| format!("{stem}{ending}"));
    let all = folders.flat_map(|f| names.clone().map(|name| f.join(name)));
    all.filter(|path| directory.join(path).is_file()).collect()
}

/// Files of modes, tables and models, as the bridge file names them.
pub(super) fn named(file: &BridgeFile) -> Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    if file.modes.format != ModesFormat::Embedded {
        all.push(file.modes.path.clone());
    }
    for section in &file.sections {
        let table = section
            .derivatives
            .iter()
            .filter(|name| is_table_file(name));
        all.extend(table.map(|name| PathBuf::from(file_and_sheet(name.trim()).0)));
        if let Some(model) = &section.model {
            all.push(model.clone());
            all.extend(accounts(&file.directory, model));
        }
    }
    let mut files = Vec::new();
    for path in all {
        let at = file.directory.join(&path);
        if !at.is_dir() {
            files.push(path);
            continue;
        }
        for entry in std::fs::read_dir(&at).map_err(|e| Error::io(&at, e))? {
            let entry = entry.map_err(|e| Error::io(&at, e))?;
            if entry.path().is_file() {
                files.push(path.join(entry.file_name()));
            }
        }
    }
    files.sort();
    files.dedup();
    Ok(files)
}
