//! One run at a time in a folder of results.

use super::interrupt::{Temporary, uninterrupted};
use super::vocabulary::{Error, Result};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read as _, Write as _};
use std::path::Path;

/// Name of the lock, which exists while a run writes into the folder.
pub(crate) const LOCK_FILE: &str = ".aerodeck-lock";

/// Takes the right to write into `folder`. The operating system takes the lock back when the process ends, however it ends, so that a
/// file left behind locks nobody out.
///
/// # Errors
/// [`Error::Input`] naming the other process while one has it; [`Error::Io`] when the file cannot be written.
pub(crate) fn lock(folder: &Path) -> Result<(Temporary, File)> {
    let path = folder.join(LOCK_FILE);
    // an interrupt between making the file and taking charge of it would leave it behind
    let _whole = uninterrupted();
    loop {
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(|e| Error::io(&path, e))?;
        match file.try_lock() {
            // a file system without locks excludes nobody
            Ok(()) | Err(TryLockError::Error(_)) => {}
            Err(TryLockError::WouldBlock) => return Err(taken(folder, &mut file)),
        }
        // a run that ended in between has removed the file that was opened here
        if !is_at(&file, &path) {
            continue;
        }
        let written = file.set_len(0);
        let written = written.and_then(|()| write!(file, "{}", std::process::id()));
        written.map_err(|e| Error::io(&path, e))?;
        // the name is removed first, then the file closed: nobody can take a lock on a file that is about to go
        return Ok((Temporary::new(path), file));
    }
}

fn taken(folder: &Path, file: &mut File) -> Error {
    let mut pid = String::new();
    // another system may lock the contents too
    let _ = file.read_to_string(&mut pid);
    let found = match pid.trim() {
        "" => "another one at work".to_owned(),
        pid => format!("process {pid} at work"),
    };
    let expected = "no other run of aerodeck that writes into this folder (wait for it, or choose another --out)";
    Error::input("", expected, found).in_file(folder)
}

/// Whether the open file is the one that stands at `path`.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(open), Ok(there)) => open.dev() == there.dev() && open.ino() == there.ino(),
        _ => false,
    }
}

/// Whether the open file is the one that stands at `path`.
#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}
