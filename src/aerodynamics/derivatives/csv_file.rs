//! This project's own file of derivatives: CSV with a header of `# key: value` lines.
//!
//! ```text
//! # aerodeck derivative table 1
//! # name: LN21-5200
//! # source: …
//! # licence: …
//! # units: …              as in `UNITS`
//! # sign_convention: …    as in `SIGN_CONVENTION`
//! # generator: …
//! # width_m: 0.5023
//! # model_length_m: 2.68
//! derivative,point,mean_speed_m_s,v_hat,value
//! P1,1,8.187888031368372,10.377701906401262,-2.5444751604141307
//! ```
//!
//! One row is one test point of one derivative, numbered from 1 in test order. Numbers are written with as many
//! digits as it takes to read the same double back. The mean speed may be left empty throughout.

use super::comment_header::{CommentHeader, Entry};
use super::table::check_points;
use super::{Derivative, DerivativePoint, DerivativeTable, SIGN_CONVENTION, TableHeader, UNITS};
use crate::error::{Error, Result};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

/// First line of the file.
const FORMAT: &str = "aerodeck derivative table 1";

/// Names of the columns.
pub const CSV_COLUMNS: [&str; 5] = ["derivative", "point", "mean_speed_m_s", "v_hat", "value"];

/// Keys of the header.
const KEYS: [&str; 8] = [
    "name",
    "source",
    "licence",
    "units",
    "sign_convention",
    "generator",
    "width_m",
    "model_length_m",
];

/// Points of one derivative and the lines they stand on.
type Rows = BTreeMap<Derivative, (Vec<DerivativePoint>, Vec<u64>)>;

/// Reads a table in this project's CSV.
///
/// # Errors
/// [`Error::Io`] when the file cannot be read, else those of [`parse_csv`] with the file named.
pub fn read_csv(path: impl AsRef<Path>) -> Result<DerivativeTable> {
    let path = path.as_ref();
    let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
    parse_csv(&text).map_err(|e| e.in_file(path))
}

/// The table in `text`, which is the content of a file in this project's CSV.
///
/// # Errors
/// [`Error::Input`] naming line, expectation and finding: missing or unknown header keys and columns, text in
/// numbers, points out of order or twice, `V̂` not positive or not monotone in a speed group, missing derivatives.
pub fn parse_csv(text: &str) -> Result<DerivativeTable> {
    let mut header = CommentHeader::new(FORMAT, &KEYS, &[]);
    for line in text.lines() {
        if !header.take(line)? {
            break;
        }
    }
    let rows = read_rows(text, header.lines() + 1)?;
    for (derivative, (points, lines)) in &rows {
        if let Some(problem) = check_points(points) {
            let place = format!("line {} ({derivative})", lines[problem.index]);
            return Err(Error::input(place, problem.expected, problem.found));
        }
    }
    header.must_say("sign_convention", SIGN_CONVENTION)?;
    if header.optional("units").is_some() {
        header.must_say("units", UNITS)?;
    }
    let length = header.optional("model_length_m");
    let provenance = TableHeader {
        source: header.text("source"),
        licence: header.text("licence"),
        generator: header.text("generator"),
        model_length_m: length
            .filter(|e| !e.value.is_empty())
            .map(Entry::positive)
            .transpose()?,
    };
    let name = header.required("name")?.value.clone();
    let width_m = header.required("width_m")?.positive()?;
    let points = rows
        .into_iter()
        .map(|(d, (points, _))| (d, points))
        .collect();
    DerivativeTable::new(name, width_m, provenance, points)
}

/// Writes a table in this project's CSV; [`parse_csv`] gives the same table back, bit for bit.
///
/// # Errors
/// Those of `out`.
pub fn write_csv(table: &DerivativeTable, out: &mut dyn Write) -> std::io::Result<()> {
    let header = &table.header;
    CommentHeader::write_format(out, FORMAT)?;
    let entries = [
        table.name.clone(),
        header.source.clone(),
        header.licence.clone(),
        UNITS.to_owned(),
        SIGN_CONVENTION.to_owned(),
        header.generator.clone(),
        table.width_m.to_string(),
        header
            .model_length_m
            .map_or_else(String::new, |l| l.to_string()),
    ];
    for (key, value) in KEYS.iter().zip(entries) {
        CommentHeader::write_line(out, key, value)?;
    }
    writeln!(out, "{}", CSV_COLUMNS.join(","))?;
    for derivative in table.derivatives() {
        for (i, p) in table.points(derivative).iter().enumerate() {
            let speed = p.mean_speed_m_s.map_or_else(String::new, |v| v.to_string());
            writeln!(
                out,
                "{derivative},{},{speed},{},{}",
                i + 1,
                p.v_hat,
                p.value
            )?;
        }
    }
    Ok(())
}

fn read_rows(text: &str, names_line: usize) -> Result<Rows> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let names = reader.headers().map_err(csv_error)?.clone();
    let columns = find_columns(&names, CSV_COLUMNS, names_line)?;
    let mut rows = Rows::new();
    for record in reader.records() {
        let record = record.map_err(csv_error)?;
        let line = record.position().map_or(0, csv::Position::line);
        let cell = |column: usize| record.get(columns[column]).unwrap_or("");
        let place = |column: usize| format!("line {line}, column {}", CSV_COLUMNS[column]);
        let derivative: Derivative = cell(0).parse().map_err(|e| at_place(e, &place(0)))?;
        let (points, lines) = rows.entry(derivative).or_default();
        let expected = (points.len() + 1).to_string();
        if cell(1) != expected {
            let found = format!("`{}`", cell(1));
            return Err(Error::input(
                place(1),
                format!("point {expected} of {derivative}"),
                found,
            ));
        }
        let mean_speed_m_s = match cell(2) {
            "" => None,
            text => Some(number(&place(2), text)?),
        };
        points.push(DerivativePoint {
            mean_speed_m_s,
            v_hat: number(&place(3), cell(3))?,
            value: number(&place(4), cell(4))?,
        });
        lines.push(line);
    }
    Ok(rows)
}

/// Positions of the `wanted` columns among `names`, which may stand in any order.
pub(in crate::aerodynamics) fn find_columns<const N: usize>(
    names: &csv::StringRecord,
    wanted: [&str; N],
    line: usize,
) -> Result<[usize; N]> {
    let mut columns = [0; N];
    for (column, wanted) in columns.iter_mut().zip(wanted) {
        *column = names
            .iter()
            .position(|name| name == wanted)
            .ok_or_else(|| {
                let found = names.iter().collect::<Vec<_>>().join(",");
                Error::input(
                    format!("line {line}"),
                    format!("a column `{wanted}`"),
                    format!("`{found}`"),
                )
            })?;
    }
    Ok(columns)
}

/// The number in one cell.
pub(in crate::aerodynamics) fn number(place: &str, text: &str) -> Result<f64> {
    text.parse()
        .map_err(|_| Error::input(place, "a number", format!("`{text}`")))
}

/// The same error at a better place.
fn at_place(error: Error, place: &str) -> Error {
    match error {
        Error::Input(input) => Error::input(place, input.expected, input.found),
        other => other,
    }
}

/// An error of the CSV reader as one of ours, with the line.
pub(in crate::aerodynamics) fn csv_error(error: csv::Error) -> Error {
    let place = error
        .position()
        .map_or_else(String::new, |p| format!("line {}", p.line()));
    match error.kind() {
        csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => Error::input(place, format!("{expected_len} columns"), len.to_string()),
        _ => Error::input(place, "a CSV row", error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::embedded;
    use super::*;

    fn written(table: &DerivativeTable) -> String {
        let mut out = Vec::new();
        write_csv(table, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn write_and_read_give_the_same_table_and_file() {
        let table = embedded::deck("LN20-5500").unwrap();
        let text = written(&table);
        let again = parse_csv(&text).unwrap();
        assert_eq!(again, table);
        assert_eq!(written(&again), text);
    }

    #[test]
    fn bad_files_are_explained() {
        let good = written(&embedded::deck("LN21-5200").unwrap());
        let row = "P1,2,8.18";
        assert!(good.contains(row));
        let cases = [
            (
                "# width_m: 0.5",
                "# width: 0.5",
                "line 8: expected one of the header keys name,",
            ),
            (
                "# name: LN21-5200\n",
                "",
                "header: expected a line `# name: …`, found none",
            ),
            (
                "y and lift up",
                "y and lift down",
                "(sign_convention): expected `y and lift up, theta",
            ),
            (
                "v_hat,value",
                "V,value",
                "line 10: expected a column `v_hat`, found `derivative,point,mean_speed_m_s,V,value`",
            ),
            (
                row,
                "P1,2,fast8.18",
                "line 12, column mean_speed_m_s: expected a number, found `fast8.18",
            ),
            (
                row,
                "P1,3,8.18",
                "line 12, column point: expected point 2 of P1, found `3`",
            ),
            (
                row,
                "P7,2,8.18",
                "line 12, column derivative: expected one of P1 to P6, H1 to H6, A1 to A6, found `P7`",
            ),
            (row, "P1,2,0,8.18", "line 12: expected 5 columns, found 6"),
            (
                "# width_m: 0",
                "# width_m: -0",
                "line 8 (width_m): expected a positive number, found -0.50",
            ),
        ];
        for (old, new, expected) in cases {
            let bad = good.replacen(old, new, 1);
            assert_ne!(bad, good, "{old}");
            let message = parse_csv(&bad).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn impossible_points_carry_their_line() {
        let table = embedded::deck("LN21-5200").unwrap();
        let good = written(&table);
        let points = table.points(Derivative::P1);
        let (third, second) = (points[2].v_hat.to_string(), points[1].v_hat.to_string());
        for (new, expected) in [
            (
                "99",
                "line 13 (P1): expected reduced velocities V̂ falling steadily",
            ),
            (
                "-1",
                "line 13 (P1): expected a positive reduced velocity V̂, found -1",
            ),
            (
                second.as_str(),
                "line 13 (P1): expected every reduced velocity V̂ once",
            ),
        ] {
            let bad = good.replacen(&third, new, 1);
            let message = parse_csv(&bad).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn a_missing_file_is_named() {
        let message = read_csv("no/such.csv").unwrap_err().to_string();
        assert!(message.starts_with("no/such.csv: "), "{message}");
    }
}
