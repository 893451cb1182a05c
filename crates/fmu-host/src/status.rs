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
        match code {
            0 => Self::Ok,
            1 => Self::Warning,
            2 => Self::Discard,
            3 => Self::Error,
            4 => Self::Fatal,
            5 => Self::Pending,
            other => Self::Unknown(other),
        }
    }

    /// Whether the call did what it should.
    pub(crate) fn is_good(self) -> bool {
        matches!(self, Self::Ok | Self::Warning)
    }
}
