//! What can go wrong, said so that a user can mend it: file, place, what was expected, what was found.

use std::fmt;
use std::path::{Path, PathBuf};

/// Result of every fallible function of the crate.
pub type Result<T> = std::result::Result<T, Error>;

/// A problem in something the user supplied.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputError {
    /// File in which the problem stands, if it came from a file.
    pub file: Option<PathBuf>,
    /// Line, key, column or run in that file, in words.
    pub place: String,
    /// What would have been accepted.
    pub expected: String,
    /// What stood there.
    pub found: String,
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = &self.file {
            write!(f, "{}: ", file.display())?;
        }
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        write!(f, "expected {}, found {}", self.expected, self.found)
    }
}

/// Errors of the library.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Wrong input: the caller can mend it.
    #[error("{0}")]
    Input(Box<InputError>),
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A computation did not reach a usable result.
    #[error("{0}")]
    Numerical(String),
}

impl Error {
    /// Wrong input at `place` (no file yet; see [`Error::in_file`]).
    pub fn input(
        place: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Self {
        Self::Input(Box::new(InputError {
            file: None,
            place: place.into(),
            expected: expected.into(),
            found: found.into(),
        }))
    }

    /// A failed file operation.
    pub fn io(path: impl AsRef<Path>, source: std::io::Error) -> Self {
        Self::Io {
            path: path.as_ref().to_path_buf(),
            source,
        }
    }

    /// The same error at another place.
    #[must_use]
    pub fn at(mut self, place: impl Into<String>) -> Self {
        if let Self::Input(input) = &mut self {
            input.place = place.into();
        }
        self
    }

    /// The same error, naming the file it came from (a file already named is kept).
    #[must_use]
    pub fn in_file(mut self, path: impl AsRef<Path>) -> Self {
        if let Self::Input(input) = &mut self
            && input.file.is_none()
        {
            input.file = Some(path.as_ref().to_path_buf());
        }
        self
    }
}

/// `value` if it is finite and positive.
///
/// # Errors
/// [`Error::Input`] naming `place` otherwise.
pub fn positive(place: &str, value: f64) -> Result<f64> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Error::input(place, "a positive number", value.to_string()))
    }
}

/// `value` if it is finite and not negative.
///
/// # Errors
/// [`Error::Input`] naming `place` otherwise.
pub fn non_negative(place: &str, value: f64) -> Result<f64> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(Error::input(
            place,
            "zero or a positive number",
            value.to_string(),
        ))
    }
}
