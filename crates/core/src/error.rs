//! What can go wrong, said so that a user can mend it: file, place, what was expected, what was found.

mod place;

pub use place::{Place, PlaceStep};

use place::quoted;
use std::fmt;
use std::path::{Path, PathBuf};

/// Result of every fallible function of the crate.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// fn onset_m_s() -> aerodeck::Result<f64> {
///     Err(aerodeck::Error::Numerical("no onset".into()))
/// }
/// assert!(onset_m_s().is_err());
/// ```
pub type Result<T> = std::result::Result<T, Error>;

/// A problem in something the user supplied.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputError {
    /// File in which the problem stands, if it came from a file.
    pub file: Option<PathBuf>,
    /// Line, key, column or run in that file.
    pub place: Place,
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
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::Error;
///
/// let error = Error::input("section.width_m", "a positive number", "-1");
/// assert_eq!(error.to_string(), "section.width_m: expected a positive number, found -1");
/// ```
#[derive(Debug)]
pub enum Error {
    /// Wrong input: the caller can mend it.
    Input(Box<InputError>),
    /// A file could not be read or written.
    Io {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A computation did not reach a usable result.
    Numerical(String),
    /// Modes that are asked for one by one cannot be told apart.
    NotDistinct(String),
    /// The section grows where only a stable one has an answer, or may be exported.
    Unstable(String),
    /// Several of these, in the order of what they are about; one line each.
    Several(Vec<Error>),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(error) => error.fmt(f),
            Self::Io { path, source } => write!(f, "{}: {source}", path.display()),
            Self::Numerical(text) | Self::NotDistinct(text) | Self::Unstable(text) => {
                f.write_str(text)
            }
            Self::Several(errors) => {
                write!(f, "{} errors", errors.len())?;
                errors.iter().try_for_each(|error| write!(f, "\n  {error}"))
            }
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}

impl Error {
    /// Wrong input at `place` (no file yet; see `Error::in_file`).
    pub fn input(
        place: impl Into<Place>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Self {
        Self::Input(Box::new(InputError {
            file: None,
            place: place.into().quoted(),
            expected: quoted(expected.into()),
            found: quoted(found.into()),
        }))
    }

    /// A failed file operation.
    pub fn io(path: impl AsRef<Path>, source: std::io::Error) -> Self {
        Self::Io {
            path: path.as_ref().to_path_buf(),
            source,
        }
    }

    /// JSON that could not be read as what was `expected`.
    pub fn json(expected: impl Into<String>, error: &serde_json::Error) -> Self {
        let place = Place::line(error.line()).column(error.column());
        Self::input(place, expected, error.to_string())
    }

    /// The same error at another place.
    #[must_use]
    pub fn at(mut self, place: impl Into<Place>) -> Self {
        if let Self::Input(input) = &mut self {
            input.place = place.into();
        }
        self
    }

    /// The same error with what it stands in before its place.
    #[must_use]
    pub fn within(mut self, outer: impl Into<Place>) -> Self {
        if let Self::Input(input) = &mut self {
            input.place = std::mem::take(&mut input.place).within(outer);
        }
        self
    }

    /// The same error, naming the file it came from (a file already named is kept).
    #[must_use]
    pub fn in_file(mut self, path: impl AsRef<Path>) -> Self {
        let path = path.as_ref();
        match &mut self {
            Self::Input(input) if input.file.is_none() => {
                input.file = Some(path.to_path_buf());
            }
            Self::Several(errors) => {
                let all = std::mem::take(errors);
                *errors = all.into_iter().map(|e| e.in_file(path)).collect();
            }
            _ => {}
        }
        self
    }
}

/// Whether a text has control characters, which a terminal obeys and XML cannot hold; broken lines and tabs are texts.
pub fn has_control_characters(text: &str) -> bool {
    text.contains(|c: char| c.is_control() && !['\n', '\r', '\t'].contains(&c))
}

/// Nothing if it `holds`; the words are put together only where it does not.
///
/// # Errors
/// [`Error::Input`] with what was `expected` and `found` at `place` otherwise.
#[inline]
pub fn ensure(
    holds: bool,
    place: impl Into<Place>,
    expected: impl fmt::Display,
    found: impl fmt::Display,
) -> Result<()> {
    match holds {
        true => Ok(()),
        false => Err(Error::input(place, expected.to_string(), found.to_string())),
    }
}

/// Refuses a text with control characters: names end up in files, pages, descriptions of FMUs and on terminals.
pub fn without_control_characters(place: impl Into<Place>, text: &str) -> Result<()> {
    let is_plain = !has_control_characters(text);
    let expected = "a text without control characters";
    ensure(is_plain, place, expected, "one with them")
}

/// `value` if it is finite and positive.
///
/// # Errors
/// [`Error::Input`] naming `place` otherwise.
pub fn positive(place: impl Into<Place>, value: f64) -> Result<f64> {
    let holds = value.is_finite() && value > 0.0;
    ensure(holds, place, "a positive number", value).map(|()| value)
}

/// `value` if it is finite.
///
/// # Errors
/// [`Error::Input`] naming `place` otherwise.
pub fn finite(place: impl Into<Place>, value: f64) -> Result<f64> {
    ensure(value.is_finite(), place, "a finite number", value).map(|()| value)
}

/// Nothing if the schema that a file states is the one that is read.
pub fn of_schema(expected: u32, found: u32) -> Result<()> {
    ensure(found == expected, "schema", expected, found)
}

/// Nothing if `values` are `count` finite numbers.
pub fn finite_numbers(place: impl Into<Place>, values: &[f64], count: usize) -> Result<()> {
    let holds = values.len() == count && values.iter().all(|x| x.is_finite());
    let expected = format_args!("{count} finite numbers");
    ensure(holds, place, expected, format_args!("{values:?}"))
}

/// Nothing if `value` is at most `bound`: one that no real study reaches.
pub fn at_most(place: impl Into<Place>, value: f64, bound: f64) -> Result<()> {
    let expected = format_args!("at most {bound}");
    ensure(value <= bound, place, expected, value)
}

/// `value` if it is finite and not negative.
pub fn non_negative(place: impl Into<Place>, value: f64) -> Result<f64> {
    let holds = value.is_finite() && value >= 0.0;
    ensure(holds, place, "zero or a positive number", value).map(|()| value)
}

/// So many of something in words: `1 mode`, `3 modes`.
pub fn counted(count: usize, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn one_thing_is_no_plural() {
        let in_words = [0, 1, 2].map(|n| counted(n, "mode"));
        assert_eq!(in_words, ["0 modes", "1 mode", "2 modes"]);
    }
}
