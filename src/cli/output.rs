//! Files of a command: written aside first, put in place together, nothing left behind however the command ends.

use super::answer::Answer;
use super::interrupt::{Temporary, uninterrupted};
use super::lock::{LOCK_FILE, lock};
use super::wrapping::COLUMNS;
use crate::error::{Error, Result};
use crate::json;
use crate::wind_tunnel::{Record, write_record};
use aerodeck_core::threads;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Start of the names of everything that is not a result.
const PREFIX: &str = ".aerodeck-";
/// Start of the name of a folder whose files are complete and on their way to their places.
const COMPLETE: &str = ".aerodeck-complete-";

/// A directory of results in the making.
///
/// Files are staged in a folder inside. [`OutputDir::commit`] first renames that folder, which marks it as complete, then
/// moves its files; a process killed in between leaves a complete folder, whose files the next run puts in place. The
/// file announced last is taken away before and moved last: where it stands, all others stand.
pub(crate) struct OutputDir {
    directory: PathBuf,
    created: bool,
    staging: Temporary,
    files: Vec<PathBuf>,
    kept: Vec<PathBuf>,
    replaced: Vec<PathBuf>,
    outdated: Vec<PathBuf>,
    _lock: (Temporary, File),
}

/// One file that was put in place, or left.
#[derive(Debug, Clone, serde::Serialize)]
pub(crate) struct Written {
    /// Its path.
    pub path: PathBuf,
    /// Whether a file of that name was there before.
    pub replaced: bool,
    /// Whether the file that was there was left as it is, since it differs.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub kept: bool,
}

impl OutputDir {
    /// Prepares `directory`, which need not exist, and clears away what a killed run left there.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be made or written to; [`Error::Input`] while another run writes into it.
    pub(crate) fn new(directory: &Path) -> Result<Self> {
        let created = !directory.exists();
        if directory.is_file() {
            return Err(Error::input("", "a folder for the results", "a file").in_file(directory));
        }
        fs::create_dir_all(directory).map_err(|e| Error::io(directory, e))?;
        let lock = lock(directory)?;
        clear(directory)?;
        // not while a signal removes what is known to be temporary
        let busy = uninterrupted();
        let staging = tempfile::Builder::new()
            .prefix(PREFIX)
            .tempdir_in(directory)
            .map_err(|e| Error::io(directory, e))?;
        let staging = Temporary::new(staging.keep());
        drop(busy);
        Ok(Self {
            directory: directory.to_path_buf(),
            created,
            staging,
            files: Vec::new(),
            kept: Vec::new(),
            replaced: Vec::new(),
            outdated: Vec::new(),
            _lock: lock,
        })
    }

    /// Where the file will stand.
    pub(crate) fn target(&self, name: impl AsRef<Path>) -> PathBuf {
        self.directory.join(name)
    }

    /// Where all files announced so far will stand.
    pub(crate) fn targets(&self) -> Vec<PathBuf> {
        self.files.iter().map(|name| self.target(name)).collect()
    }

    /// Path at which to write the file `name` now; it is put in place by [`OutputDir::commit`].
    ///
    /// # Errors
    /// [`Error::Io`] when a folder of the name cannot be made.
    pub(crate) fn stage(&mut self, name: impl AsRef<Path>) -> Result<PathBuf> {
        let name = name.as_ref();
        let path = self.staged(name);
        if let Some(parent) = path.parent() {
            // not while a signal removes what stands there
            let _busy = uninterrupted();
            fs::create_dir_all(parent).map_err(|e| Error::io(parent, e))?;
        }
        if !self.files.iter().any(|f| f == name) {
            self.files.push(name.to_path_buf());
        }
        Ok(path)
    }

    /// Writes `bytes` as the file `name`.
    pub(crate) fn write(&mut self, name: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> Result<()> {
        let path = self.stage(name)?;
        fs::write(&path, bytes).map_err(|e| Error::io(path, e))
    }

    /// Writes a result of a kind as indented JSON.
    pub(crate) fn write_json(
        &mut self,
        name: impl AsRef<Path>,
        kind: &str,
        value: &impl serde::Serialize,
    ) -> Result<()> {
        self.write(name, json::write(kind, value)?)
    }

    /// Writes records as the files of these names, on all cores.
    pub(crate) fn write_records<'r>(
        &mut self,
        records: impl Iterator<Item = (PathBuf, &'r Record)>,
    ) -> Result<()> {
        let staged = records.map(|(name, record)| Ok((self.stage(name)?, record)));
        let staged = staged.collect::<Result<Vec<_>>>()?;
        let write = |(path, record): &(PathBuf, &Record)| {
            let file = fs::File::create(path).map_err(|e| Error::io(path, e))?;
            write_record(*record, &mut BufWriter::new(file)).map_err(|e| e.in_file(path))
        };
        threads::each(&staged, true, write).into_iter().collect()
    }

    /// The folder in which the files stand until they are put in place.
    pub(crate) fn staging(&self) -> &Path {
        self.staging.path()
    }

    /// Takes back a staged file.
    pub(crate) fn discard(&mut self, name: impl AsRef<Path>) {
        let name = name.as_ref();
        self.files.retain(|f| f != name);
        let _ = fs::remove_file(self.staged(name));
    }

    /// A file that an earlier run may have left there, of which this one has none: it goes when the others come.
    pub(crate) fn outdated(&mut self, name: impl AsRef<Path>) {
        self.outdated.push(name.as_ref().to_path_buf());
    }

    /// The same of figures and tables whose stem goes on with a number.
    pub(crate) fn outdated_numbered(&mut self, stem: &str) {
        let found = fs::read_dir(&self.directory).into_iter().flatten();
        for name in found.flatten().map(|e| e.file_name()) {
            let rest = name.to_str().and_then(|n| n.strip_prefix(stem));
            if let Some((number, "svg" | "png" | "csv")) = rest.and_then(|r| r.rsplit_once('.'))
                && number.parse::<f64>().is_ok()
            {
                self.outdated(&name);
            }
        }
    }

    /// Leaves a file that users edit as it is when it differs from the staged `name`, unless `force`; says whether it
    /// was left.
    pub(crate) fn keep_edited(&mut self, name: impl AsRef<Path>, force: bool) -> Result<bool> {
        let name = name.as_ref();
        let keep = !force && self.differs(name)?;
        if keep {
            self.discard(name);
            self.kept.push(name.to_path_buf());
        }
        Ok(keep)
    }

    /// Refuses to go on when a file that users edit differs from the staged `name`, unless `force`; `instead` is what
    /// else they could do.
    ///
    /// # Errors
    /// [`Error::Input`] naming the file; [`Error::Io`] when a file cannot be read.
    pub(crate) fn refuse_edited(&self, name: &str, force: bool, instead: &str) -> Result<()> {
        if force || !self.differs(Path::new(name))? {
            return Ok(());
        }
        let expected =
            format!("the file that this command writes ({instead}, or --force to replace it)");
        let found = "a file that differs, which was left as it is";
        Err(Error::input("", expected, found).in_file(self.target(name)))
    }

    /// Lets a file that differs be replaced.
    pub(crate) fn replace(&mut self, name: impl AsRef<Path>) {
        self.replaced.push(name.as_ref().to_path_buf());
    }

    fn differs(&self, name: &Path) -> Result<bool> {
        let target = self.target(name);
        if !target.exists() || self.replaced.iter().any(|r| r == name) {
            return Ok(false);
        }
        let read = |path: &Path| fs::read(path).map_err(|e| Error::io(path, e));
        Ok(read(&target)? != read(&self.staged(name))?)
    }

    fn staged(&self, name: &Path) -> PathBuf {
        self.staging.path().join(name)
    }

    /// Puts all files in place.
    pub(crate) fn commit(mut self) -> Result<Vec<Written>> {
        let _busy = uninterrupted();
        self.mark_complete()?;
        let names = std::mem::take(&mut self.files);
        let existed: Vec<bool> = names.iter().map(|n| self.target(n).exists()).collect();
        if let [_, .., last] = &names[..] {
            let target = self.target(last);
            if target.is_file() {
                fs::remove_file(&target).map_err(|e| Error::io(&target, e))?;
            }
        }
        for name in self.outdated.iter().filter(|name| !names.contains(name)) {
            // mostly it is not there
            let _ = fs::remove_file(self.target(name));
        }
        let mut written = Vec::with_capacity(names.len());
        for (name, replaced) in names.iter().zip(existed) {
            let path = self.target(name);
            put(&self.staged(name), &path)?;
            written.push(Written {
                path,
                replaced,
                kept: false,
            });
        }
        written.extend(self.kept.iter().map(|name| Written {
            path: self.target(name),
            replaced: false,
            kept: true,
        }));
        self.created = false;
        Ok(written)
    }

    /// Puts all files in place: they end the text, and are `files` of the object `value`.
    pub(crate) fn answer(self, text: String, mut value: serde_json::Value) -> Result<Answer> {
        let written = self.commit()?;
        value["files"] = serde_json::json!(written);
        Answer::new(text + &list(&written), &value)
    }

    fn mark_complete(&mut self) -> Result<()> {
        let from = self.staging.path().to_path_buf();
        let name = from.file_name().unwrap_or_default().to_string_lossy();
        let to = self.directory.join(name.replacen(PREFIX, COMPLETE, 1));
        fs::rename(&from, &to).map_err(|e| Error::io(&to, e))?;
        self.staging.renamed(to);
        Ok(())
    }
}

impl Drop for OutputDir {
    fn drop(&mut self) {
        if self.created {
            // fails when somebody else has put a file there meanwhile, which is then not ours to remove
            let _ = fs::remove_dir_all(self.staging.path());
            let _ = fs::remove_file(self.directory.join(LOCK_FILE));
            let _ = fs::remove_dir(&self.directory);
        }
    }
}

fn put(from: &Path, to: &Path) -> Result<()> {
    if let Some(parent) = to.parent() {
        fs::create_dir_all(parent).map_err(|e| Error::io(parent, e))?;
    }
    fs::rename(from, to).map_err(|e| Error::io(to, e))
}

/// Puts the files of complete folders in place and removes unfinished ones. The caller has the lock, so that they
/// belong to runs that were killed.
fn clear(directory: &Path) -> Result<()> {
    let failed = |e| Error::io(directory, e);
    for entry in fs::read_dir(directory).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if !name.starts_with(PREFIX) || name == LOCK_FILE {
            continue;
        }
        if name.starts_with(COMPLETE) {
            put_all(&path, directory)?;
        }
        let removed = match path.is_dir() {
            true => fs::remove_dir_all(&path),
            false => fs::remove_file(&path),
        };
        removed.map_err(|e| Error::io(&path, e))?;
    }
    Ok(())
}

fn put_all(from: &Path, to: &Path) -> Result<()> {
    let failed = |e| Error::io(from, e);
    for entry in fs::read_dir(from).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let target = to.join(path.file_name().unwrap_or_default());
        if path.is_dir() {
            put_all(&path, &target)?;
        } else {
            put(&path, &target)?;
        }
    }
    Ok(())
}

/// The files as lines of text; the folder of all of them once where lines would be longer than a terminal.
pub(crate) fn list(written: &[Written]) -> String {
    let line = |file: &Written, path: &Path| {
        let path = path.display();
        match (file.kept, file.replaced) {
            (true, _) => format!("  kept {path}: it differs (--force replaces it)\n"),
            (false, true) => format!("  replaced {path}\n"),
            (false, false) => format!("  wrote {path}\n"),
        }
    };
    let lines: Vec<String> = written.iter().map(|w| line(w, &w.path)).collect();
    if lines.iter().all(|l| l.chars().count() <= COLUMNS) {
        return lines.concat();
    }
    let folders = written.iter().filter_map(|w| w.path.parent());
    let Some(folder) = folders.min_by_key(|folder| folder.components().count()) else {
        return lines.concat();
    };
    let inside = |w: &Written| line(w, w.path.strip_prefix(folder).unwrap_or(&w.path));
    let inside: String = written.iter().map(inside).collect();
    format!("  in {}\n{inside}", folder.display())
}

#[cfg(test)]
mod tests;
