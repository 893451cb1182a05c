//! Messages to the importer.
//!
//! The message is a `printf` format, and `#r3#` in it stands for a variable: both signs are doubled, and no arguments
//! are ever passed. Refusals are written even where logging is switched off: their reason must not be lost.

use super::types::{
    fmi2CallbackFunctions, fmi2CallbackLogger, fmi2ComponentEnvironment, fmi2Status,
};
use std::ffi::{CStr, CString};

/// Category of a message: place in [`crate::fmu::log_categories::LOG_CATEGORIES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Category {
    Events,
    Warning,
    Discard,
    Error,
    Fatal,
    All,
}

impl Category {
    const EVERY: [Category; 6] = [
        Self::Events,
        Self::Warning,
        Self::Discard,
        Self::Error,
        Self::Fatal,
        Self::All,
    ];

    fn name(self) -> &'static CStr {
        match self {
            Self::Events => c"logEvents",
            Self::Warning => c"logStatusWarning",
            Self::Discard => c"logStatusDiscard",
            Self::Error => c"logStatusError",
            Self::Fatal => c"logStatusFatal",
            Self::All => c"logAll",
        }
    }

    /// The category of this name.
    pub fn named(name: &CStr) -> Option<Self> {
        Self::EVERY.into_iter().find(|c| c.name() == name)
    }

    /// Refusals are always written.
    fn is_refusal(self) -> bool {
        matches!(self, Self::Discard | Self::Error | Self::Fatal)
    }
}

/// The importer's logger with our own copies of everything it is called with.
#[derive(Debug)]
pub(super) struct Logger {
    callback: fmi2CallbackLogger,
    environment: fmi2ComponentEnvironment,
    instance_name: CString,
    wanted: Vec<Category>,
}

impl Logger {
    /// `None` when the importer has no logger.
    pub fn new(
        functions: &fmi2CallbackFunctions,
        instance_name: &CStr,
        logging_on: bool,
    ) -> Option<Self> {
        let mut logger = Self {
            callback: functions.logger?,
            environment: functions.componentEnvironment,
            instance_name: instance_name.to_owned(),
            wanted: Vec::new(),
        };
        logger.select(logging_on, &[]);
        Some(logger)
    }

    /// Switches categories on; none named means all.
    pub fn select(&mut self, on: bool, categories: &[Category]) {
        self.wanted = match (on, categories) {
            (false, _) => Vec::new(),
            (true, []) => vec![Category::All],
            (true, some) => some.to_vec(),
        };
    }

    /// Writes a message.
    pub fn log(&self, status: fmi2Status, category: Category, message: &str) {
        let wanted = |c: &Category| *c == category || *c == Category::All;
        if !category.is_refusal() && !self.wanted.iter().any(wanted) {
            return;
        }
        let message = c_text(&message.replace('%', "%%").replace('#', "##"));
        // SAFETY: the importer guarantees callback and environment for the life of the instance; the texts are ours and
        // end with a zero byte. The format holds no conversion, so no argument is read.
        unsafe {
            (self.callback)(
                self.environment,
                self.instance_name.as_ptr(),
                status,
                category.name().as_ptr(),
                message.as_ptr(),
            );
        }
    }
}

/// A text for C; a zero byte inside becomes a space.
pub(super) fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}
