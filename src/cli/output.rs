//! Files of a command: written aside first, put in place together, nothing left behind on an error.

use crate::error::{Error, Result};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A directory of results in the making.
pub struct OutputDir {
    directory: PathBuf,
    created: bool,
    staging: Option<TempDir>,
    files: Vec<PathBuf>,
}

/// One file that was put in place.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Written {
    /// Its path.
    pub path: PathBuf,
    /// Whether a file of that name was there before.
    pub replaced: bool,
}

impl OutputDir {
    /// Prepares `directory`, which need not exist.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be made or written to.
    pub fn new(directory: &Path) -> Result<Self> {
        let created = !directory.exists();
        fs::create_dir_all(directory).map_err(|e| Error::io(directory, e))?;
        let staging = tempfile::Builder::new()
            .prefix(".aerodeck-")
            .tempdir_in(directory)
            .map_err(|e| Error::io(directory, e))?;
        Ok(Self {
            directory: directory.to_path_buf(),
            created,
            staging: Some(staging),
            files: Vec::new(),
        })
    }

    /// Where the file will stand.
    pub fn target(&self, name: impl AsRef<Path>) -> PathBuf {
        self.directory.join(name)
    }

    /// Where all files announced so far will stand.
    pub fn targets(&self) -> Vec<PathBuf> {
        self.files.iter().map(|name| self.target(name)).collect()
    }

    /// Path at which to write the file `name` now; it is put in place by [`OutputDir::commit`].
    ///
    /// # Errors
    /// [`Error::Io`] when a folder of the name cannot be made.
    pub fn stage(&mut self, name: impl AsRef<Path>) -> Result<PathBuf> {
        let name = name.as_ref();
        let path = self.staged(name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(|e| Error::io(parent, e))?;
        }
        self.files.push(name.to_path_buf());
        Ok(path)
    }

    /// Writes `bytes` as the file `name`.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&mut self, name: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> Result<()> {
        let path = self.stage(name)?;
        fs::write(&path, bytes).map_err(|e| Error::io(path, e))
    }

    fn staged(&self, name: &Path) -> PathBuf {
        match &self.staging {
            Some(staging) => staging.path().join(name),
            None => self.directory.join(name),
        }
    }

    /// Puts all files in place.
    ///
    /// # Errors
    /// [`Error::Io`] when a file cannot be moved.
    pub fn commit(mut self) -> Result<Vec<Written>> {
        let mut written = Vec::with_capacity(self.files.len());
        for name in std::mem::take(&mut self.files) {
            let (from, to) = (self.staged(&name), self.directory.join(&name));
            if let Some(parent) = to.parent() {
                fs::create_dir_all(parent).map_err(|e| Error::io(parent, e))?;
            }
            let replaced = to.exists();
            fs::rename(&from, &to).map_err(|e| Error::io(&to, e))?;
            written.push(Written { path: to, replaced });
        }
        self.created = false;
        Ok(written)
    }
}

impl Drop for OutputDir {
    fn drop(&mut self) {
        self.staging = None;
        if self.created {
            // fails when somebody else has put a file there meanwhile, which is then not ours to remove
            let _ = fs::remove_dir(&self.directory);
        }
    }
}

/// The files as lines of text.
pub fn list(written: &[Written]) -> String {
    let mut text = String::new();
    for file in written {
        let verb = if file.replaced { "replaced" } else { "wrote" };
        let _ = writeln!(text, "  {verb} {}", file.path.display());
    }
    text
}
