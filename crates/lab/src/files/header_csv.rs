//! What all CSV files of this project share: `# key: value` lines at the head, columns by name, numbers with their place.

use crate::error::{Error, Place, Result, counted, ensure, without_control_characters};
use crate::files::text::BYTE_ORDER_MARK;
use std::io::Write;

/// Reader of the table below the header of `text`.
pub(crate) fn table_reader(text: &str) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes())
}

/// The `wanted` columns, which may stand in any order, of the table below the header of `text`: row by row the line and the numbers.
pub(crate) fn number_rows<const N: usize>(
    text: &str,
    wanted: [&'static str; N],
    names_line: usize,
) -> Result<impl Iterator<Item = Result<(u64, [f64; N])>>> {
    let mut reader = table_reader(text);
    let columns = find_columns(reader.headers().map_err(csv_error)?, wanted, names_line)?;
    Ok(reader.into_records().map(move |record| {
        let record = record.map_err(csv_error)?;
        let line = record.position().map_or(0, csv::Position::line);
        let mut row = [0.0; N];
        for (cell, (column, name)) in row.iter_mut().zip(columns.iter().zip(wanted)) {
            let place = Place::line(line).column(name);
            *cell = number(place, record.get(*column).unwrap_or(""))?;
        }
        Ok((line, row))
    }))
}

/// One header line.
#[derive(Debug, Clone)]
pub(crate) struct HeaderLine {
    line: usize,
    key: &'static str,
    pub value: String,
}

/// The header of one file.
#[derive(Debug)]
pub(crate) struct CommentHeader {
    formats: &'static [&'static str],
    keys: &'static [&'static str],
    repeated: &'static [&'static str],
    entries: Vec<HeaderLine>,
    lines: usize,
}

impl CommentHeader {
    /// A header that allows `keys`, those in `repeated` more than once; the first line says one of `formats`.
    pub(crate) fn new(
        formats: &'static [&'static str],
        keys: &'static [&'static str],
        repeated: &'static [&'static str],
    ) -> Self {
        Self {
            formats,
            keys,
            repeated,
            entries: Vec::new(),
            lines: 0,
        }
    }

    /// The header at the head of `text`, which allows what [`CommentHeader::new`] is given.
    pub(crate) fn read(
        text: &str,
        formats: &'static [&'static str],
        keys: &'static [&'static str],
        repeated: &'static [&'static str],
    ) -> Result<Self> {
        let mut header = Self::new(formats, keys, repeated);
        for line in text.lines() {
            if !header.take(line)? {
                break;
            }
        }
        Ok(header)
    }

    /// Takes the next line of the file; `false` when it is no comment, so the header is over.
    pub(crate) fn take(&mut self, line: &str) -> Result<bool> {
        let line = match self.lines {
            0 => line.trim_start_matches(BYTE_ORDER_MARK),
            _ => line,
        };
        let Some(comment) = line.strip_prefix('#').map(str::trim) else {
            return Ok(false);
        };
        self.lines += 1;
        if comment.is_empty() || self.formats.contains(&comment) {
            return Ok(true);
        }
        let place = Place::line(self.lines);
        without_control_characters(&place, comment)?;
        let (key, value) = comment.split_once(':').ok_or_else(|| {
            let found = format!("`{}`", line.trim());
            Error::input(&place, "a header line `# key: value`", found)
        })?;
        let known = self.keys.iter().find(|k| **k == key.trim());
        let key = *known.ok_or_else(|| {
            let expected = format!("one of the header keys {}", self.keys.join(", "));
            Error::input(&place, expected, format!("`{}`", key.trim()))
        })?;
        let may_stand = self.optional(key).is_none() || self.repeated.contains(&key);
        ensure(may_stand, place, format_args!("`{key}` once"), "it twice")?;
        self.entries.push(HeaderLine {
            line: self.lines,
            key,
            value: value.trim().to_owned(),
        });
        Ok(true)
    }

    /// Number of lines taken.
    pub(crate) fn lines(&self) -> usize {
        self.lines
    }

    /// All lines with this key, in order.
    pub(crate) fn all(&self, key: &str) -> impl Iterator<Item = &HeaderLine> {
        self.entries.iter().filter(move |e| e.key == key)
    }

    /// The line with this key.
    pub(crate) fn optional(&self, key: &str) -> Option<&HeaderLine> {
        self.all(key).next()
    }

    /// The text behind this key, empty when there is no such line.
    pub(crate) fn text(&self, key: &str) -> String {
        self.optional(key)
            .map_or_else(String::new, |e| e.value.clone())
    }

    /// The line with this key, which must be there and not be empty.
    pub(crate) fn required(&self, key: &str) -> Result<&HeaderLine> {
        self.optional(key)
            .filter(|e| !e.value.is_empty())
            .ok_or_else(|| Error::input("header", format!("a line `# {key}: …`"), "none"))
    }

    /// Checks that the line with this key, which must be there, says `expected`.
    pub(crate) fn must_say(&self, key: &str, expected: &str) -> Result<()> {
        match self.required(key)? {
            entry if entry.value == expected => Ok(()),
            entry => Err(entry.wrong(&format!("`{expected}`"))),
        }
    }

    /// Writes the first line of a file and one for each key.
    pub(crate) fn write(
        out: &mut dyn Write,
        format: &str,
        entries: &[(&str, &str)],
    ) -> std::io::Result<()> {
        writeln!(out, "# {format}")?;
        for (key, value) in entries {
            Self::write_line(out, key, value)?;
        }
        Ok(())
    }

    /// Writes one line; a line break inside `value` would end the comment and becomes a blank.
    pub(crate) fn write_line(
        out: &mut dyn Write,
        key: &str,
        value: impl std::fmt::Display,
    ) -> std::io::Result<()> {
        let value = value.to_string().replace(['\n', '\r'], " ");
        writeln!(out, "# {key}: {}", value.trim())
    }
}

impl HeaderLine {
    /// Where it stands: `line 8 (width_m)`.
    pub(crate) fn place(&self) -> Place {
        Place::line(self.line).about(self.key)
    }

    /// The error that something else was `expected` here.
    pub(crate) fn wrong(&self, expected: &str) -> Error {
        Error::input(self.place(), expected, format!("`{}`", self.value))
    }

    /// The value as a number.
    pub(crate) fn number(&self) -> Result<f64> {
        self.value.parse().map_err(|_| self.wrong("a number"))
    }

    /// The value as a positive number.
    pub(crate) fn positive(&self) -> Result<f64> {
        crate::error::positive(self.place(), self.number()?)
    }
}

/// What the text of a file that comes with the program calls itself.
pub(crate) fn embedded_name(text: &str) -> &str {
    let name = text.lines().find_map(|line| line.strip_prefix("# name: "));
    name.unwrap_or_default()
}

/// Positions of the `wanted` columns among `names`, each there once, in any order.
pub(crate) fn find_columns<const N: usize>(
    names: &csv::StringRecord,
    wanted: [&str; N],
    line: usize,
) -> Result<[usize; N]> {
    let mut columns = [0; N];
    for (column, wanted) in columns.iter_mut().zip(wanted) {
        let mut at = (0..names.len()).filter(|i| names[*i] == *wanted);
        let first = at.next();
        *column = first.ok_or_else(|| missing_column(names, line, wanted))?;
        let expected = format_args!("a column `{wanted}` once");
        ensure(at.next().is_none(), Place::line(line), expected, "it twice")?;
    }
    Ok(columns)
}

pub(crate) fn missing_column(names: &csv::StringRecord, line: usize, wanted: &str) -> Error {
    let found = format!("`{}`", names.iter().collect::<Vec<_>>().join(","));
    Error::input(Place::line(line), format!("a column `{wanted}`"), found)
}

/// The number in one cell.
pub(crate) fn number(place: impl Into<Place>, text: &str) -> Result<f64> {
    text.parse()
        .map_err(|_| Error::input(place, "a number", format!("`{text}`")))
}

/// An error of the CSV reader as one of ours, with the line.
pub(crate) fn csv_error(error: csv::Error) -> Error {
    let place = error.position().map(|p| Place::line(p.line()));
    let (expected, found) = match error.kind() {
        csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => (counted(*expected_len as usize, "column"), len.to_string()),
        _ => ("a CSV row".to_owned(), error.to_string()),
    };
    Error::input(place.unwrap_or_default(), expected, found)
}
