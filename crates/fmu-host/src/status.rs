//! What a function of FMI answers.

use super::library::Int;

/// Answer of a function of FMI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Ok,
    /// Done, with a remark in the log.
    Warning,
    /// Not done; the instance is as before.
    Discard,
    /// Not done; the instance is of no further use.
    Error,
    /// As error, for all instances.
    Fatal,
    /// Not finished yet.
    Pending,
    /// A number that is no status.
    Unknown(i32),
}

impl Status {
    pub(super) fn from_code(code: Int) -> Self {
        use Status::{Discard, Error, Fatal, Ok, Pending, Unknown, Warning};
        let known = [Ok, Warning, Discard, Error, Fatal, Pending];
        let index = usize::try_from(code).ok();
        let status = index.and_then(|index| known.get(index).copied());
        status.unwrap_or(Unknown(code))
    }

    /// Whether the call did what it should.
    pub(crate) fn is_good(self) -> bool {
        matches!(self, Self::Ok | Self::Warning)
    }
}
