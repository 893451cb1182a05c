//! Why a call was not carried out, and what that means for the run.

use crate::error::Error;
use std::fmt;

/// What a refusal does to the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RefusalEffect {
    /// Nothing has changed; other values, or a saved state, lead on.
    Discard,
    /// The call was wrong but touches nothing: the run goes on.
    Call,
    /// The run cannot go on; a reset or a saved state leads out.
    Error,
}

/// A call that was not carried out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// What it does to the run.
    pub severity: RefusalEffect,
    /// What was wrong, for the log.
    pub message: String,
}

/// Result of what an importer asks.
pub(crate) type CallResult<T> = Result<T, Refusal>;

impl Refusal {
    /// The run cannot go on.
    #[cold]
    pub fn error(message: impl Into<String>) -> Self {
        Self::new(RefusalEffect::Error, message)
    }

    /// The call was wrong but touches nothing.
    #[cold]
    pub fn call(message: impl Into<String>) -> Self {
        Self::new(RefusalEffect::Call, message)
    }

    /// Nothing has changed.
    #[cold]
    pub(crate) fn discard(message: impl Into<String>) -> Self {
        Self::new(RefusalEffect::Discard, message)
    }

    fn new(severity: RefusalEffect, message: impl Into<String>) -> Self {
        let message = message.into();
        Self { severity, message }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// What cannot be computed with the values as they are changes nothing.
impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Self::discard(error.to_string())
    }
}
