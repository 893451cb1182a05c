//! Unpacking an FMU into a temporary directory: nothing outside it, nothing without a limit.

use super::findings::FmuFindings;
use crate::error::{Error, Result, ensure};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use zip::{CompressionMethod, ZipArchive};

/// Most bytes that an FMU may unpack to, 256 MiB.
const MAX_BYTES: u64 = 256 << 20;
/// Most entries.
const MAX_ENTRIES: usize = 100_000;

/// Unpacks the archive, with findings for what is legal for ZIP and not for an FMU.
///
/// # Errors
/// [`Error::Io`] when it cannot be read or written, [`Error::Input`] when it is no ZIP archive, holds entries that
/// would land outside, links or encrypted entries, or is too large.
pub(super) fn unpack(path: &Path) -> Result<(TempDir, Vec<String>, FmuFindings)> {
    let file = File::open(path).map_err(|e| Error::io(path, e))?;
    let mut zip = ZipArchive::new(BufReader::new(file))
        .map_err(|e| Error::input("", "a ZIP archive", e.to_string()))?;
    let most = format_args!("at most {MAX_ENTRIES} entries");
    ensure(zip.len() <= MAX_ENTRIES, "", most, zip.len())?;
    let folder = tempfile::Builder::new()
        .prefix("aerodeck-fmu-")
        .tempdir()
        .map_err(|e| Error::io(std::env::temp_dir(), e))?;
    let (mut names, mut findings, mut left) = (Vec::new(), FmuFindings::default(), MAX_BYTES);
    for index in 0..zip.len() {
        let wrong =
            |expected: &str, e| Error::input(format!("entry {index}"), expected, format!("{e}"));
        let entry = zip.by_index(index);
        let mut entry = entry.map_err(|e| wrong("a readable entry", e))?;
        let name = entry.name().map_err(|e| wrong("a name in UTF-8", e))?;
        let name = name.into_owned();
        let inside = safe_path(&name, &mut findings)?;
        let is_plain = !entry.is_symlink();
        ensure(is_plain, &name, "a file or a folder", "a link")?;
        let method = entry.compression();
        if ![CompressionMethod::Stored, CompressionMethod::Deflated].contains(&method) {
            let place = format!("archive, entry {name:?}");
            let expected = "compression by deflate or none";
            findings.error(place, expected, method.to_string());
        }
        let target = folder.path().join(&inside);
        if entry.is_dir() {
            make_folders(folder.path(), &inside)?;
            continue;
        }
        make_folders(folder.path(), inside.parent().unwrap_or(Path::new("")))?;
        let stated = entry.size();
        left = write(&mut entry, &name, &target, stated, left)?;
        names.push(name.replace('\\', "/"));
    }
    Ok((folder, names, findings))
}

fn safe_path(name: &str, findings: &mut FmuFindings) -> Result<PathBuf> {
    if name.contains('\\') {
        let place = format!("archive, entry {name:?}");
        findings.error(place, "forward slashes", "backslashes");
    }
    let name = name.replace('\\', "/");
    let harmless = !name.is_empty()
        && !name.starts_with('/')
        && !name.contains(['\0', ':'])
        && !name.split('/').any(|part| part == "..");
    let (place, expected) = (format_args!("entry {name:?}"), "a path inside the archive");
    ensure(harmless, place, expected, "one that leads outside")?;
    let parts = name.split('/');
    Ok(parts.filter(|p| !p.is_empty() && *p != ".").collect())
}

/// The folders of `inside` below `root`, which is not made: a program that ends has removed it meanwhile, and it must
/// not come again.
fn make_folders(root: &Path, inside: &Path) -> Result<()> {
    let mut folder = root.to_path_buf();
    for part in inside {
        folder.push(part);
        if !folder.is_dir() {
            std::fs::create_dir(&folder).map_err(|e| Error::io(&folder, e))?;
        }
    }
    Ok(())
}

/// Writes an entry that is `stated` to have so many bytes, where `left` remain of the limit of the archive; returns how many are left for
/// other entries.
fn write(entry: &mut impl Read, name: &str, target: &Path, stated: u64, left: u64) -> Result<u64> {
    let most = format_args!("at most {MAX_BYTES} bytes unpacked in all");
    ensure(stated <= left, name, most, "more")?;
    let mut file = File::create_new(target).map_err(|e| Error::io(target, e))?;
    // the size in the directory is only a claim
    let written = std::io::copy(&mut entry.take(stated + 1), &mut file)
        .map_err(|e| Error::input(name, "an entry that unpacks", e.to_string()))?;
    let expected = format_args!("the {stated} bytes that the archive states");
    ensure(written <= stated, name, expected, "more")?;
    Ok(left - written)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_removed_folder_does_not_come_again() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("root");
        assert!(make_folders(&root, Path::new("binaries/linux64")).is_err());
        assert!(!root.exists());
        std::fs::create_dir(&root).unwrap();
        make_folders(&root, Path::new("binaries/linux64")).unwrap();
        make_folders(&root, Path::new("binaries/x86_64-linux")).unwrap();
        assert!(root.join("binaries/linux64").is_dir());
    }
}
