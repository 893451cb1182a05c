//! The bytes of an archive, and its file: the same entries always give the same bytes.

use super::reference_runs;
use crate::error::{Error, Result};
use crate::fmu::importer::{LS_REF, LS_REF_MANIFEST};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Cursor, Read, Write};
use std::path::Path;
use zip::result::{ZipError, ZipResult};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// Writes the bytes of an archive as [`super::write_fmu`] does.
///
/// # Errors
/// [`Error::Input`] when the file is there and is not to be replaced, or is no archive; [`Error::Io`].
pub fn write_archive(path: &Path, bytes: &[u8], replace: bool) -> Result<()> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let failed = |e| Error::io(path, e);
    let refused = |expected, place| Err(Error::input("archive", expected, place));
    if path.is_dir() {
        return refused("a file, or none yet", "a folder").map_err(|e| e.in_file(path));
    }
    if !folder.is_dir() {
        return refused("a folder to write into", "none").map_err(|e| e.in_file(folder));
    }
    if replace && is_of_another_kind(path) {
        let expected = "no file there yet, or an archive";
        let found = "a file of another kind, which was left as it is";
        return Err(Error::input("archive", expected, found).in_file(path));
    }
    let mut file = tempfile::Builder::new()
        .prefix(".aerodeck-")
        .suffix(".fmu")
        .tempfile_in(folder)
        .map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    readable_by_all(file.as_file()).map_err(failed)?;
    match replace {
        true => file.persist(path).map_err(|e| failed(e.error))?,
        false => file.persist_noclobber(path).map_err(|e| {
            if e.error.kind() == std::io::ErrorKind::AlreadyExists {
                let found = "one, which was left as it is";
                Error::input("archive", "no file there yet", found).in_file(path)
            } else {
                failed(e.error)
            }
        })?,
    };
    Ok(())
}

/// Whether a file is there that is no archive: the model, bridge or table that an archive is made from is never replaced by it.
fn is_of_another_kind(path: &Path) -> bool {
    let Ok(file) = std::fs::File::open(path) else {
        return false;
    };
    let is_empty = file.metadata().is_ok_and(|m| m.len() == 0);
    let described = ZipArchive::new(file).is_ok_and(|zip| {
        let described = |name| zip.index_for_name(name).is_some();
        ["modelDescription.xml", "SystemStructure.ssd"]
            .into_iter()
            .any(described)
    });
    !is_empty && !described
}

/// Temporary files are for their owner alone; an FMU is not.
#[cfg(unix)]
fn readable_by_all(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable_by_all(_: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}

/// Entries in alphabetical order without dates, owners or other traces of the machine.
pub(in crate::fmu) fn archive(files: &BTreeMap<String, Vec<u8>>) -> Result<Vec<u8>> {
    zipped(files).map_err(|e| Error::Numerical(format!("packing: {e}")))
}

fn options_of_entries() -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        // the highest takes twice as long for a quarter of a percent
        .compression_level(Some(7))
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644)
}

fn zipped(files: &BTreeMap<String, Vec<u8>>) -> ZipResult<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(name.as_str(), options_of_entries())?;
        zip.write_all(bytes)?;
    }
    Ok(zip.finish()?.into_inner())
}

/// The description in an archive.
///
/// # Errors
/// [`Error::Input`] for a file that cannot be read as an FMU.
pub(crate) fn description_of(path: &Path) -> Result<Vec<u8>> {
    let read = || -> ZipResult<Vec<u8>> {
        let (mut bytes, file) = (Vec::new(), std::fs::File::open(path)?);
        let mut zip = ZipArchive::new(file)?;
        zip.by_name("modelDescription.xml")?
            .read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    read().map_err(|e| Error::input("archive", "an FMU", e.to_string()).in_file(path))
}

/// The archive of a study with the study's report in it, among the files by which it can be judged; as it is where it carries no
/// such files.
///
/// # Errors
/// [`Error::Input`] for bytes that are no archive.
pub(crate) fn with_report(bytes: &[u8], report: &str) -> Result<Vec<u8>> {
    const NAME: &str = "report.html";
    let failed = |e: ZipError| Error::Numerical(format!("packing: {e}"));
    let mut old = ZipArchive::new(Cursor::new(bytes)).map_err(failed)?;
    let Ok(mut entry) = old.by_name(LS_REF_MANIFEST) else {
        return Ok(bytes.to_vec());
    };
    let mut manifest = String::new();
    entry
        .read_to_string(&mut manifest)
        .map_err(|e| Error::Numerical(format!("packing: {e}")))?;
    drop(entry);
    let manifest = reference_runs::manifest_with_report(&manifest, NAME)?;
    let page = format!("{LS_REF}/{NAME}");
    let mut names: BTreeSet<String> = BTreeSet::from([page.clone()]);
    for name in old.file_names() {
        names.insert(name.map_err(failed)?.into_owned());
    }
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for name in names {
        let new = match name.as_str() {
            LS_REF_MANIFEST => &manifest,
            own if own == page => report,
            // what is there stays compressed as it is
            _ => {
                let entry = old.by_name(&name).map_err(failed)?;
                zip.raw_copy_file(entry).map_err(failed)?;
                continue;
            }
        };
        zip.start_file(name.as_str(), options_of_entries())
            .map_err(failed)?;
        zip.write_all(new.as_bytes())
            .map_err(|e| Error::Numerical(format!("packing: {e}")))?;
    }
    Ok(zip.finish().map_err(failed)?.into_inner())
}
