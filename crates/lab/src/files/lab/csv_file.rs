//! CSV as laboratories write it: commas, semicolons or tabs; decimal points or commas; a row of units or none.
//!
//! Lines that begin with `#` or `%` are comments; `# key: value` gives an attribute. The first other row is the header
//! unless all of it is numbers. A row of units may follow, or units may stand behind the names: `y [mm]`, `Fx (N)`.
//! An empty cell or `NaN` is a missing sample. A column whose first cell is text is left out.

use super::channels::{Attribute, Channel, ChannelSet, check_count, no_group};
use crate::error::{Error, Place, Result, counted};
use crate::files::text::{line_at, refuse_utf16, separator};
use std::borrow::Cow;

/// A row of a thousand channels has 20 kB.
const LINE_BYTES_AT_MOST: usize = 1 << 20;

/// Reads the text of a CSV file.
///
/// # Errors
/// [`Error::Input`] with line and column for text in place of a number and rows of unequal length.
pub(super) fn parse(bytes: &[u8], group: Option<&str>) -> Result<ChannelSet> {
    if let Some(group) = group {
        return Err(no_group(group, &[]));
    }
    refuse_utf16(bytes)?;
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut set = ChannelSet::default();
    let start = take_comments(bytes, &mut set);
    let (skipped, rest) = (line_at(bytes, start) - 1, &bytes[start..]);
    check_lines(rest, skipped)?;
    let separator = separator(rest.split(|b| *b == b'\n').next().unwrap_or(rest));
    let decimal_comma = separator != b',';
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .has_headers(false)
        .flexible(true)
        .from_reader(rest);
    let mut row = csv::ByteRecord::new();
    let mut table: Option<ChannelTable> = None;
    loop {
        let line = skipped + reader.position().line() as usize;
        match reader.read_byte_record(&mut row) {
            Ok(true) => {}
            Ok(false) => break,
            Err(e) => return Err(Error::input(Place::line(line), "a row", e.to_string())),
        }
        match &mut table {
            None => table = Some(ChannelTable::begin(&row, decimal_comma)),
            Some(table) => table.take(&row, line)?,
        }
    }
    let table = table
        .filter(|t| t.rows > 0)
        .ok_or_else(|| Error::input("", "a header and rows of numbers", "no row of numbers"))?;
    table.finish(&mut set);
    Ok(set)
}

/// Text that is UTF-8 or else Latin-1, in which many programs write `°`.
fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => bytes.iter().map(|b| char::from(*b)).collect(),
    }
}

/// Comments at the head as attributes; the byte behind them.
fn take_comments(bytes: &[u8], set: &mut ChannelSet) -> usize {
    let mut start = 0;
    for line in bytes.split_inclusive(|b| *b == b'\n') {
        let text = decoded(line);
        let text = text.trim();
        let comment = text.strip_prefix(['#', '%']);
        if let Some((key, value)) = comment.and_then(|c| c.split_once(':')) {
            let value = value.trim();
            let value = match value.parse() {
                Ok(number) => Attribute::Number(number),
                Err(_) => Attribute::Text(value.to_owned()),
            };
            set.attributes.insert(key.trim().to_owned(), value);
        } else if comment.is_none() && !text.is_empty() {
            break;
        }
        start += line.len();
    }
    start
}

/// Refuses lines that are no rows of samples, before anything is made of them.
fn check_lines(bytes: &[u8], skipped: usize) -> Result<()> {
    let mut lines = bytes.split(|b| *b == b'\n').map(<[u8]>::len).enumerate();
    let Some((i, length)) = lines.find(|(_, length)| *length > LINE_BYTES_AT_MOST) else {
        return Ok(());
    };
    let expected = format!("a row of at most {LINE_BYTES_AT_MOST} bytes");
    let place = Place::line(skipped + i + 1);
    Err(Error::input(place, expected, format!("{length} bytes")))
}

/// A number, NaN where nothing stands; `None` for text.
fn number(cell: &[u8], decimal_comma: bool) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?;
    // nearly all cells hold a number and nothing else
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    let text = text.trim();
    if text.is_empty() {
        return Some(f64::NAN);
    }
    match decimal_comma && text.contains(',') {
        true => text.replacen(',', ".", 1).parse().ok(),
        false => text.parse().ok(),
    }
}

/// Columns being filled.
struct ChannelTable {
    decimal_comma: bool,
    /// Each channel, and whether it is of text.
    columns: Vec<(Channel, bool)>,
    rows: usize,
    units_taken: bool,
    /// Comma or point of the first number that has one.
    mark: Option<u8>,
}

impl ChannelTable {
    /// From the first row.
    fn begin(row: &csv::ByteRecord, decimal_comma: bool) -> Self {
        let numbers = row.iter().map(|cell| number(cell, decimal_comma));
        let numbers: Option<Vec<f64>> = numbers.collect();
        let column = |(i, cell): (usize, &[u8])| {
            let (name, unit) = match &numbers {
                Some(_) => (format!("column[{}]", i + 1), None),
                None => name_and_unit(decoded(cell).trim()),
            };
            let samples = numbers.iter().map(|row| row[i]).collect();
            let channel = Channel {
                name,
                samples,
                unit,
            };
            (channel, false)
        };
        Self {
            decimal_comma,
            columns: row.iter().enumerate().map(column).collect(),
            rows: usize::from(numbers.is_some()),
            units_taken: numbers.is_some(),
            mark: None,
        }
    }

    fn take(&mut self, row: &csv::ByteRecord, line: usize) -> Result<()> {
        // a separator at the end of every line gives an empty cell more
        let columns = self.columns.len();
        let mut surplus = columns..row.len();
        if row.len() < columns || surplus.any(|c| !row[c].trim_ascii().is_empty()) {
            let expected = format!("{} as in the header", counted(columns, "column"));
            let found = row.len().to_string();
            return Err(Error::input(Place::line(line), expected, found));
        }
        if self.rows == 0 && self.take_units(row) {
            return Ok(());
        }
        for ((channel, is_text), cell) in self.columns.iter_mut().zip(row) {
            let place = |name: &str| Place::line(line).column(name);
            match number(cell, self.decimal_comma) {
                _ if *is_text => {}
                Some(x) => {
                    channel.samples.push(x);
                    if self.decimal_comma {
                        one_mark(&mut self.mark, cell, || place(&channel.name))?;
                    }
                }
                None if self.rows == 0 => *is_text = true,
                None => {
                    let found = format!("`{}`", String::from_utf8_lossy(cell));
                    return Err(Error::input(place(&channel.name), "a number", found));
                }
            }
        }
        self.rows += 1;
        check_count(Place::line(line), (self.rows * columns) as u64)
    }

    /// Takes a row without any number as units.
    fn take_units(&mut self, row: &csv::ByteRecord) -> bool {
        let is_text = |cell: &[u8]| number(cell, self.decimal_comma).is_none_or(f64::is_nan);
        if self.units_taken || !row.iter().all(is_text) || row.iter().all(<[u8]>::is_empty) {
            return false;
        }
        let stated = |cell: &[u8]| {
            let text = decoded(cell);
            let text = text.trim().trim_matches(['[', ']', '(', ')']).to_owned();
            (!text.is_empty()).then_some(text)
        };
        for ((channel, _), cell) in self.columns.iter_mut().zip(row) {
            channel.unit = channel.unit.take().or_else(|| stated(cell));
        }
        self.units_taken = true;
        true
    }

    fn finish(self, set: &mut ChannelSet) {
        for (channel, is_text) in self.columns {
            match is_text {
                true => set.leave_out(channel.name, "text"),
                false if channel.name.is_empty() => {}
                false => set.channels.push(channel),
            }
        }
    }
}

/// Refuses a number with a point beside others with a comma, and the other way round: it may be a thousand.
fn one_mark(first: &mut Option<u8>, cell: &[u8], place: impl FnOnce() -> Place) -> Result<()> {
    let mark = cell.iter().find(|byte| matches!(byte, b',' | b'.'));
    match mark.map(|mark| (*mark, *first.get_or_insert(*mark))) {
        Some((mark, first)) if mark != first => {
            let expected = format!("decimals behind `{}` as above", char::from(first));
            let found = format!("`{}`", String::from_utf8_lossy(cell));
            Err(Error::input(place(), expected, found))
        }
        _ => Ok(()),
    }
}

/// `y [mm]` and `y (mm)` are the channel `y` in mm.
fn name_and_unit(header: &str) -> (String, Option<String>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        let inside = header.strip_suffix(close).and_then(|h| h.rsplit_once(open));
        if let Some((name, unit)) = inside {
            let is_unit = unit.parse::<usize>().is_err() && !name.trim().is_empty();
            if is_unit {
                return (name.trim().to_owned(), Some(unit.trim().to_owned()));
            }
        }
    }
    (header.to_owned(), None)
}
