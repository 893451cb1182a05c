//! Signals that end the program: what it has made so far is removed first.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Folders and files that must not outlive the program.
static TEMPORARY: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
/// Held while results are put in place, which is not interrupted, and by the end of the program.
static BUSY: Mutex<()> = Mutex::new(());

/// Attempts to remove a folder into which another thread may be writing.
#[cfg(unix)]
const ATTEMPTS: usize = 50;

/// Not interrupted as long as the guard lives.
pub(crate) fn uninterrupted() -> MutexGuard<'static, ()> {
    BUSY.lock().unwrap_or_else(PoisonError::into_inner)
}

fn temporary() -> MutexGuard<'static, Vec<PathBuf>> {
    TEMPORARY.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A folder or file that is removed when this is dropped or the program is interrupted.
pub(crate) struct Temporary(PathBuf);

impl Temporary {
    /// Takes charge of `path`.
    pub(crate) fn new(path: PathBuf) -> Self {
        temporary().push(path.clone());
        Self(path)
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    /// The same under another name.
    pub(crate) fn renamed(&mut self, path: PathBuf) {
        let mut all = temporary();
        all.retain(|p| *p != self.0);
        all.push(path.clone());
        self.0 = path;
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        remove(&self.0);
        temporary().retain(|p| *p != self.0);
    }
}

/// A folder for the temporary files of this process alone, which goes with it however it ends; none where it cannot be made.
pub(crate) fn own_temporary_folder() -> Option<Temporary> {
    let all = std::env::temp_dir();
    clear_left_behind(&all);
    let _busy = uninterrupted();
    // the number of a process comes again, what follows it does not
    let folder = tempfile::Builder::new()
        .prefix(&format!("{OWN}{}-", std::process::id()))
        .tempdir_in(all)
        .ok()?;
    let folder = Temporary::new(folder.keep());
    tempfile::env::override_temp_dir(folder.path()).ok()?;
    Some(folder)
}

/// Start of the name of such a folder; the number of its process follows.
const OWN: &str = "aerodeck-";
/// What a killed process left is old: one in another container has the same folder, but not the same numbers.
const LEFT_BEHIND: std::time::Duration = std::time::Duration::from_secs(24 * 3600);

/// Removes the folders of processes that were killed, which are gone and wrote nothing for a day.
fn clear_left_behind(all: &Path) {
    let processes = Path::new("/proc");
    if !processes.join("self").exists() {
        return;
    }
    for entry in std::fs::read_dir(all).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let number = name.strip_prefix(OWN).and_then(|n| n.split('-').next());
        let Some(number) = number.filter(|n| n.parse::<u32>().is_ok()) else {
            continue;
        };
        let written = entry.metadata().and_then(|m| m.modified()).ok();
        let age = written.and_then(|t| t.elapsed().ok());
        let is_old = age.is_some_and(|age| age > LEFT_BEHIND);
        if is_old && !processes.join(number).exists() {
            remove(&entry.path());
        }
    }
}

/// Whether nothing stands there any more.
fn remove(path: &Path) -> bool {
    if path.is_dir() {
        let _ = std::fs::remove_dir_all(path);
    } else {
        let _ = std::fs::remove_file(path);
    }
    !path.exists()
}

/// Cleans up and ends the program with 128 + the number of the signal on SIGINT (Ctrl-C) and SIGTERM.
///
/// SIGHUP keeps its effect, so that `nohup` works; what it and SIGKILL leave behind the next run removes.
#[cfg(unix)]
pub(crate) fn install() {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else {
        return;
    };
    std::thread::spawn(move || {
        if let Some(signal) = signals.forever().next() {
            let _busy = uninterrupted();
            let paths = temporary();
            for path in paths.iter() {
                for _ in 0..ATTEMPTS {
                    if remove(path) {
                        break;
                    }
                    std::thread::sleep(std::time::Duration::from_millis(2));
                }
            }
            std::process::exit(128 + signal);
        }
    });
}

/// Nothing is caught here; the next run removes what is left behind.
#[cfg(not(unix))]
pub(crate) fn install() {}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests {
    use super::*;

    #[test]
    fn folders_of_killed_processes_are_removed_after_a_day() {
        let all = tempfile::tempdir().unwrap();
        let make = |name: &str, days: u64| {
            let path = all.path().join(name);
            std::fs::create_dir(&path).unwrap();
            let then = std::time::SystemTime::now() - LEFT_BEHIND * days as u32;
            let folder = std::fs::File::open(&path).unwrap();
            folder.set_modified(then).unwrap();
            path
        };
        // no process has a number above 2^22
        let dead = make("aerodeck-99999999-abc", 2);
        let kept = [
            make("aerodeck-99999998-abc", 0),
            make(&format!("aerodeck-{}-abc", std::process::id()), 2),
            make("aerodeck-fmu-abc", 2),
            make("aerodeck-out", 2),
        ];
        clear_left_behind(all.path());
        assert!(!dead.exists());
        assert!(kept.iter().all(|p| p.exists()));
    }
}
