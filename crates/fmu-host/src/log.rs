//! Messages of a running FMU, collected.

use super::library::{Int, Text};
use aerodeck_unit::fmi2::types::fmi2CallbackLogger;
use std::ffi::{CStr, c_void};
use std::sync::{Mutex, MutexGuard};

/// Messages kept; a chatty FMU must not fill the memory.
const KEPT: usize = 1000;

/// The messages of one instance, each behind its category. FMUs may log from any thread. Where the FMU passed arguments for its format
/// string, the format itself stands here.
pub(super) type LogBook = Mutex<Vec<String>>;

/// The messages of a book.
pub(super) fn messages_of(book: &LogBook) -> MutexGuard<'_, Vec<String>> {
    book.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// The logger as the FMU calls it.
///
/// A function that takes variable arguments cannot be written in stable Rust. One with the five named parameters alone
/// can stand in for it: under the calling conventions of x86_64 and aarch64 (System V, AAPCS64, Apple, Windows) named
/// arguments come in the same registers either way, and the caller clears away the rest.
pub(super) fn logger() -> fmi2CallbackLogger {
    // SAFETY: see above; the arguments that are not named are never read
    unsafe { std::mem::transmute::<*const (), fmi2CallbackLogger>(collect as *const ()) }
}

unsafe extern "C" fn collect(
    environment: *mut c_void,
    _instance: Text,
    status: Int,
    category: Text,
    message: Text,
) {
    // SAFETY: as promised by the caller
    unsafe { collect_plain(environment, status, category, message) }
}

/// The logger of FMI 3.0.
pub(super) unsafe extern "C" fn collect_plain(
    environment: *mut c_void,
    _status: Int,
    category: Text,
    message: Text,
) {
    // SAFETY: the environment is the book that was passed at instantiation and outlives the instance
    let Some(book) = (unsafe { environment.cast::<LogBook>().as_ref() }) else {
        return;
    };
    let mut messages = messages_of(book);
    if messages.len() < KEPT {
        // SAFETY: C strings or null, as the standard has it, that live through the call
        let (category, message) = unsafe { (text(category), text(message)) };
        // doubled are the signs of the format and of references
        let message = message.replace("%%", "%").replace("##", "#");
        messages.push(format!("[{category}] {message}"));
    }
}

/// A C string as text; null gives nothing.
///
/// # Safety
/// `pointer` is null or a C string.
pub(super) unsafe fn text(pointer: Text) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: promised by the caller
    unsafe { CStr::from_ptr(pointer) }
        .to_string_lossy()
        .into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use aerodeck_unit::fmi2::types::fmi2Status;

    #[test]
    fn messages_arrive_through_the_variadic_pointer() {
        let book = LogBook::default();
        let environment = std::ptr::from_ref(&book).cast_mut().cast();
        // SAFETY: arguments as the signature asks, with two that are not named
        unsafe {
            logger()(
                environment,
                c"a".as_ptr(),
                fmi2Status::fmi2Error,
                c"logStatusError".as_ptr(),
                c"100 %% of %s, ##".as_ptr(),
                c"x".as_ptr(),
                1.5_f64,
            );
            logger()(
                environment,
                std::ptr::null(),
                fmi2Status::fmi2OK,
                std::ptr::null(),
                std::ptr::null(),
            );
        }
        let messages = std::mem::take(&mut *messages_of(&book));
        assert_eq!(messages, ["[logStatusError] 100 % of %s, #", "[] "]);
        assert!(messages_of(&book).is_empty());
    }
}
