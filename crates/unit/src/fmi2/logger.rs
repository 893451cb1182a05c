//! Messages to the importer.
//!
//! In FMI 2.0 the message is a `printf` format, and `#r3#` in it stands for a variable: both signs are doubled, and no arguments
//! are ever passed. Refusals are written even where logging is switched off: their reason must not be lost.

use super::types::{fmi2CallbackFunctions, fmi2CallbackLogger, fmi2Status};
use crate::log_categories::LOG_CATEGORIES;
use std::ffi::{CStr, CString, c_char, c_void};
use std::fmt::Display;

/// Category of a message: index in [`LOG_CATEGORIES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Category {
    Events,
    Warning,
    Discard,
    Error,
    Fatal,
}

/// Name of the category of all messages.
const ALL: &CStr = c"logAll";

impl Category {
    fn name(self) -> &'static CStr {
        LOG_CATEGORIES[self as usize].0
    }

    /// With which messages of this category are written.
    pub(crate) fn status(self) -> fmi2Status {
        match self {
            Self::Events => fmi2Status::fmi2OK,
            Self::Warning => fmi2Status::fmi2Warning,
            Self::Discard => fmi2Status::fmi2Discard,
            Self::Error | Self::Fatal => fmi2Status::fmi2Error,
        }
    }

    /// Refusals are always written.
    fn is_refusal(self) -> bool {
        matches!(self, Self::Discard | Self::Error | Self::Fatal)
    }
}

/// Writes a message in FMI 3.0: environment, status, category, message.
pub type PlainLogger = unsafe extern "C" fn(*mut c_void, fmi2Status, *const c_char, *const c_char);

/// The importer's function.
#[derive(Debug, Clone, Copy)]
enum Callback {
    Printf(fmi2CallbackLogger),
    Plain(PlainLogger),
}

/// The importer's logger with our own copies of everything it is called with.
#[derive(Debug)]
pub(crate) struct Logger {
    callback: Callback,
    environment: *mut c_void,
    instance_name: CString,
    /// Names of categories.
    wanted: Vec<&'static CStr>,
}

impl Logger {
    /// `None` when the importer has no logger.
    pub(crate) fn new(
        functions: &fmi2CallbackFunctions,
        instance_name: &CStr,
        logging_on: bool,
    ) -> Option<Self> {
        let callback = Callback::Printf(functions.logger?);
        let name = instance_name.to_owned();
        let environment = functions.componentEnvironment;
        Some(Self::with(callback, environment, name, logging_on))
    }

    /// The logger of an importer of FMI 3.0.
    pub(crate) fn plain(callback: PlainLogger, environment: *mut c_void, logging_on: bool) -> Self {
        let name = CString::default();
        Self::with(Callback::Plain(callback), environment, name, logging_on)
    }

    fn with(
        callback: Callback,
        environment: *mut c_void,
        instance_name: CString,
        logging_on: bool,
    ) -> Self {
        Self {
            callback,
            environment,
            instance_name,
            wanted: if logging_on { vec![ALL] } else { Vec::new() },
        }
    }

    /// A function of the interface, of which `name` is that of FMI 2.0 without prefix where there is one.
    pub(crate) fn function(&self, name: &str) -> String {
        match (self.callback, name) {
            (Callback::Printf(_), _) => format!("fmi2{name}"),
            (Callback::Plain(_), "GetDerivatives") => "fmi3GetContinuousStateDerivatives".into(),
            (Callback::Plain(_), _) => {
                let name = name.replace("FMUstate", "FMUState");
                format!("fmi3{}", name.replace("DeSerialize", "Deserialize"))
            }
        }
    }

    /// Switches categories of these names on; none named means all.
    pub(crate) fn select(&mut self, on: bool, names: Vec<&'static CStr>) {
        self.wanted = match (on, names.is_empty()) {
            (false, _) => Vec::new(),
            (true, true) => vec![ALL],
            (true, false) => names,
        };
    }

    /// Writes what a function of the interface has to say.
    pub(crate) fn say(&self, category: Category, function: &str, what: impl Display) {
        let message = format!("{}: {what}", self.function(function));
        self.log(category, &message);
    }

    /// Writes a message.
    pub(crate) fn log(&self, category: Category, message: &str) {
        let status = category.status();
        let wanted = |name: &&CStr| [category.name(), ALL].contains(name);
        if !category.is_refusal() && !self.wanted.iter().any(wanted) {
            return;
        }
        let category = category.name().as_ptr();
        // SAFETY: the importer guarantees callback and environment for the life of the instance; the texts are ours and
        // end with a zero byte. The format holds no conversion, so no argument is read.
        unsafe {
            match self.callback {
                Callback::Printf(logger) => {
                    let message = c_text(&message.replace('%', "%%").replace('#', "##"));
                    let name = self.instance_name.as_ptr();
                    logger(self.environment, name, status, category, message.as_ptr());
                }
                Callback::Plain(logger) => {
                    let message = c_text(message);
                    logger(self.environment, status, category, message.as_ptr());
                }
            }
        }
    }
}

/// A text for C; a zero byte inside becomes a space.
pub(crate) fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}
