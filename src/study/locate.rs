//! From a key or a byte offset to the line of a TOML file.

use crate::error::Error;
use toml::de::{DeTable, DeValue};

fn line_of(text: &str, offset: usize) -> usize {
    1 + text.as_bytes()[..offset.min(text.len())]
        .iter()
        .filter(|b| **b == b'\n')
        .count()
}

/// A reading error of the TOML library as one of ours; `what` says what kind of file it should be.
pub(super) fn syntax_error(what: &str, text: &str, error: &toml::de::Error) -> Error {
    let (place, found) = match error.span() {
        Some(span) => {
            let line = line_of(text, span.start);
            let stood = text.lines().nth(line - 1).unwrap_or("").trim();
            (format!("line {line}"), format!("`{stood}`"))
        }
        None => (String::new(), "something else".to_owned()),
    };
    Error::input(
        place,
        format!("{what} ({})", error.message().replace('\n', " ")),
        found,
    )
}

/// The same error with the line of the key it names in front.
pub(super) fn with_line(text: &str, error: Error) -> Error {
    let Error::Input(mut input) = error else {
        return error;
    };
    if let Some(line) = line_of_key(text, &input.place) {
        input.place = format!("line {line}, {}", input.place);
    }
    Error::Input(input)
}

/// Line of the deepest part of the dotted key that the file states.
fn line_of_key(text: &str, key: &str) -> Option<usize> {
    let document = DeTable::parse(text).ok()?;
    let mut table = document.get_ref();
    let mut offset = None;
    for part in key.split('.') {
        let (name, index) = match part.split_once('[') {
            Some((name, index)) => (name, index.trim_end_matches(']').parse::<usize>().ok()),
            None => (part, None),
        };
        let Some((spanned_key, value)) = table.iter().find(|(k, _)| k.get_ref() == name) else {
            break;
        };
        offset = Some(spanned_key.span().start);
        let value = match (value.get_ref(), index) {
            (DeValue::Array(items), Some(i)) => {
                let Some(item) = items.get(i) else { break };
                offset = Some(item.span().start);
                item.get_ref()
            }
            (value, _) => value,
        };
        let DeValue::Table(inner) = value else { break };
        table = inner;
    }
    offset.map(|o| line_of(text, o))
}
