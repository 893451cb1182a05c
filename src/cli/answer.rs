//! What a command has to say, for people and for machines.

use super::wrapping::wrapped;
use crate::error::{Error, Result};
use crate::json;
use crate::verdict::Verdict;
use serde::Serialize;

/// Exit code when a computation failed or a check did not pass.
pub(super) const FAILED: u8 = 1;
/// Exit code when a speed is required and it is not known to be met.
pub(super) const NOT_MET: u8 = 3;

/// Text without the control characters of an input, which a terminal would obey.
pub(super) fn plain(text: &str) -> String {
    let shown = |c: char| match c.is_control() && !['\n', '\t'].contains(&c) {
        true => char::REPLACEMENT_CHARACTER,
        false => c,
    };
    text.chars().map(shown).collect()
}

/// Result of a command.
#[derive(Debug)]
pub struct Answer {
    text: String,
    json: serde_json::Value,
    /// Exit code of the process.
    exit: u8,
    verbatim: bool,
}

impl Answer {
    /// `text` for people, `value` for machines.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the value cannot be written as JSON.
    pub(crate) fn new(text: String, value: &impl Serialize) -> Result<Self> {
        let json = serde_json::to_value(value).map_err(|e| Error::Numerical(e.to_string()))?;
        Ok(Self {
            text,
            json,
            exit: 0,
            verbatim: false,
        })
    }

    /// The same answer, which says to machines what it is.
    #[must_use]
    pub(super) fn of_kind(mut self, kind: &str) -> Self {
        if let serde_json::Value::Object(keys) = &mut self.json {
            keys.insert(json::KEY.to_owned(), json::format(kind).into());
        }
        self
    }

    /// The same answer of a check that did or did not pass.
    #[must_use]
    pub(crate) fn passed_if(mut self, passed: bool) -> Self {
        if !passed && self.exit == 0 {
            self.exit = FAILED;
        }
        self
    }

    /// The same answer to a question that states a required speed, if it does; that this is not known to be met comes before a check
    /// that did not pass.
    #[must_use]
    pub(crate) fn with_outcome_of<'a>(mut self, verdict: impl Into<Option<&'a Verdict>>) -> Self {
        if verdict.into().is_some_and(Verdict::refuses) {
            self.exit = NOT_MET;
        }
        self
    }

    /// The same answer with lines that are not to be cut: another program reads them.
    #[must_use]
    pub(crate) fn verbatim(mut self) -> Self {
        self.verbatim = true;
        self
    }

    /// Readable account, ending in a new line, for a terminal of 80 columns.
    pub(crate) fn shown(&self) -> String {
        match self.verbatim {
            true => self.text.clone(),
            false => wrapped(&plain(&self.text)),
        }
    }

    /// The same for machines.
    pub(crate) fn value(&self) -> serde_json::Value {
        self.json.clone()
    }

    /// The same as indented JSON.
    pub(crate) fn json(&self) -> String {
        format!("{:#}", self.json)
    }

    /// That of the process.
    pub(super) fn exit_code(&self) -> u8 {
        self.exit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_obeys_no_name() {
        let answer = Answer::new("a\u{1b}]0;title\u{7}b\tc\n".to_owned(), &()).unwrap();
        assert_eq!(answer.shown(), "a\u{fffd}]0;title\u{fffd}b\tc\n");
    }
}
