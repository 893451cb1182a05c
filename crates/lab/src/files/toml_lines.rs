//! TOML files of ours: read, checked, and every complaint with its line.

use crate::error::{Error, Place, PlaceStep, Result, has_control_characters};
use crate::files::text::{line_at, parsed, read_text};
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// The file at `path` by `parse`, which is given its text and its directory.
pub fn read<T>(path: &Path, parse: impl FnOnce(&str, PathBuf) -> Result<T>) -> Result<T> {
    let directory = path.parent().unwrap_or(Path::new("")).to_path_buf();
    parsed(path, |text| parse(text, directory))
}

/// The value in `text`, completed and checked by `check`; `what` it is in words: `a study file`.
///
/// # Errors
/// [`Error::Input`] with line and key for text that is no such value, and for what `check` refuses by key.
pub fn parse<T: DeserializeOwned>(
    what: &str,
    text: &str,
    check: impl FnOnce(&mut T) -> Result<()>,
) -> Result<T> {
    let mut value = read_value(what, text).map_err(|e| other_kind(what, text).unwrap_or(e))?;
    check(&mut value).map_err(|e| with_line(text, e))?;
    Ok(value)
}

/// Refuses a list where a block is meant, which would be read by the places of its items; files that have lists at their top level do
/// not ask.
///
/// # Errors
/// [`Error::Input`] with line and key.
pub fn only_blocks(text: &str) -> Result<()> {
    // what is no file in TOML is said by whoever reads it
    let Ok(root) = toml::from_str::<toml::Table>(text) else {
        return Ok(());
    };
    let is_list = |value: &toml::Value| {
        let list = value.as_array();
        list.is_some_and(|all| all.is_empty() || !all.iter().all(toml::Value::is_table))
    };
    let list = root.iter().find(|(_, value)| is_list(value));
    list.map_or(Ok(()), |(key, _)| {
        let expected = format!("a block [{key}]");
        Err(with_line(text, Error::input(key, expected, "a list")))
    })
}

/// Files with a command of their own: what they are, a key that no other of them has, and the command.
const KINDS: [(&str, &str, &str); 5] = [
    ("a study file", "deck", "study"),
    ("a bridge file", "modes", "bridge flutter"),
    ("a campaign file", "channels", "process"),
    ("a Monte Carlo file", "parameter", "monte-carlo"),
    ("a wind file", "speeds", "buffeting"),
];

/// That a file is not `what` was meant but of another kind, if it is.
fn other_kind(what: &str, text: &str) -> Option<Error> {
    let root: toml::Table = toml::from_str(text).ok()?;
    let (_, own, _) = KINDS.iter().find(|(kind, ..)| *kind == what)?;
    (!root.contains_key(*own)).then(|| not_but(what, &root))?
}

/// That the file at `path` is one of these kinds and not `what` was meant, which is none of them, if it is.
pub fn of_a_kind_of_ours(what: &str, path: &Path) -> Option<Error> {
    let root: toml::Table = toml::from_str(&read_text(path).ok()?).ok()?;
    not_but(what, &root).map(|e| e.in_file(path))
}

fn not_but(what: &str, root: &toml::Table) -> Option<Error> {
    let (found, _, command) = KINDS.iter().find(|(_, key, _)| root.contains_key(*key))?;
    let found = format!("{found}, which `aerodeck {command}` takes");
    Some(Error::input("", what, found))
}

fn read_value<T: DeserializeOwned>(what: &str, text: &str) -> Result<T> {
    let document = DeTable::parse(text)
        .map_err(|e| refused(what, text, e.span().unwrap_or_default().start, e.message()))?;
    let mut json = LinesOfJson::default();
    json.table(document.get_ref(), document.span().start)
        .map_err(|e| with_line(text, e))?;
    serde_json::from_str(&json.text).map_err(|e| {
        let said = e.to_string();
        let message = match said.rsplit_once(" at line ").map_or(&*said, |(m, _)| m) {
            "expected value" => "expected a word or a table",
            "trailing characters" => "more items than belong here",
            other => other,
        };
        let missing = message.starts_with("missing") || message.starts_with("invalid length");
        let offsets = json.offsets.get(e.line().wrapping_sub(2)).copied();
        let offset = offsets.unwrap_or_default()[usize::from(missing)];
        refused(what, text, offset, message)
    })
}

/// A value as JSON, in which each value begins a line: whatever is read from files of both kinds is compiled for one deserialiser, not
/// for the three of the TOML library besides.
#[derive(Default)]
struct LinesOfJson {
    text: String,
    /// What a line after the first was read from begins here in the file; of one that ends a block, the last item, of which it may be
    /// said there, and the block.
    offsets: Vec<[usize; 2]>,
    /// Of the value that is written.
    path: Vec<PlaceStep>,
}

impl LinesOfJson {
    fn table(&mut self, table: &DeTable<'_>, offset: usize) -> Result<()> {
        let step = |key: &str| PlaceStep::Key(key.to_owned());
        let items = table.iter();
        let items = items.map(|(key, value)| (step(key.get_ref()), key.span().start, value));
        self.block(['{', '}'], offset, items)
    }

    fn block<'a>(
        &mut self,
        brackets: [char; 2],
        offset: usize,
        items: impl Iterator<Item = (PlaceStep, usize, &'a Spanned<DeValue<'a>>)>,
    ) -> Result<()> {
        self.text.push(brackets[0]);
        let mut last = offset;
        for (i, (step, start, value)) in items.enumerate() {
            self.text.push_str(if i == 0 { "\n" } else { ",\n" });
            self.offsets.push([start; 2]);
            last = start;
            if let PlaceStep::Key(name) = &step {
                self.quoted(name);
                self.text.push(':');
            }
            self.path.push(step);
            self.value(value)?;
            self.path.pop();
        }
        self.offsets.push([last, offset]);
        self.text.extend(['\n', brackets[1]]);
        Ok(())
    }

    fn value(&mut self, value: &Spanned<DeValue<'_>>) -> Result<()> {
        let offset = value.span().start;
        let refused = |expected, found: &str| {
            let (line, parts) = (None, self.path.clone());
            Err(Error::input(Place { line, parts }, expected, found))
        };
        match value.get_ref() {
            // they end up in names of files, descriptions of FMUs and on terminals
            DeValue::String(text) if has_control_characters(text) => {
                return refused("a text without control characters", "one with them");
            }
            DeValue::String(text) => self.quoted(text),
            DeValue::Integer(number) => {
                match i128::from_str_radix(number.as_str(), number.radix()) {
                    Ok(value) => self.text.push_str(&value.to_string()),
                    Err(_) => return refused("an integer of 64 bits", &number.to_string()),
                }
            }
            DeValue::Float(number) => match number.as_str().parse::<f64>() {
                Ok(value) if !value.is_finite() => {
                    return refused("a finite number", &value.to_string());
                }
                _ => self.text.push_str(number.as_str().trim_start_matches('+')),
            },
            DeValue::Boolean(is_so) => self.text.push_str(&is_so.to_string()),
            DeValue::Datetime(time) => {
                return refused("a text in quotes, or no date", &time.to_string());
            }
            DeValue::Array(items) => {
                let items = items.iter().enumerate();
                let items = items.map(|(i, item)| (PlaceStep::Index(i), item.span().start, item));
                self.block(['[', ']'], offset, items)?;
            }
            DeValue::Table(table) => self.table(table, offset)?,
        }
        // what looks one character ahead stays on the line
        self.text.push(' ');
        Ok(())
    }

    fn quoted(&mut self, text: &str) {
        self.text
            .push_str(&serde_json::Value::from(text).to_string());
    }
}

/// What was expected at an offset of `text`, and what stands there.
fn refused(what: &str, text: &str, offset: usize, message: &str) -> Error {
    let line = line_at(text.as_bytes(), offset);
    let stood = text.lines().nth(line - 1).unwrap_or("").trim();
    let expected = format!("{what} ({})", message.replace('\n', " "));
    Error::input(Place::line(line), expected, format!("`{stood}`"))
}

/// The same error with the line of the key it names in front.
pub fn with_line(text: &str, error: Error) -> Error {
    let Error::Input(mut input) = error else {
        return error;
    };
    if let Some(line) = line_of_key(text, &input.place.parts) {
        input.place.line = Place::line(line).line;
    }
    Error::Input(input)
}

/// Line of the deepest of the keys that the file states.
fn line_of_key(text: &str, place: &[PlaceStep]) -> Option<usize> {
    let document = DeTable::parse(text).ok()?;
    let mut table = Some(document.get_ref());
    let mut list = None;
    let mut offset = None;
    for part in place {
        let value = match part {
            PlaceStep::Key(name) => {
                let found = table.and_then(|t| t.iter().find(|(k, _)| k.get_ref() == name));
                let Some((spanned_key, value)) = found else {
                    break;
                };
                offset = Some(spanned_key.span().start);
                value
            }
            PlaceStep::Index(index) => {
                let Some(item) = list.and_then(|l: &DeArray| l.get(*index)) else {
                    break;
                };
                offset = Some(item.span().start);
                item
            }
            _ => break,
        };
        (table, list) = (value.get_ref().as_table(), value.get_ref().as_array());
    }
    offset.map(|o| line_at(text.as_bytes(), o))
}

#[cfg(test)]
mod tests;
