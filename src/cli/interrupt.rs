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
    let path = std::env::temp_dir().join(format!("aerodeck-{}", std::process::id()));
    let _busy = uninterrupted();
    std::fs::create_dir(&path).ok()?;
    let folder = Temporary::new(path);
    tempfile::env::override_temp_dir(folder.path()).ok()?;
    Some(folder)
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
