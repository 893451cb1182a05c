//! TOML files of ours: read, checked, and every complaint with its line.

use crate::error::{Error, Place, PlaceStep, Result, has_control_characters};
use crate::files::text::read_text;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use toml::de::{DeArray, DeTable};

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
    let mut value = toml::from_str(text)
        .map_err(|e| other_kind(what, text).unwrap_or_else(|| syntax_error(what, text, &e)))?;
    without_control_characters(text)?;
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

/// Refuses texts with control characters: they end up in names of files, descriptions of FMUs and on terminals. Lines that are
/// broken, and tabs, are texts.
fn without_control_characters(text: &str) -> Result<()> {
    // such a character stands there itself or is written as an escape
    if !text.contains('\\') && !has_control_characters(text) {
        return Ok(());
    }
    let root: toml::Table = toml::from_str(text)
        .map_err(|e| Error::input("", "a file in TOML", e.message().to_owned()))?;
    match refused_text(&toml::Value::Table(root)) {
        None => Ok(()),
        Some(path) => Err(with_line(
            text,
            Error::input(
                path.as_str(),
                "a text without control characters",
                "one with them",
            ),
        )),
    }
}

/// Key of the first text with such a character.
fn refused_text(value: &toml::Value) -> Option<String> {
    let below = |key: &str, rest: String| match rest.starts_with('[') || rest.is_empty() {
        true => format!("{key}{rest}"),
        false => format!("{key}.{rest}"),
    };
    match value {
        toml::Value::String(text) => has_control_characters(text).then(String::new),
        toml::Value::Array(all) => all
            .iter()
            .enumerate()
            .find_map(|(i, v)| Some(below(&format!("[{i}]"), refused_text(v)?))),
        toml::Value::Table(all) => all
            .iter()
            .find_map(|(key, v)| Some(below(key, refused_text(v)?))),
        _ => None,
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

/// A reading error of the TOML library as one of ours.
fn syntax_error(what: &str, text: &str, error: &toml::de::Error) -> Error {
    let (place, found) = match error.span() {
        Some(span) => {
            let line = line_of(text, span.start);
            let stood = text.lines().nth(line - 1).unwrap_or("").trim();
            (Place::line(line), format!("`{stood}`"))
        }
        None => (Place::default(), "something else".to_owned()),
    };
    Error::input(
        place,
        format!("{what} ({})", error.message().replace('\n', " ")),
        found,
    )
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
