//! The `aerodeck` command.

use std::process::ExitCode;

/// Whether standard output was closed (`>&-`) when the program began. Rust opens `/dev/null` in its place before `main`, where
/// every answer would be lost without a word: so the system is asked before that.
#[cfg(target_os = "linux")]
mod standard_output {
    use std::sync::atomic::{AtomicBool, Ordering};

    static CLOSED: AtomicBool = AtomicBool::new(false);

    unsafe extern "C" {
        fn fcntl(descriptor: i32, command: i32, ...) -> i32;
    }

    extern "C" fn look() {
        let (standard_output, flags_of_descriptor) = (1, 1);
        // SAFETY: the flags of a descriptor are asked for and nothing is changed; there are none where it is closed
        let closed = unsafe { fcntl(standard_output, flags_of_descriptor) } < 0;
        CLOSED.store(closed, Ordering::Relaxed);
    }

    // SAFETY: the section lists functions that are called before `main`; this one needs nothing of Rust's runtime
    #[used]
    #[unsafe(link_section = ".init_array")]
    static BEFORE_MAIN: extern "C" fn() = look;

    pub(super) fn was_closed() -> bool {
        CLOSED.load(Ordering::Relaxed)
    }
}

fn main() -> ExitCode {
    #[cfg(target_os = "linux")]
    if standard_output::was_closed() {
        use std::io::Write as _;
        let said = "error: standard output is closed: expected it open, or sent to /dev/null where nobody wants it";
        let _ = writeln!(std::io::stderr(), "{said}");
        return ExitCode::FAILURE;
    }
    aerodeck::cli::main()
}
