//! The one boundary between C and Rust: every call on an instance goes through [`guarded`].
//!
//! A panic never crosses it. It poisons its instance, which from then on answers `fmi2Error` to everything; others live
//! on. Pointers of the importer are turned into references here and nowhere else.

use super::logger::{Category, Logger, c_text};
use super::types::{fmi2Component, fmi2Status};
use crate::groups::Groups;
use crate::instance::Instance;
use crate::lifecycle::Call;
use crate::refusal::{CallResult, Refusal, RefusalEffect};
use crate::variables::StartValue;
use std::any::Any;
use std::ffi::CString;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What a component handle points to.
#[derive(Debug)]
pub(crate) struct Component {
    pub instance: Instance,
    pub logger: Logger,
    /// Variables by the value references of FMI 3.0.
    pub groups: Groups,
    /// Texts of the variables, by value reference; those of other types are empty.
    pub texts: Vec<CString>,
    /// Number of strips that is being chosen, in the configuration mode of FMI 3.0.
    pub configuration: Option<usize>,
    poisoned: bool,
}

impl Component {
    pub(crate) fn new(instance: Instance, logger: Logger) -> Self {
        Self {
            texts: texts(&instance),
            groups: Groups::default(),
            instance,
            logger,
            configuration: None,
            poisoned: false,
        }
    }

    /// Goes on with another instance, of FMI 3.0.
    pub(crate) fn replace(&mut self, instance: Instance) {
        self.groups = Groups::new(instance.table());
        self.texts = texts(&instance);
        self.instance = instance;
    }

    /// Writes a refusal to the log and takes its consequence.
    #[cold]
    fn refuse(&mut self, function: &str, refusal: &Refusal) -> fmi2Status {
        self.instance.note(refusal);
        let category = match refusal.severity {
            RefusalEffect::Discard => Category::Discard,
            RefusalEffect::Call | RefusalEffect::Error => Category::Error,
        };
        self.logger.say(category, function, refusal);
        category.status()
    }

    #[cold]
    fn poison(&mut self, function: &str, panic: &(dyn Any + Send)) -> fmi2Status {
        self.poisoned = true;
        let why = panic_text(panic);
        let why = format_args!("internal error ({why}); this instance cannot be used any more");
        self.logger.say(Category::Fatal, function, why);
        fmi2Status::fmi2Error
    }

    #[cold]
    fn report_notices(&mut self) {
        for notice in self.instance.take_notices() {
            self.logger.log(Category::Warning, &notice);
        }
    }
}

/// See [`Component::texts`].
fn texts(instance: &Instance) -> Vec<CString> {
    let variables = instance.table().variables().iter();
    let texts = variables.map(|v| match &v.value {
        StartValue::String(text) => c_text(text),
        _ => CString::default(),
    });
    texts.collect()
}

/// What a panic says.
pub(crate) fn panic_text(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("without a message")
}

/// Carries out `body` on the instance behind `handle`, if `call` is legal there; `function` is what messages name, without the
/// prefix of the standard's version.
///
/// # Safety
/// `handle` is NULL or was returned by `fmi2Instantiate`, has not been freed, and is not in use by another thread.
#[inline]
pub(crate) unsafe fn guarded(
    handle: fmi2Component,
    call: Call,
    function: &str,
    body: impl FnOnce(&mut Component) -> CallResult<()>,
) -> fmi2Status {
    // SAFETY: by the contract of this function
    let Some(component) = (unsafe { handle.cast::<Component>().as_mut() }) else {
        return fmi2Status::fmi2Error;
    };
    if component.poisoned {
        return poisoned(component, function);
    }
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        component.instance.admit(call)?;
        body(component)
    }));
    match outcome {
        Ok(Ok(())) => {
            if !component.instance.now.notices.is_empty() {
                component.report_notices();
            }
            fmi2Status::fmi2OK
        }
        Ok(Err(refusal)) => component.refuse(function, &refusal),
        Err(panic) => component.poison(function, &*panic),
    }
}

/// Functions of the C interface that are one guarded call each: name, arguments behind the handle, the call, and what it does.
macro_rules! exported {
    ($($(#[$text:meta])* $name:ident($($argument:ident: $type:ty),*) $call:expr => $body:expr;)*) => {$(
        $(#[$text])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            c: $crate::fmi2::types::fmi2Component
            $(, $argument: $type)*
        ) -> $crate::fmi2::types::fmi2Status {
            // SAFETY: handles, pointers and arrays are valid by the contract of the interface
            unsafe {
                $crate::fmi2::guard::guarded(c, $call, &stringify!($name)["fmi2".len()..], $body)
            }
        }
    )*};
}
pub(crate) use exported;

#[cold]
fn poisoned(component: &Component, function: &str) -> fmi2Status {
    let why = "an earlier internal error has made this instance unusable; free it";
    component.logger.say(Category::Fatal, function, why);
    fmi2Status::fmi2Error
}

/// Answers a function that is not offered: an error with a reason, the run is not touched.
///
/// # Safety
/// As [`guarded`].
pub(crate) unsafe fn not_offered(handle: fmi2Component, function: &str, why: &str) -> fmi2Status {
    // SAFETY: by the contract of this function
    if let Some(component) = unsafe { handle.cast::<Component>().as_ref() } {
        component.logger.say(Category::Error, function, why);
    }
    fmi2Status::fmi2Error
}

/// The process is an importer's. Panics that are caught here are silent: they are reported through its logger, and collecting a backtrace
/// would cost tens of megabytes. (Tests share their process with what panics on its own account.) The hook owns nothing and no thread is
/// started, so that nothing is left when the library is unloaded.
pub(crate) fn behave_as_a_guest() {
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        if cfg!(not(test)) {
            std::panic::set_hook(Box::new(|_| ()));
        }
        aerodeck_core::threads::stay_on_the_callers();
    });
}

/// An array of the importer; no elements may come with NULL.
///
/// # Safety
/// `pointer` is NULL or points to `count` values that nobody changes while the result is in use.
pub(crate) unsafe fn array<'a, T>(
    pointer: *const T,
    count: usize,
    name: &str,
) -> CallResult<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check_array(pointer, count, name)?;
    // SAFETY: not NULL, not longer than an object can be, and otherwise by the contract of this function
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// An array of the importer to be filled.
///
/// # Safety
/// `pointer` is NULL or points to room for `count` values that nobody else uses while the result is in use.
pub(crate) unsafe fn array_mut<'a, T>(
    pointer: *mut T,
    count: usize,
    name: &str,
) -> CallResult<&'a mut [T]> {
    if count == 0 {
        return Ok(&mut []);
    }
    check_array(pointer, count, name)?;
    // SAFETY: not NULL, not longer than an object can be, and otherwise by the contract of this function
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

fn check_array<T>(pointer: *const T, count: usize, name: &str) -> CallResult<()> {
    if pointer.is_null() || count > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(no_array(pointer.is_null(), count, name));
    }
    Ok(())
}

#[cold]
fn no_array(is_null: bool, count: usize, name: &str) -> Refusal {
    Refusal::error(match is_null {
        true => format!("{name}: expected {count} elements, found NULL"),
        false => format!("{name}: {count} elements do not fit into memory"),
    })
}

/// One variable of the importer to be written.
///
/// # Safety
/// `pointer` is NULL or points to a value that nobody else uses while the result is in use.
pub(crate) unsafe fn target<'a, T>(pointer: *mut T, name: &str) -> CallResult<&'a mut T> {
    // SAFETY: by the contract of this function
    unsafe { pointer.as_mut() }
        .ok_or_else(|| Refusal::error(format!("{name}: expected a pointer, found NULL")))
}
