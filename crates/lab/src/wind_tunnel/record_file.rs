//! Records in CSV files, written and read.
//!
//! The format is that of [`super::record_format`].
//!
//! Forces are self-excited ones per unit length, N/m and N·m/m. Reading streams the file in blocks of bounded size.

use super::record_format::{RecordFile, read_head, text, write_head};
use super::records::{Record, RecordHeader, RecordSource};
use crate::error::{Error, Place, Result, counted, ensure, without_control_characters};
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::Path;

/// Fewest samples that a record may have.
pub(crate) const SAMPLES_AT_LEAST: usize = 64;

/// Samples per block.
const BLOCK_SAMPLES: usize = 4096;

/// A sample may stand off its place by this fraction of the sampling step: time stamps are often rounded.
const JITTER: f64 = 0.25;

/// The mean sampling frequency may differ from the stated one by this fraction.
const DRIFT: f64 = 1e-3;

impl RecordFile {
    /// Opens a record and reads its header; the samples are checked whenever they are read.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Input`] with file and line for a header line or column that is missing, unknown or
    /// wrong.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|e| Error::io(path, e))?;
        read_head(path, &mut BufReader::new(file)).map_err(|e| e.in_file(path))
    }
}

impl RecordSource for RecordFile {
    fn header(&self) -> &RecordHeader {
        &self.header
    }

    /// # Errors
    /// [`Error::Io`]; [`Error::Input`] with file and line: text or NaN in place of a number, a row with more or fewer
    /// columns, a gap in time or an uneven step, another sampling frequency than stated, fewer than
    /// 64 samples.
    fn for_each_block(&self, f: &mut dyn FnMut(&[&[f64]]) -> Result<()>) -> Result<()> {
        let io = |e| Error::io(&self.path, e);
        let mut file = File::open(&self.path).map_err(io)?;
        file.seek(SeekFrom::Start(self.start)).map_err(io)?;
        let mut reader = BufReader::with_capacity(1 << 16, file);
        let mut rows = RecordRows::new(self);
        let mut line = Vec::new();
        loop {
            line.clear();
            if reader.read_until(b'\n', &mut line).map_err(io)? == 0 {
                break;
            }
            rows.push(&line).map_err(|e| e.in_file(&self.path))?;
            if rows.channels[0].len() == BLOCK_SAMPLES {
                rows.pass_on(f)?;
            }
        }
        rows.check_length().map_err(|e| e.in_file(&self.path))?;
        rows.pass_on(f)
    }
}

/// Reads a whole record into memory.
///
/// # Errors
/// [`Error::Io`]; [`Error::Input`] with file and line for everything that is wrong in it.
pub fn read_record(path: impl AsRef<Path>) -> Result<Record> {
    let record = Record::whole(&RecordFile::open(&path)?)?;
    let checked = record.header.check_segments(&record.motion);
    checked.map_err(|e| e.in_file(path)).map(|()| record)
}

/// Writes a record; [`read_record`] gives the same numbers back, bit for bit.
///
/// # Errors
/// [`Error::Input`] naming a record that cannot be read; [`Error::Io`] naming the record when `out` fails.
pub fn write_record(record: &dyn RecordSource, out: &mut dyn Write) -> Result<()> {
    let header = record.header();
    without_control_characters("name", &header.name)?;
    let io = |e| Error::io(&header.name, e);
    write_head(header, out).map_err(io)?;
    let mut first = 0;
    record.for_each_block(&mut |block| {
        write_rows(out, header.sampling_hz, first, block).map_err(io)?;
        first += block.first().map_or(0, |c| c.len());
        Ok(())
    })?;
    out.flush().map_err(io)
}

/// Writes channels as rows that begin with the time; `first` is the number of the first sample.
pub(super) fn write_rows(
    out: &mut dyn Write,
    sampling_hz: f64,
    first: usize,
    channels: &[&[f64]],
) -> std::io::Result<()> {
    let mut line = String::new();
    for i in 0..channels.first().map_or(0, |c| c.len()) {
        line.clear();
        // From the count, so that no rounding accumulates.
        push_number(&mut line, (first + i) as f64 / sampling_hz);
        for channel in channels {
            line.push(',');
            push_number(&mut line, channel[i]);
        }
        line.push('\n');
        out.write_all(line.as_bytes())?;
    }
    Ok(())
}

/// The shortest text that reads back as the same double.
fn push_number(text: &mut String, x: f64) {
    let plain = x == 0.0 || (1e-3..1e6).contains(&x.abs());
    // Writing to a string cannot fail.
    let _ = if plain {
        write!(text, "{x}")
    } else {
        write!(text, "{x:e}")
    };
}

/// What stands between commas; as `split(',')`, without its search for characters of any size.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    let mut left = Some(line);
    std::iter::from_fn(move || {
        let rest = left?;
        let comma = rest.bytes().position(|b| b == b',');
        left = comma.map(|at| &rest[at + 1..]);
        Some(comma.map_or(rest, |at| &rest[..at]))
    })
}

/// Rows being collected into a block.
struct RecordRows<'a> {
    file: &'a RecordFile,
    line: usize,
    /// Motions, then forces.
    channels: Vec<Vec<f64>>,
    read: usize,
    first_time: f64,
    last_time: f64,
}

impl<'a> RecordRows<'a> {
    fn new(file: &'a RecordFile) -> Self {
        Self {
            file,
            line: file.names_line,
            channels: vec![Vec::with_capacity(BLOCK_SAMPLES); 2 * file.header.dofs.len()],
            read: 0,
            first_time: 0.0,
            last_time: 0.0,
        }
    }

    fn pass_on(&mut self, f: &mut dyn FnMut(&[&[f64]]) -> Result<()>) -> Result<()> {
        if self.channels[0].is_empty() {
            return Ok(());
        }
        let channels: Vec<&[f64]> = self.channels.iter().map(Vec::as_slice).collect();
        f(&channels)?;
        self.channels.iter_mut().for_each(Vec::clear);
        Ok(())
    }

    /// Takes one line of the file; blank lines count for nothing.
    fn push(&mut self, line: &[u8]) -> Result<()> {
        self.line += 1;
        let line =
            text(line).map_err(|found| Error::input(Place::line(self.line), "numbers", found))?;
        if line.trim().is_empty() {
            return Ok(());
        }
        let mut cells = cells(line);
        for (column, channel) in self.file.channels.iter().enumerate() {
            let cell = cells.next().ok_or_else(|| self.unequal(line))?;
            let value = cell.parse().or_else(|_| cell.trim().parse::<f64>());
            let value = value.ok().filter(|x| x.is_finite());
            let value = value.ok_or_else(|| {
                let place = Place::line(self.line).column(&self.file.names[column]);
                Error::input(place, "a finite number", format!("`{}`", cell.trim()))
            })?;
            match channel {
                None => self.check_time(value)?,
                Some(i) => self.channels[*i].push(value),
            }
        }
        if cells.next().is_some() {
            return Err(self.unequal(line));
        }
        self.read += 1;
        Ok(())
    }

    fn unequal(&self, line: &str) -> Error {
        let expected = counted(self.file.channels.len(), "column");
        let found = line.split(',').count().to_string();
        Error::input(Place::line(self.line), expected, found)
    }

    fn check_time(&mut self, time_s: f64) -> Result<()> {
        let (sampling, step) = (self.file.header.sampling_hz, time_s - self.last_time);
        if self.read == 0 {
            self.first_time = time_s;
        } else if (step * sampling - 1.0).abs() > JITTER {
            let place = Place::line(self.line).column("time_s");
            let usual = 1.0 / sampling;
            let expected = format!("{usual} s after the sample before ({sampling} Hz)");
            return Err(Error::input(place, expected, format!("{step:.6} s")));
        }
        self.last_time = time_s;
        Ok(())
    }

    /// What can only be known at the end.
    fn check_length(&self) -> Result<()> {
        let (read, header) = (self.read, &self.file.header);
        let expected = format_args!("at least {SAMPLES_AT_LEAST} samples");
        ensure(read >= SAMPLES_AT_LEAST, "end of the file", expected, read)?;
        let mean = (read - 1) as f64 / (self.last_time - self.first_time);
        let (stated, found) = (header.sampling_hz, format_args!("{mean:.4} Hz"));
        let expected = format_args!("samples at {stated} Hz as in the header");
        let holds = (mean / stated - 1.0).abs() <= DRIFT;
        ensure(holds, "column time_s", expected, found)?;
        header.check_ends(read)
    }
}

#[cfg(test)]
mod tests;
