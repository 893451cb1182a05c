//! Long work: the interpreter is released, progress is told, and Ctrl-C or what the callable raises ends it.

use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, OnceLock};
use std::time::Duration;

/// How often signals are looked at.
const LOOK: Duration = Duration::from_millis(20);

/// What unwinds through the library when the work is to end; no message, since nothing went wrong.
struct Ended;

/// Work that takes a while, and the callable that is told how far it has come.
pub struct Work {
    progress: Option<Py<PyAny>>,
    ended: AtomicBool,
    raised: Mutex<Option<PyErr>>,
}

impl Work {
    /// `progress` is called with what is done and all there is to do, from any thread.
    pub fn new(progress: Option<Py<PyAny>>) -> Self {
        Self {
            progress,
            ended: AtomicBool::new(false),
            raised: Mutex::new(None),
        }
    }

    /// Does it on a thread of its own while this one looks for signals, which only the main thread of Python sees.
    ///
    /// # Errors
    /// `KeyboardInterrupt`, what another handler of signals raised, what the callable raised: the work has then ended at its next
    /// [`Work::tell`] or [`Work::check`], or come to its end.
    pub fn run<T: Send>(&self, py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
        let finished = py.detach(|| {
            let (alive, watched) = channel::<()>();
            std::thread::scope(|threads| {
                let worker = threads.spawn(move || {
                    let _alive = alive;
                    in_this_process(work)
                });
                while watched.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                    if let Err(signal) = Python::attach(|py| py.check_signals()) {
                        self.end(signal);
                    }
                }
                worker.join()
            })
        });
        if let Some(raised) = self.lock().take() {
            return Err(raised);
        }
        Ok(finished.unwrap_or_else(|panic| resume_unwind(panic)))
    }

    /// Tells how far it has come.
    pub fn tell(&self, done: usize, total: usize) {
        self.check();
        let Some(progress) = &self.progress else {
            return;
        };
        let told = Python::attach(|py| progress.call1(py, (done, total)));
        if let Err(raised) = told {
            self.end(raised);
            self.check();
        }
    }

    /// Leaves the library when the work is to end.
    pub fn check(&self) {
        if self.ended.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Ended));
        }
    }

    /// The first that is raised stays.
    fn end(&self, raised: PyErr) {
        self.lock().get_or_insert(raised);
        self.ended.store(true, Ordering::Relaxed);
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Option<PyErr>> {
        self.raised.lock().unwrap_or_else(|e| e.into_inner())
    }
}

/// Does it without the interpreter, as [`Python::detach`], on threads of this process.
pub fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| in_this_process(work))
}

/// Does it on threads that this process has: those of another, of which it was forked as `multiprocessing` does, are not here.
fn in_this_process<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    static OWNER: OnceLock<u32> = OnceLock::new();
    let own = std::process::id();
    if *OWNER.get_or_init(|| own) == own {
        return work();
    }
    match rayon::ThreadPoolBuilder::new().build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}

/// Does it on so many threads, on no more than there are cores; left out, on one for each.
///
/// # Errors
/// [`aerodeck::Error::Numerical`] when the system gives no thread.
pub fn on_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> aerodeck::Result<T> {
    let Some(threads) = threads else {
        return Ok(work());
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.min(cores);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| aerodeck::Error::Numerical(e.to_string()))?;
    Ok(pool.install(work))
}
