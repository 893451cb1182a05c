//! Workbooks of derivatives as NTNU keeps them (.xlsx).
//!
//! Three sheets, `Mean wind velocity`, `Reduced Velocities`, `Aerodynamic Derivatives`, in any order; in each a
//! row of names and below it one row per test point; one column per derivative, named `MeanWind_H1`, `Vred_H1`, `H1`, or
//! in all sheets `H1` or `H_1` as the laboratory's own package writes them, with a column of row numbers that is not looked
//! at. Derivatives of sway may be left out, in all three sheets alike, likewise H4, A4 ([`super::Missing`]).
//! Every derivative has its own `V̂ = V/(ωB)`. The width is that of a sheet `Dim section model` (names `D`, `B`, `L` over
//! values in m) or of the notes; else it follows from the frequencies, `B = V/(2πf V̂)`; else 1 m is assumed, with a note:
//! only the frequencies of virtual records depend on it. NTNU's workbooks do not state their convention, which is that of this project
//! ([`super::SIGN_CONVENTION`]). Any other is stated by the reader or by a sheet `Notes` (keys `notation`, `argument`,
//! `axes` beside their values); the columns are then called as in that notation (`MeanWind_h1`, `Vred_h1`, `h1`),
//! whatever the sheet `Reduced Velocities` holds.

use crate::aerodynamics::derivatives::notation::{Convention, ExpressedPoint};
use crate::aerodynamics::derivatives::table::check_point_count;
use crate::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable, TableHeader};
use crate::error::{Error, Result, ensure, positive};
use crate::files::derivatives::StatedConvention;
use crate::files::derivatives::csv_header::{ReadOptions, WIDTH_ASSUMED, fill_in};
use crate::files::derivatives::xlsx_cells::{OpenWorkbook, Sheet, cell_name, sheet_of};
use crate::files::header_csv;
use crate::files::lab::Attribute;
use calamine::Reader;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;

/// Frequencies of the tests, Hz, in test order at each speed (Table 3.2 of the thesis).
pub const TABLE_3_2_FREQUENCIES_HZ: [f64; 8] = [0.25, 0.5, 0.8, 1.1, 1.4, 1.7, 2.0, 2.5];

/// Name of the sheet of notes.
pub(super) const NOTES: &str = "Notes";
/// Key in it of what the measurements contradict, one to a line.
pub(super) const DOUBTS: &str = "doubts";

/// Name of the sheet of dimensions that the laboratory's own package writes.
const DIMENSIONS: &str = "Dim section model";

/// The same width must follow from every point to within this fraction.
const WIDTH_TOLERANCE: f64 = 0.01;

/// Kind of sheet: its name and what its column names begin with.
pub(super) const SPEEDS: (&str, &str) = ("Mean wind velocity", "MeanWind_");
pub(super) const REDUCED_VELOCITIES: (&str, &str) = ("Reduced Velocities", "Vred_");
pub(super) const DERIVATIVES: (&str, &str) = ("Aerodynamic Derivatives", "");
const KINDS: [(&str, &str); 3] = [SPEEDS, REDUCED_VELOCITIES, DERIVATIVES];

/// Whether the workbook is to be read by the three sheets of NTNU's.
pub(super) fn has_three_sheets(book: &OpenWorkbook) -> bool {
    let names = book.sheet_names();
    let named = |kind: &str| names.iter().any(|n| n.trim().eq_ignore_ascii_case(kind));
    KINDS.iter().any(|(kind, _)| named(kind))
}

/// Reads the three sheets of an opened workbook.
pub(super) fn read_three_sheets(
    book: &mut OpenWorkbook,
    path: &Path,
    options: &ReadOptions,
) -> Result<(DerivativeTable, Convention)> {
    let notes = notes_of(book)?;
    let convention = convention_of(options.convention, &notes)?;
    let mut points = read_sheets(book, &convention)?;
    let mut header = options.header.clone();
    header.notes.extend(fill_in(&mut points, options.missing));
    let doubts = notes.get(DOUBTS).into_iter().flat_map(|d| d.lines());
    header.doubts.extend(doubts.map(str::to_owned));
    let stated = width_in_book(book, &notes)?;
    Ok((
        table_from(path, options, header, points, stated)?,
        convention,
    ))
}

/// Keys and values of the sheet `Notes`, the first two columns.
type Notes = BTreeMap<String, String>;

/// The sheet `Notes`; nothing where there is none.
pub(super) fn notes_of(book: &mut OpenWorkbook) -> Result<Notes> {
    let sheet = sheet_of(book, NOTES)?.unwrap_or_default();
    let cell = |row: u32, column: u32| sheet.cells.get(&(row, column)).map(Attribute::text);
    let rows = sheet.cells.keys().filter(|(_, column)| *column == 0);
    let pairs = rows.filter_map(|(row, _)| Some((cell(*row, 0)?, cell(*row, 1)?)));
    Ok(pairs.collect())
}

/// What the notes say of the convention.
pub(super) fn convention_in(notes: &Notes) -> Result<StatedConvention> {
    Ok(StatedConvention {
        notation: parse_note(notes, "notation")?,
        argument: parse_note(notes, "argument")?,
        axes: parse_note(notes, "axes")?,
    })
}

/// A number of the notes.
pub(super) fn number_in(notes: &Notes, key: &str) -> Result<Option<f64>> {
    let place = format_args!("sheet {NOTES}, {key}");
    let parse = |text: &String| header_csv::number(place, text);
    notes.get(key).map(parse).transpose()
}

/// The width that the workbook states, m, and where.
fn width_in_book(book: &mut OpenWorkbook, notes: &Notes) -> Result<Option<(f64, String)>> {
    if let Some(sheet) = sheet_of(book, DIMENSIONS)? {
        let place = || format!("sheet {DIMENSIONS}, B");
        let column = sheet.titles().into_iter().find(|t| t.1.trim() == "B");
        if let Some((column, _)) = column {
            let width = number(&sheet, DIMENSIONS, sheet.first_row() + 1, column)?;
            return Ok(Some((positive(place(), width)?, place())));
        }
    }
    let place = format!("sheet {NOTES}, width_m");
    let width = number_in(notes, "width_m")?.map(|w| positive(&place, w));
    Ok(width.transpose()?.map(|w| (w, place)))
}

/// What the notes and the caller say of the convention; when neither says anything, it is NTNU's, this project's own.
fn convention_of(stated: StatedConvention, notes: &Notes) -> Result<Convention> {
    let mut file = convention_in(notes)?;
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

fn parse_note<T: std::str::FromStr<Err = Error>>(notes: &Notes, key: &str) -> Result<Option<T>> {
    let there = |e: Error| e.at(format!("sheet {NOTES}, {key}"));
    let parse = |text: &String| text.parse().map_err(there);
    notes.get(key).map(parse).transpose()
}

type Points = BTreeMap<Derivative, Vec<DerivativePoint>>;

fn read_sheets(book: &mut OpenWorkbook, convention: &Convention) -> Result<Points> {
    let mut sheets = Vec::new();
    for kind in KINDS {
        let sheet = sheet_of(book, kind.0)?.ok_or_else(|| {
            let expected = format!("a sheet `{}`", kind.0);
            let found = format!("`{}`", book.sheet_names().join("`, `"));
            Error::input("workbook", expected, found)
        });
        sheets.push((sheet?, kind));
    }
    // tests without sway have no columns for what it couples; a column in one sheet must be in all
    let names = |d| convention.notation.name_of(d);
    let is_given = |d: &Derivative| {
        let column = |(sheet, kind): &(Sheet, (&str, &str))| column_of(sheet, kind.1, names(*d));
        sheets.iter().any(|s| column(s).is_some())
    };
    let given: Vec<Derivative> = Derivative::ALL.into_iter().filter(is_given).collect();
    let place = format_args!("sheet {}, first row", DERIVATIVES.0);
    let expected = format_args!("columns named {}", convention.notation.names());
    let found = sheets[2].0.title_words();
    ensure(!given.is_empty(), place, expected, found)?;
    let columns = |i: usize| {
        let (sheet, (name, prefix)) = &sheets[i];
        read_columns(sheet, name, prefix, &given, convention)
    };
    let (speeds, arguments, values) = (columns(0)?, columns(1)?, columns(2)?);
    let points = given.iter().enumerate().map(|(i, &d)| {
        let (speeds, arguments, values) = (&speeds[i], &arguments[i], &values[i]);
        let (count, of) = (speeds.len(), SPEEDS.0);
        let expected = format_args!("{count} test points as in sheet {of}");
        for ((sheet, _), column) in [(REDUCED_VELOCITIES, arguments), (DERIVATIVES, values)] {
            let (place, found) = (format_args!("sheet {sheet}"), column.len());
            ensure(found == count, place, expected, found)?;
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

/// The column of the derivative of this name: with the prefix of the sheet, or bare, as `H1` or `H_1`. Capitals count in
/// the name: h1 and H1 are different numbers.
fn column_of(sheet: &Sheet, prefix: &str, name: &str) -> Option<u32> {
    let underscored = name
        .char_indices()
        .nth(1)
        .map(|(i, _)| format!("{}_{}", &name[..i], &name[i..]));
    let titles = sheet.titles();
    let named = |wanted: &str, ending: &str| {
        let same = |title: &str| {
            let title = title.trim().trim_end_matches('*');
            title.eq_ignore_ascii_case(wanted) && title.ends_with(ending)
        };
        titles.iter().find(|t| same(&t.1)).map(|t| t.0)
    };
    named(&format!("{prefix}{name}"), name)
        .or_else(|| named(name, name))
        .or_else(|| named(underscored.as_deref()?, underscored.as_deref()?))
}

/// The columns of one sheet that belong to the derivatives `given`.
fn read_columns(
    sheet: &Sheet,
    name: &str,
    prefix: &str,
    given: &[Derivative],
    convention: &Convention,
) -> Result<Vec<Vec<f64>>> {
    let column = |d: &Derivative| {
        let derivative = convention.notation.name_of(*d);
        column_of(sheet, prefix, derivative).ok_or_else(|| {
            let place = format!("sheet {name}, first row");
            let expected = format!("a column `{prefix}{derivative}`");
            Error::input(place, expected, sheet.title_words())
        })
    };
    let columns: Vec<u32> = given.iter().map(column).collect::<Result<_>>()?;
    let rows = sheet.first_row() + 1..sheet.last_row(&columns) + 1;
    check_point_count(format!("sheet {name}"), rows.len())?;
    let numbers = |column: &u32| {
        let rows = rows.clone();
        rows.map(|row| number(sheet, name, row, *column)).collect()
    };
    columns.iter().map(numbers).collect()
}

fn number(sheet: &Sheet, name: &str, row: u32, column: u32) -> Result<f64> {
    let found = match sheet.cells.get(&(row, column)) {
        Some(Attribute::Number(x)) => return Ok(*x),
        None => "an empty cell".to_owned(),
        Some(Attribute::Text(text)) => format!("`{text}`"),
    };
    let place = format!("sheet {name}, cell {}", cell_name(row, column));
    Err(Error::input(place, "a number", found))
}

fn table_from(
    path: &Path,
    options: &ReadOptions,
    mut header: TableHeader,
    points: Points,
    in_book: Option<(f64, String)>,
) -> Result<DerivativeTable> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let bare = stem.trim_start_matches("AerodynamicDerivatives_");
    let name = options.name.clone();
    let name = name.unwrap_or_else(|| bare.replace('_', "-"));
    if header.source.is_empty() {
        header.source = format!("workbook {stem}.xlsx");
    }
    if header.generator.is_empty() {
        header.generator = concat!("aerodeck ", env!("CARGO_PKG_VERSION")).to_owned();
    }
    // Impossible points are found by the table's own check; the width is asked of possible ones only.
    let mut table = DerivativeTable::new(name, 1.0, header, points)?;
    let derived = |frequencies| width_from_frequencies(&table, frequencies);
    let (width, note) = match (options.width_m, &options.frequencies_hz, in_book) {
        (Some(width), _, _) => (positive("width_m", width)?, None),
        (None, Some(frequencies), _) => (derived(frequencies)?, None),
        (None, None, Some((width, place))) => {
            (width, Some(format!("width {width} m from {place}")))
        }
        (None, None, None) => derived(&TABLE_3_2_FREQUENCIES_HZ).map_or_else(
            |e| (1.0, Some(format!("{WIDTH_ASSUMED}; {e}"))),
            |width| (width, None),
        ),
    };
    table.width_m = width;
    table.header.notes.extend(note);
    Ok(table)
}

/// `B = V/(2πf V̂)`: the median over all points, all of which must agree.
fn width_from_frequencies(table: &DerivativeTable, frequencies_hz: &[f64]) -> Result<f64> {
    let mut widths = Vec::new();
    for derivative in table.derivatives() {
        let points = table.points(derivative);
        let (count, found) = (frequencies_hz.len(), points.len());
        let expected =
            format_args!("{count} test points per speed, one per frequency (or the width stated)");
        let fits = count > 0 && found.is_multiple_of(count);
        ensure(fits, derivative.name(), expected, found)?;
        for (p, f) in points.iter().zip(frequencies_hz.iter().cycle()) {
            let speed = p.mean_speed_m_s.unwrap_or(f64::NAN);
            widths.push(speed / (TAU * f * p.v_hat));
        }
    }
    widths.sort_by(f64::total_cmp);
    let median = widths[widths.len() / 2];
    let (low, high) = (widths[0], widths[widths.len() - 1]);
    let is_one = low > median * (1.0 - WIDTH_TOLERANCE) && high < median * (1.0 + WIDTH_TOLERANCE);
    let expected = format_args!(
        "one width from all points at the frequencies {frequencies_hz:?} Hz (or the width or other frequencies stated)"
    );
    let found = format_args!("{low:.4} m to {high:.4} m");
    ensure(is_one, "width B = V/(2πf V̂)", expected, found).map(|()| median)
}

#[cfg(test)]
mod tests;
