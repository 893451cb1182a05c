//! Silence about panics inside `shielded`: tests share their process with what panics on its own account.

use std::cell::Cell;
use std::panic::PanicHookInfo;
use std::sync::OnceLock;

thread_local! {
    static SHIELDED: Cell<bool> = const { Cell::new(false) };
}

type PanicHook = Box<dyn Fn(&PanicHookInfo<'_>) + Send + Sync>;

/// The panic hook that was there before ours.
static PREVIOUS_HOOK: OnceLock<PanicHook> = OnceLock::new();

pub(in crate::fmi2) fn install() {
    let _ = PREVIOUS_HOOK.set(std::panic::take_hook());
    std::panic::set_hook(Box::new(|info| {
        if let (false, Some(previous)) = (SHIELDED.get(), PREVIOUS_HOOK.get()) {
            previous(info);
        }
    }));
}

pub(in crate::fmi2) fn enter() -> bool {
    SHIELDED.replace(true)
}

pub(in crate::fmi2) fn leave(outer: bool) {
    SHIELDED.set(outer);
}
