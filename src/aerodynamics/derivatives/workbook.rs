//! Workbooks of derivatives as NTNU keeps them (.xlsx).
//!
//! Three sheets, `Mean wind velocity`, `Reduced Velocities`, `Aerodynamic Derivatives`, in any order; in each a
//! row of names and below it one row a test point; one column a derivative, named `MeanWind_H1`, `Vred_H1`, `H1`.
//! Derivatives of sway may be left out, in all three sheets alike; other sheets are not looked at.
//! Every derivative has its own `V̂ = V/(ωB)`. The width is not written down; it follows from the frequencies,
//! `B = V/(2πf V̂)`. NTNU's workbooks do not state their convention, which is that of this project
//! ([`super::SIGN_CONVENTION`]). Any other is stated by the reader or by a sheet `Notes` (keys `notation`, `argument`,
//! `axes` beside their values); the columns are then called as in that notation (`MeanWind_h1`, `Vred_h1`, `h1`),
//! whatever the sheet `Reduced Velocities` holds.

use super::notation::{Convention, ExpressedPoint, StatedConvention};
use super::{Derivative, DerivativePoint, DerivativeTable, TableHeader};
use crate::error::{Error, Result, positive};
use calamine::{Data, Range, Reader, Xlsx, open_workbook};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;

/// Frequencies of the tests, Hz, in test order at each speed (Table 3.2 of the thesis).
pub const TABLE_3_2_FREQUENCIES_HZ: [f64; 8] = [0.25, 0.5, 0.8, 1.1, 1.4, 1.7, 2.0, 2.5];

/// Name of the sheet of notes.
pub(super) const NOTES: &str = "Notes";

/// The same width must follow from every point to within this fraction.
const WIDTH_TOLERANCE: f64 = 0.01;

/// Kind of sheet: its name and what its column names begin with.
pub(super) const SPEEDS: (&str, &str) = ("Mean wind velocity", "MeanWind_");
pub(super) const REDUCED_VELOCITIES: (&str, &str) = ("Reduced Velocities", "Vred_");
pub(super) const DERIVATIVES: (&str, &str) = ("Aerodynamic Derivatives", "");

/// What a workbook does not say of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkbookOptions {
    /// Name of the deck; `None` takes the file name without `AerodynamicDerivatives_` and extension.
    pub name: Option<String>,
    /// Width of the section model, m; `None` derives it from `frequencies_hz`.
    pub width_m: Option<f64>,
    /// What is known about notation, argument and axes of the figures; a sheet `Notes` must not contradict it.
    pub convention: StatedConvention,
    /// Frequencies of motion, Hz, in test order; repeated for every further speed.
    pub frequencies_hz: Vec<f64>,
    /// Provenance; an empty `source` is filled with the file name, an empty `generator` with this program.
    pub header: TableHeader,
}

impl Default for WorkbookOptions {
    fn default() -> Self {
        Self {
            name: None,
            width_m: None,
            convention: StatedConvention::default(),
            frequencies_hz: TABLE_3_2_FREQUENCIES_HZ.to_vec(),
            header: TableHeader::default(),
        }
    }
}

/// Reads an NTNU workbook of derivatives.
///
/// # Errors
/// [`Error::Input`] with file, sheet and cell: not a workbook, a missing sheet or column, an empty cell or text in
/// place of a number, sheets of unequal length, no common width, and those of [`DerivativeTable::new`].
pub fn read_workbook(path: impl AsRef<Path>, options: &WorkbookOptions) -> Result<DerivativeTable> {
    read_workbook_in(path, options).map(|(table, _)| table)
}

/// The same; the second value is the convention that the workbook is in.
///
/// # Errors
/// Those of [`read_workbook`].
pub fn read_workbook_in(
    path: impl AsRef<Path>,
    options: &WorkbookOptions,
) -> Result<(DerivativeTable, Convention)> {
    let path = path.as_ref();
    // Asked for first, because the reader reports a missing file like a damaged one.
    std::fs::metadata(path).map_err(|e| Error::io(path, e))?;
    let read = || {
        let mut book: Xlsx<_> = open_workbook(path).map_err(|e: calamine::XlsxError| {
            Error::input("", "an .xlsx workbook", e.to_string())
        })?;
        let convention = convention_of(options.convention, &notes(&mut book)?)?;
        let points = read_sheets(&mut book, &convention)?;
        Ok((table_from(path, options, points)?, convention))
    };
    read().map_err(|e: Error| e.in_file(path))
}

/// Keys and values of the sheet `Notes`; empty when there is none.
fn notes(book: &mut Xlsx<std::io::BufReader<std::fs::File>>) -> Result<BTreeMap<String, String>> {
    if !book.sheet_names().iter().any(|n| n == NOTES) {
        return Ok(BTreeMap::new());
    }
    let range = book
        .worksheet_range(NOTES)
        .map_err(|e| Error::input(format!("sheet {NOTES}"), "readable cells", e.to_string()))?;
    let cell = |row: usize, column: usize| range.get((row, column)).map(ToString::to_string);
    let line = |row| Some((cell(row, 0)?, cell(row, 1)?));
    Ok((0..range.height()).filter_map(line).collect())
}

/// What the notes and the caller say of the convention; when neither says anything, it is NTNU's, this project's own.
fn convention_of(stated: StatedConvention, notes: &BTreeMap<String, String>) -> Result<Convention> {
    let mut file = StatedConvention {
        notation: parse_note(notes, "notation")?,
        argument: parse_note(notes, "argument")?,
        axes: parse_note(notes, "axes")?,
    };
    if file.is_empty() && stated.notation.is_none() {
        // without a notation the workbook is NTNU's in all that is not stated otherwise
        let own = Convention::default();
        file = StatedConvention {
            notation: Some(own.notation),
            argument: stated.argument.or(Some(own.argument)),
            axes: stated.axes.or(Some(own.axes)),
        };
    }
    stated.with_file(file)
}

fn parse_note<T: std::str::FromStr<Err = Error>>(
    notes: &BTreeMap<String, String>,
    key: &str,
) -> Result<Option<T>> {
    let parse = |text: &String| {
        text.parse().map_err(|e| match e {
            Error::Input(input) => {
                Error::input(format!("sheet {NOTES}, {key}"), input.expected, input.found)
            }
            other => other,
        })
    };
    notes.get(key).map(parse).transpose()
}

type Points = BTreeMap<Derivative, Vec<DerivativePoint>>;

fn read_sheets(
    book: &mut Xlsx<std::io::BufReader<std::fs::File>>,
    convention: &Convention,
) -> Result<Points> {
    let mut range = |kind: (&str, &str)| -> Result<Range<Data>> {
        let names = book.sheet_names();
        let wanted = names.iter().find(|n| n.trim().eq_ignore_ascii_case(kind.0));
        let name = wanted.cloned().ok_or_else(|| {
            let expected = format!("a sheet `{}`", kind.0);
            Error::input("workbook", expected, format!("`{}`", names.join("`, `")))
        })?;
        book.worksheet_range(&name)
            .map_err(|e| Error::input(format!("sheet {name}"), "readable cells", e.to_string()))
    };
    let sheets = [
        (range(SPEEDS)?, SPEEDS),
        (range(REDUCED_VELOCITIES)?, REDUCED_VELOCITIES),
        (range(DERIVATIVES)?, DERIVATIVES),
    ];
    // tests without sway have no columns for what it couples; a column in one sheet must be in all
    let names = |d| convention.notation.name_of(d);
    let is_held = |d: &Derivative| {
        sheets
            .iter()
            .any(|(range, kind)| column_of(&titles(range), kind.1, names(*d)).is_some())
    };
    let held: Vec<Derivative> = Derivative::ALL.into_iter().filter(is_held).collect();
    if held.is_empty() {
        let found = format!("`{}`", titles(&sheets[2].0).join("`, `"));
        let expected = format!("columns named {}", convention.notation.names());
        return Err(Error::input(
            format!("sheet {}, first row", DERIVATIVES.0),
            expected,
            found,
        ));
    }
    let columns = |i: usize| read_columns(&sheets[i].0, sheets[i].1, &held, convention);
    let (speeds, arguments, values) = (columns(0)?, columns(1)?, columns(2)?);
    let points = held.iter().map(|&d| {
        let (speeds, arguments, values) = (&speeds[&d], &arguments[&d], &values[&d]);
        for (sheet, column) in [(REDUCED_VELOCITIES, arguments), (DERIVATIVES, values)] {
            if column.len() != speeds.len() {
                let expected = format!("{} test points as in sheet {}", speeds.len(), SPEEDS.0);
                let found = column.len().to_string();
                return Err(Error::input(format!("sheet {}", sheet.0), expected, found));
            }
        }
        let point = |((speed, argument), value): ((&f64, &f64), &f64)| {
            let point = ExpressedPoint {
                mean_speed_m_s: Some(*speed),
                argument: *argument,
                value: *value,
            };
            convention.read_point(d, &point)
        };
        let columns = speeds.iter().zip(arguments).zip(values);
        Ok((d, columns.map(point).collect()))
    });
    points.collect()
}

/// The first row of a sheet.
fn titles(range: &Range<Data>) -> Vec<String> {
    let title = |column: usize| {
        range
            .get((0, column))
            .map(ToString::to_string)
            .unwrap_or_default()
    };
    (0..range.width()).map(title).collect()
}

/// The column of the derivative of this name. Capitals count in it: h1 and H1 are different numbers.
fn column_of(titles: &[String], prefix: &str, name: &str) -> Option<usize> {
    let wanted = format!("{prefix}{name}");
    titles.iter().position(|t| {
        let title = t.trim().trim_end_matches('*');
        title.eq_ignore_ascii_case(&wanted) && title.ends_with(name)
    })
}

/// The columns of one sheet that belong to the derivatives `held`.
fn read_columns(
    range: &Range<Data>,
    (sheet, prefix): (&str, &str),
    held: &[Derivative],
    convention: &Convention,
) -> Result<BTreeMap<Derivative, Vec<f64>>> {
    let titles = titles(range);
    let column = |d: Derivative| {
        let name = convention.notation.name_of(d);
        let at = column_of(&titles, prefix, name).ok_or_else(|| {
            let place = format!("sheet {sheet}, first row");
            Error::input(
                place,
                format!("a column `{prefix}{name}`"),
                format!("`{}`", titles.join("`, `")),
            )
        })?;
        (1..range.height())
            .map(|row| number(range, sheet, row, at))
            .collect::<Result<Vec<f64>>>()
            .map(|numbers| (d, numbers))
    };
    held.iter().copied().map(column).collect()
}

fn number(range: &Range<Data>, sheet: &str, row: usize, column: usize) -> Result<f64> {
    let found = match range.get((row, column)) {
        Some(Data::Float(x)) => return Ok(*x),
        #[expect(
            clippy::cast_precision_loss,
            reason = "no measured figure has 16 digits before the point"
        )]
        Some(Data::Int(x)) => return Ok(*x as f64),
        None | Some(Data::Empty) => "an empty cell".to_owned(),
        Some(other) => format!("`{other}`"),
    };
    let (first_row, first_column) = range.start().unwrap_or_default();
    let letter = column_letters(first_column as usize + column);
    let place = format!(
        "sheet {sheet}, cell {letter}{}",
        first_row as usize + row + 1
    );
    Err(Error::input(place, "a number", found))
}

/// `A` … `Z`, `AA` … for a column counted from 0.
fn column_letters(mut column: usize) -> String {
    let mut letters = Vec::new();
    loop {
        letters.insert(0, char::from(b'A' + (column % 26) as u8));
        if column < 26 {
            return letters.into_iter().collect();
        }
        column = column / 26 - 1;
    }
}

fn table_from(path: &Path, options: &WorkbookOptions, points: Points) -> Result<DerivativeTable> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name = options.name.clone().unwrap_or_else(|| {
        let bare = stem.trim_start_matches("AerodynamicDerivatives_");
        bare.replace('_', "-")
    });
    let mut header = options.header.clone();
    if header.source.is_empty() {
        header.source = format!("workbook {stem}.xlsx");
    }
    if header.generator.is_empty() {
        header.generator = concat!("aerodeck ", env!("CARGO_PKG_VERSION")).to_owned();
    }
    // Impossible points are found by the table's own check; the width is asked of possible ones only.
    let mut table = DerivativeTable::new(name, 1.0, header, points)?;
    table.width_m = match options.width_m {
        Some(width) => positive("width_m", width)?,
        None => width_from_frequencies(&table, &options.frequencies_hz)?,
    };
    Ok(table)
}

/// `B = V/(2πf V̂)`: the median over all points, all of which must agree.
fn width_from_frequencies(table: &DerivativeTable, frequencies_hz: &[f64]) -> Result<f64> {
    let mut widths = Vec::new();
    for derivative in table.derivatives() {
        let points = table.points(derivative);
        if frequencies_hz.is_empty() || !points.len().is_multiple_of(frequencies_hz.len()) {
            let expected = format!(
                "{} test points a speed, one a frequency (or the width stated)",
                frequencies_hz.len()
            );
            return Err(Error::input(
                derivative.name(),
                expected,
                points.len().to_string(),
            ));
        }
        for (p, f) in points.iter().zip(frequencies_hz.iter().cycle()) {
            let speed = p.mean_speed_m_s.unwrap_or(f64::NAN);
            widths.push(speed / (TAU * f * p.v_hat));
        }
    }
    widths.sort_by(f64::total_cmp);
    let median = widths[widths.len() / 2];
    let (low, high) = (widths[0], widths[widths.len() - 1]);
    if low > median * (1.0 - WIDTH_TOLERANCE) && high < median * (1.0 + WIDTH_TOLERANCE) {
        return Ok(median);
    }
    Err(Error::input(
        "width B = V/(2πf V̂)",
        format!(
            "one width from all points at the frequencies {frequencies_hz:?} Hz (or the width or other frequencies stated)"
        ),
        format!("{low:.4} m to {high:.4} m"),
    ))
}

#[cfg(test)]
#[path = "workbook_tests.rs"]
mod tests;
