//! Texts of users: names and remarks that end up in names of files, pages, descriptions of FMUs, tables and on terminals.

use crate::error::{Error, Place, Result};

/// Whether a text has control characters, which a terminal obeys and XML cannot hold; broken lines and tabs are texts.
pub fn has_control_characters(text: &str) -> bool {
    text.contains(|c: char| c.is_control() && !['\n', '\r', '\t'].contains(&c))
}

/// Refuses a text with control characters; every name that is read passes here.
///
/// # Errors
/// [`Error::Input`] with the place.
pub fn without_control_characters(place: impl Into<Place>, text: &str) -> Result<()> {
    if !has_control_characters(text) {
        return Ok(());
    }
    Err(with_control_characters(place))
}

/// The error that a text with control characters stands at `place`.
pub fn with_control_characters(place: impl Into<Place>) -> Error {
    Error::input(place, "a text without control characters", "one with them")
}

/// First characters of cells that spreadsheets take for formulas.
const FORMULA: [char; 4] = ['=', '+', '-', '@'];

/// A text of a user as a cell of a CSV file: quoted where it has to be, and never a formula of a spreadsheet.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::text::{csv_cell, of_csv_cell};
///
/// assert_eq!(csv_cell("=1+2, all"), "\"'=1+2, all\"");
/// assert_eq!(of_csv_cell("'=1+2"), "=1+2");
/// ```
pub fn csv_cell(text: &str) -> String {
    let formula = text.starts_with(FORMULA) && text.parse::<f64>().is_err();
    let text = if formula {
        format!("'{text}")
    } else {
        text.to_owned()
    };
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text
    }
}

/// The text that [`csv_cell`] made an unquoted cell of.
pub fn of_csv_cell(cell: &str) -> &str {
    let text = cell.strip_prefix('\'');
    text.filter(|t| t.starts_with(FORMULA)).unwrap_or(cell)
}

/// A name that can be part of a path everywhere: nothing in it leads to another folder.
pub fn file_name(name: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    let text: String = name
        .chars()
        .map(|c| if plain(c) { c } else { '_' })
        .collect();
    let trimmed = text.trim_matches('.');
    if trimmed.is_empty() { "run" } else { trimmed }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_no_formula() {
        for (text, cell) in [
            ("LN21-5200", "LN21-5200"),
            ("-12.5", "-12.5"),
            ("=1+2", "'=1+2"),
            ("@sum, all", "\"'@sum, all\""),
            ("a \"b\"", "\"a \"\"b\"\"\""),
        ] {
            assert_eq!(csv_cell(text), cell);
        }
        assert_eq!(of_csv_cell("'=1+2"), "=1+2");
        assert_eq!(of_csv_cell("'s"), "'s");
    }

    #[test]
    fn control_characters_are_refused_with_their_place() {
        assert!(without_control_characters("name", "a\tb\nc, ü ·").is_ok());
        for text in ["\u{1b}[2J", "a\0", "\u{7f}", "\u{9b}31m"] {
            let said = without_control_characters("name", text).unwrap_err();
            assert_eq!(
                said.to_string(),
                "name: expected a text without control characters, found one with them"
            );
        }
    }
}
