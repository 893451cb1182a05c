//! This project's own file of derivatives: CSV with a header of `# key: value` lines.
//!
//! ```text
//! # aerodeck derivative table 2
//! # name: LN21-5200
//! # source: …
//! # licence: …
//! # notation: scanlan       or simiu, classical, polimi, starossek
//! # argument: v_hat = V/(omega B)
//! # axes: heave and lift up, rotation and moment nose-up, sway and drag downwind
//! # definition: …           the notation in words
//! # units: …
//! # generator: …
//! # width_m: 0.5023
//! # model_length_m: 2.68
//! derivative,point,mean_speed_m_s,v_hat,value
//! P1,1,8.187888031368372,10.377701906401262,-2.5444751604141307
//! ```
//!
//! One row is one test point of one derivative, numbered from 1 in test order. Derivatives are called as in the
//! notation, the fourth column as the argument. Numbers are written with as many digits as it takes to read the same
//! double back. The mean speed may be left empty throughout. Files of the first format, without notation, argument and
//! axes but with a `sign_convention`, are read as what they are: Scanlan with ½ over V̂, heave up.

use crate::aerodynamics::derivatives::notation::{Argument, Convention, ExpressedPoint};
use crate::aerodynamics::derivatives::table::check_point_count;
use crate::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable, TableHeader};
use crate::error::{Error, Place, Result, ensure};
use crate::files::derivatives::csv_header::{
    ReadOptions, fill_in, provenance, read_head, stated, width_stated, write_head,
};
use crate::files::derivatives::csv_wide::{self, Rows};
use crate::files::header_csv::{csv_error, find_columns, missing_column, number, table_reader};
use crate::files::text::{check_mebibytes, parsed};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

/// Names of the columns in the crate's own convention; the fourth is called as the argument.
pub(crate) const CSV_COLUMNS: [&str; 5] =
    ["derivative", "point", "mean_speed_m_s", "v_hat", "value"];
/// Place of the argument among them.
const ARGUMENT: usize = 3;

/// A file of tables, bytes: 18 derivatives at ten thousand points in full precision.
const BYTES_AT_MOST: u64 = 100 << 20;

/// Reads a CSV table, this project's or a wide one (one row per reduced velocity, one column per derivative), with what the
/// caller states.
pub(crate) fn read_csv_with(
    path: impl AsRef<Path>,
    options: &ReadOptions,
) -> Result<(DerivativeTable, Convention)> {
    let path = path.as_ref();
    let about = std::fs::metadata(path).map_err(|e| Error::io(path, e))?;
    check_mebibytes("a table", about.len(), BYTES_AT_MOST).map_err(|e| e.in_file(path))?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    parsed(path, |text| match csv_wide::is_wide(text) {
        true => csv_wide::parse(text, &stem, options),
        false => parse_csv_in(text, options),
    })
}

/// The table in `text`, which is the content of a file in this project's CSV.
///
/// # Errors
/// [`Error::Input`] naming line, expectation and finding: missing or unknown header keys and columns, a convention that
/// is not stated or contradicts itself, text in numbers, points out of order or twice, `V̂` not positive or not monotone
/// in a speed group, missing derivatives.
pub(crate) fn parse_csv(text: &str) -> Result<DerivativeTable> {
    parse_csv_in(text, &ReadOptions::default()).map(|(table, _)| table)
}

/// A table from text in our own format, with what the caller states, and its convention.
///
/// # Errors
/// As [`read_table_with`](super::read_table_with); a stated convention that contradicts the text.
pub fn parse_csv_in(text: &str, options: &ReadOptions) -> Result<(DerivativeTable, Convention)> {
    let head = read_head(text)?;
    let mut reader = table_reader(text);
    let names = reader.headers().map_err(csv_error)?.clone();
    let line = head.lines() + 1;
    let mut in_file = stated(&head)?;
    let column = find_argument(&names, line)?;
    let said = in_file.argument.unwrap_or(column);
    let expected = format_args!("a column `{said}` as the header says");
    let found = format_args!("`{column}`");
    ensure(said == column, Place::line(line), expected, found)?;
    in_file.argument = Some(column);
    let convention = options.convention.with_file(in_file)?;
    let mut wanted = CSV_COLUMNS;
    wanted[ARGUMENT] = column.name();
    let columns = find_columns(&names, wanted, line)?;
    let rows = read_rows(&mut reader, &columns, &convention)?;
    let mut points = csv_wide::checked(rows, &convention)?;
    let mut header = provenance(&head)?;
    header.notes.extend(fill_in(&mut points, options.missing));
    let width = match width_stated(&head, options.width_m)? {
        Some(width) => width,
        None => head.required("width_m")?.positive()?,
    };
    let table = DerivativeTable::new(head.required("name")?.value.clone(), width, header, points)?;
    Ok((table, convention))
}

/// Writes a table in this project's CSV and convention; `parse_csv` gives the same table back, bit for bit.
pub fn write_csv(table: &DerivativeTable, out: &mut dyn Write) -> std::io::Result<()> {
    write_csv_in(table, &Convention::default(), out)
}

/// Writes points of a few derivatives, too few for a table, in the columns and convention of [`write_csv`]: what one motion alone tells.
pub fn write_points(
    name: &str,
    width_m: f64,
    header: &TableHeader,
    points: &BTreeMap<Derivative, Vec<DerivativePoint>>,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    write_head(out, name, width_m, header, &Convention::default())?;
    writeln!(out, "{}", CSV_COLUMNS.join(","))?;
    for (derivative, of_one) in points {
        for (i, p) in of_one.iter().enumerate() {
            let (at, speed) = ([p.v_hat, p.value], p.mean_speed_m_s);
            write_row(out, derivative.name(), i, speed, at)?;
        }
    }
    Ok(())
}

/// Writes a table in this project's CSV in `convention`, which its header states.
pub fn write_csv_in(
    table: &DerivativeTable,
    convention: &Convention,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    write_head(out, &table.name, table.width_m, &table.header, convention)?;
    let mut columns = CSV_COLUMNS;
    columns[ARGUMENT] = convention.argument.name();
    writeln!(out, "{}", columns.join(","))?;
    for derivative in convention.express(table).derivatives {
        for (i, p) in derivative.points.iter().enumerate() {
            let (at, speed) = ([p.argument, p.value], p.mean_speed_m_s);
            write_row(out, derivative.name, i, speed, at)?;
        }
    }
    Ok(())
}

/// Writes a point, the `i`-th of its derivative from 0: argument and value.
fn write_row(
    out: &mut dyn Write,
    name: &str,
    i: usize,
    mean_speed_m_s: Option<f64>,
    [argument, value]: [f64; 2],
) -> std::io::Result<()> {
    let speed = mean_speed_m_s.map_or_else(String::new, |v| v.to_string());
    writeln!(out, "{name},{},{speed},{argument},{value}", i + 1)
}

fn read_rows(
    reader: &mut csv::Reader<&[u8]>,
    columns: &[usize; CSV_COLUMNS.len()],
    convention: &Convention,
) -> Result<Rows> {
    let mut rows = Rows::new();
    for record in reader.records() {
        let record = record.map_err(csv_error)?;
        // what a spreadsheet leaves of empty cells
        if record.iter().all(str::is_empty) {
            continue;
        }
        let line = record.position().map_or(0, csv::Position::line);
        let cell = |column: usize| record.get(columns[column]).unwrap_or("");
        let place = |column: usize| {
            Place::line(line).column(match column {
                ARGUMENT => convention.argument.name(),
                other => CSV_COLUMNS[other],
            })
        };
        let derivative = convention.notation.derivative(cell(0));
        let derivative = derivative.map_err(|e| e.at(place(0)))?;
        let (points, lines) = rows.entry(derivative).or_default();
        let (name, point, next) = (cell(0), cell(1), points.len() + 1);
        let expected = format_args!("point {next} of {name}");
        let is_next = point == next.to_string();
        ensure(is_next, place(1), expected, format_args!("`{point}`"))?;
        let mean_speed_m_s = match cell(2) {
            "" => None,
            text => Some(number(place(2), text)?),
        };
        let argument = number(place(ARGUMENT), cell(ARGUMENT))?;
        if convention.argument != Argument::VHat {
            crate::error::positive(place(ARGUMENT), argument)?;
        }
        let value = number(place(4), cell(4))?;
        let point = ExpressedPoint {
            mean_speed_m_s,
            argument,
            value,
        };
        check_point_count(place(0), next)?;
        points.push(convention.read_point(derivative, &point));
        lines.push(line as usize);
    }
    Ok(rows)
}

/// The argument that the file has a column of.
fn find_argument(names: &csv::StringRecord, line: usize) -> Result<Argument> {
    let is_there = |a: &Argument| names.iter().any(|name| name == a.name());
    let mut found = Argument::ALL.into_iter().filter(is_there);
    match (found.next(), found.next()) {
        (Some(argument), None) => Ok(argument),
        (None, _) => Err(missing_column(names, line, Argument::VHat.name())),
        (Some(first), Some(second)) => {
            let expected = "one column of reduced velocities or frequencies";
            let found = format!("`{first}` and `{second}`");
            Err(Error::input(Place::line(line), expected, found))
        }
    }
}

#[cfg(test)]
mod tests;
