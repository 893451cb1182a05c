//! Text files, whose encoding is UTF-8, and texts of users in them and in their names.

use crate::error::{Error, Result, ensure};
use std::path::Path;

/// What some programs write before a text in UTF-8.
pub(crate) const BYTE_ORDER_MARK: &str = "\u{feff}";

/// The text of a file, without a byte-order mark.
///
/// # Errors
/// [`Error::Io`] when it cannot be read; [`Error::Input`] with file and line for bytes that are no UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    let mut bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    // the byte-order mark of spreadsheets is no part of the text
    if bytes.starts_with(BYTE_ORDER_MARK.as_bytes()) {
        bytes.drain(..BYTE_ORDER_MARK.len());
    }
    refuse_utf16(&bytes).map_err(|e| e.in_file(path))?;
    String::from_utf8(bytes).map_err(|e| {
        let (at, bytes) = (e.utf8_error().valid_up_to(), e.as_bytes());
        let line = line_at(bytes, at);
        let found = format!("the byte 0x{:02x} (Latin-1?)", bytes[at]);
        Error::input(format!("line {line}"), "text in UTF-8", found).in_file(path)
    })
}

/// What `parse` makes of the text of a file; errors name the file.
pub(crate) fn parsed<T>(path: &Path, parse: impl FnOnce(&str) -> Result<T>) -> Result<T> {
    let text = read_text(path)?;
    parse(&text).map_err(|e| e.in_file(path))
}

/// The line, from 1, in which a byte of a text stands.
pub(crate) fn line_at(text: &[u8], offset: usize) -> usize {
    let before = &text[..offset.min(text.len())];
    1 + before.iter().filter(|b| **b == b'\n').count()
}

/// The separator that a first row uses: where semicolons or tabs separate, commas are decimal.
pub(crate) fn separator(row: &[u8]) -> u8 {
    let mut others = [b';', b'\t'].into_iter();
    others.find(|s| row.contains(s)).unwrap_or(b',')
}

/// Refuses a file, in words, of more bytes than these.
pub(crate) fn check_mebibytes(what: &str, bytes: u64, at_most: u64) -> Result<()> {
    let expected = format_args!("{what} of at most {} MiB", at_most >> 20);
    let found = format_args!("{} MiB", bytes >> 20);
    ensure(bytes <= at_most, "", expected, found)
}

/// Whether a line of a table is empty, or has only the separators that a spreadsheet leaves of empty cells.
pub(crate) fn is_blank(line: &str) -> bool {
    line.trim_matches([',', ';', '\t', ' ', '\r', '"'])
        .is_empty()
}

/// Refuses a text in UTF-16 by the mark before it, as Windows calls "Unicode", or by the empty byte of its first letter.
pub(crate) fn refuse_utf16(bytes: &[u8]) -> Result<()> {
    let found = "text in UTF-16 (\"Unicode\" of Windows)";
    match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] | [0, ..] | [_, 0, ..] => {
            Err(Error::input("", "text in UTF-8", found))
        }
        _ => Ok(()),
    }
}

/// First characters of cells that spreadsheets take for formulas.
const FORMULA: [char; 4] = ['=', '+', '-', '@'];

/// A text of a user as a cell of a CSV file: quoted where it has to be, and never a formula of a spreadsheet.
///
/// ```
/// use aerodeck_lab::files::text::{csv_cell, of_csv_cell};
///
/// assert_eq!(csv_cell("=1+2, all"), "\"'=1+2, all\"");
/// assert_eq!(of_csv_cell("'=1+2"), "=1+2");
/// ```
pub fn csv_cell(text: &str) -> String {
    let formula = text.starts_with(FORMULA) && text.parse::<f64>().is_err();
    let text = [if formula { "'" } else { "" }, text].concat();
    match text.contains([',', '"', '\n']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text,
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
    let letters = name.chars().map(|c| if plain(c) { c } else { '_' });
    let text: String = letters.collect();
    let trimmed = text.trim_matches('.');
    if trimmed.is_empty() { "run" } else { trimmed }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_encodings_are_refused_with_their_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("study.toml");
        std::fs::write(&path, b"schema = 1\nname = \"caf\xe9\"\n").unwrap();
        let said = read_text(&path).unwrap_err().to_string();
        let expected = "study.toml: line 2: expected text in UTF-8, found the byte 0xe9 (Latin-1?)";
        assert!(said.ends_with(expected), "{said}");
    }

    #[test]
    fn a_byte_order_mark_is_no_text() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        std::fs::write(&path, "\u{feff}# a: b\n").unwrap();
        assert_eq!(read_text(&path).unwrap(), "# a: b\n");
    }

    #[test]
    fn a_text_is_no_formula() {
        for (text, cell) in [
            ("=1+2", "'=1+2"),
            ("@sum(a1)", "'@sum(a1)"),
            ("-a, b", "\"'-a, b\""),
            ("-12.5", "-12.5"),
            ("say \"a\"", "\"say \"\"a\"\"\""),
            ("Laguerre", "Laguerre"),
        ] {
            assert_eq!(csv_cell(text), cell);
        }
        assert_eq!(of_csv_cell("'=1+2"), "=1+2");
        assert_eq!(of_csv_cell("'s"), "'s");
    }
}
