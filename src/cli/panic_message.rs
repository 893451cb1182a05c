//! What is said when the program itself is at fault.

use std::io::Write as _;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind, set_hook};
use std::sync::Once;

/// Exit code for a fault of the program, as `sysexits.h` has it for internal errors.
pub(crate) const OWN_FAULT: u8 = 70;

/// Several threads may fail of one cause: one message is enough.
static REPORTED: Once = Once::new();

/// Replaces the message of the language by one that a user can do something with.
pub(crate) fn install() {
    set_hook(Box::new(|info| {
        REPORTED.call_once(|| write_panic_message(info))
    }));
}

fn write_panic_message(info: &PanicHookInfo<'_>) {
    let payload = info.payload();
    let text = payload.downcast_ref::<String>().map(String::as_str);
    let what = text.or_else(|| payload.downcast_ref::<&str>().copied());
    let what = what.unwrap_or("no message");
    let place = info.location();
    let place = place.map_or_else(|| "unknown place".to_owned(), ToString::to_string);
    // standard error may be closed, which is no reason to fail again
    let _ = writeln!(
        std::io::stderr(),
        "aerodeck stopped because of an internal error, not because of your input. We are sorry.\n\
         Please send the maintainers the next line, the command, and its input files if you may:\n  \
         aerodeck {} on {}, {place}: {what}",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
    );
}

/// The exit code of `body`; [`OWN_FAULT`] when it panicked, here or in a thread that it waited for.
pub(crate) fn guarded(body: impl FnOnce() -> u8) -> u8 {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|payload| {
        // dropping what was thrown could fail again
        std::mem::forget(payload);
        OWN_FAULT
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;
    use std::process::{Command, exit};

    const CHILD: &str = "AERODECK_TEST_FAULT";

    /// Run by the test below in a process of its own, since the hook is one of the whole process.
    #[test]
    fn faulty_command() {
        if std::env::var_os(CHILD).is_some() {
            install();
            let body = || {
                let sum: usize = (0..1000_usize)
                    .into_par_iter()
                    .map(|i| 1000 / (i % 7))
                    .sum();
                u8::try_from(sum % 2).unwrap()
            };
            exit(guarded(body).into());
        }
    }

    #[test]
    fn a_panic_in_any_thread_is_a_message_and_exit_code_70() {
        let output = Command::new(std::env::current_exe().unwrap())
            .args([
                "--exact",
                "cli::panic_message::tests::faulty_command",
                "--nocapture",
            ])
            .env(CHILD, "1")
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(OWN_FAULT.into()), "{said}");
        assert!(!said.contains("panicked at"), "{said}");
        assert_eq!(said.matches("We are sorry").count(), 1, "{said}");
        assert!(said.contains("panic_message.rs"), "{said}");
        assert!(said.contains("divide by zero"), "{said}");
    }
}
