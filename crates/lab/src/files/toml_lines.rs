//! TOML files of ours: read, checked, and every complaint with its line.

use crate::error::{Error, Place, PlaceStep, Result, has_control_characters};
use crate::files::text::read_text;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

fn line_of(text: &str, offset: usize) -> usize {
    1 + text.as_bytes()[..offset.min(text.len())]
        .iter()
        .filter(|b| **b == b'\n')
        .count()
}

/// The file at `path` by `parse`, which is given its text and its directory.
pub fn read<T>(path: &Path, parse: impl FnOnce(&str, PathBuf) -> Result<T>) -> Result<T> {
    let text = read_text(path)?;
    let directory = path.parent().unwrap_or(Path::new("")).to_path_buf();
    parse(&text, directory).map_err(|e| e.in_file(path))
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
    match root.iter().find(|(_, value)| is_list(value)) {
        None => Ok(()),
        Some((key, _)) => {
            let expected = format!("a block [{key}]");
            Err(with_line(text, Error::input(key, expected, "a list")))
        }
    }
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
        let message = said.rsplit_once(" at line ").map_or(&*said, |(m, _)| m);
        let offset = json.offsets.get(e.line().wrapping_sub(2)).copied();
        refused(what, text, offset.unwrap_or_default(), message)
    })
}

/// A value as JSON, in which each value begins a line: whatever is read from files of both kinds is compiled for one deserialiser, not
/// for the three of the TOML library besides.
#[derive(Default)]
struct LinesOfJson {
    text: String,
    /// What a line after the first was read from begins here in the file.
    offsets: Vec<usize>,
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
        for (i, (step, start, value)) in items.enumerate() {
            self.text.push_str(if i == 0 { "\n" } else { ",\n" });
            self.offsets.push(start);
            if let PlaceStep::Key(name) = &step {
                self.quoted(name);
                self.text.push(':');
            }
            self.path.push(step);
            self.value(value)?;
            self.path.pop();
        }
        // what is missing is missing where the block begins
        self.offsets.push(offset);
        self.text.extend(['\n', brackets[1]]);
        Ok(())
    }

    fn value(&mut self, value: &Spanned<DeValue<'_>>) -> Result<()> {
        let offset = value.span().start;
        let refused = |expected, found: &str| {
            let place = Place {
                line: None,
                parts: self.path.clone(),
            };
            Err(Error::input(place, expected, found))
        };
        match value.get_ref() {
            // they end up in names of files, descriptions of FMUs and on terminals
            DeValue::String(text) if has_control_characters(text) => {
                return refused("a text without control characters", "one with them");
            }
            DeValue::String(text) => self.quoted(text),
            DeValue::Integer(number) => {
                let Ok(value) = i64::from_str_radix(number.as_str(), number.radix()) else {
                    return refused("an integer of 64 bits", number.as_str());
                };
                self.text.push_str(&value.to_string());
            }
            DeValue::Float(number) => match number.as_str().parse::<f64>() {
                Ok(value) if !value.is_finite() => {
                    return refused("a finite number", &value.to_string());
                }
                _ => self.text.push_str(number.as_str().trim_start_matches('+')),
            },
            DeValue::Boolean(is_so) => self.text.push_str(&is_so.to_string()),
            DeValue::Datetime(time) => self.quoted(&time.to_string()),
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
    let line = line_of(text, offset);
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
    offset.map(|o| line_of(text, o))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_another_kind_is_named_with_its_command() {
        let read = |what: &str, text: &str| {
            let read = parse::<std::collections::BTreeMap<String, i32>>(what, text, |_| Ok(()));
            read.unwrap_err().to_string()
        };
        let text = "schema = 1\n[modes]\n";
        assert_eq!(
            read("a study file", text),
            "expected a study file, found a bridge file, which `aerodeck bridge flutter` takes"
        );
        // a mistake in what it is, and what has no command of its own
        for (what, text) in [
            ("a study file", "deck = {}\n[modes]\n"),
            ("a case file", text),
        ] {
            assert!(read(what, text).contains("line"), "{what}");
        }
    }

    #[test]
    fn names_with_control_characters_are_refused_with_line_and_key() {
        let read = |text: &str| parse::<toml::Table>("a file", text, |_| Ok(())).map(drop);
        assert!(read("name = \"a\\tb\"\n[x]\ntext = \"a\\nb\"").is_ok());
        for escape in ["\\u001b", "\\u0000", "\\u007f", "\\b"] {
            let text = format!("a = 1\n[export]\nauthors = [\"b\", \"{escape}[2J\"]\n");
            assert_eq!(
                read(&text).unwrap_err().to_string(),
                "line 3, export.authors[1]: expected a text without control characters, found one with them"
            );
        }
    }

    /// Of values, of what is missing in a table, and in lists over several lines.
    #[test]
    fn a_mistake_is_told_with_its_line() {
        #[derive(Debug, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        struct File {
            b: Vec<Item>,
            #[serde(default)]
            c: Vec<f64>,
        }
        #[derive(Debug, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Item {
            x: f64,
        }
        let read = |text: &str| parse::<File>("a file", text, |_| Ok(()));
        let good = "c = [1, 0x2,\n  +3.5,\n  1_0e-1]\n[[b]]\nx = 1\n[[b]]\nx = -2.5\n";
        let file = read(good).unwrap();
        assert_eq!(
            (&file.c[..], file.b[1].x),
            (&[1.0, 2.0, 3.5, 1.0][..], -2.5)
        );
        for (from, to, said) in [
            (
                "+3.5",
                "\"3\"",
                "line 2: expected a file (invalid type: string \"3\", expected f64), found `\"3\",`",
            ),
            (
                "1_0e-1",
                "inf",
                "line 3, c[3]: expected a finite number, found inf",
            ),
            (
                "0x2",
                "99999999999999999999",
                "line 1, c[1]: expected an integer of 64 bits, found 99999999999999999999",
            ),
            (
                "x = -2.5",
                "",
                "line 6: expected a file (missing field `x`), found `[[b]]`",
            ),
            (
                "x = -2.5",
                "y = 1",
                "line 7: expected a file (unknown field `y`, expected `x`), found `y = 1`",
            ),
            (
                "x = -2.5",
                "x = [1]",
                "line 7: expected a file (invalid type: sequence, expected f64), found `x = [1]`",
            ),
            (
                "x = -2.5",
                "x = 1979-05-27",
                "line 7: expected a file (invalid type: string \"1979-05-27\", expected f64), found `x = 1979-05-27`",
            ),
            ("x = 1\n", "x = \n", "line 5: expected a file ("),
        ] {
            let message = read(&good.replacen(from, to, 1)).unwrap_err().to_string();
            assert!(message.starts_with(said), "{message}\n{said}");
        }
    }

    #[test]
    fn a_list_is_no_block() {
        assert!(only_blocks("a = 1\n[b]\nc = [1]\n[[d]]\ne = 2\n").is_ok());
        for list in ["[45.0]", "[]"] {
            let said = only_blocks(&format!("a = 1\nflutter = {list}\n")).unwrap_err();
            assert_eq!(
                said.to_string(),
                "line 2, flutter: expected a block [flutter], found a list"
            );
        }
    }
}
