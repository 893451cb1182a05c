//! Tables of derivatives: header-CSV, wide CSV, workbooks, and the measured decks that come with the program.

mod csv_file;
mod csv_header;
mod csv_wide;
pub mod embedded;
mod stated_convention;
mod wide_sheet;
mod workbook;
mod workbook_writer;
mod xlsx_cells;

pub(crate) use csv_file::{parse_csv, read_csv_with};
pub use csv_file::{parse_csv_in, write_csv, write_csv_in, write_points};
pub use csv_header::{ReadOptions, WIDTH_ASSUMED};
pub use stated_convention::{StatedConvention, state_angle};
pub use workbook::TABLE_3_2_FREQUENCIES_HZ;
pub use workbook_writer::{template_bytes, workbook_bytes_in};

use crate::aerodynamics::derivatives::DerivativeTable;
use crate::aerodynamics::derivatives::notation::Convention;
use crate::error::{Error, Result, ensure};
use crate::files::lab::guarded;
use std::path::Path;

/// Endings of workbooks.
const WORKBOOKS: [&str; 3] = [".xlsx", ".xls", ".ods"];

/// Whether `name` means a file that holds a table, not an embedded deck: it ends in `.csv`, `.xlsx`, `.xls` or `.ods`, or names a sheet
/// behind a workbook (`table.xlsx#SHEET`).
pub fn is_table_file(name: &str) -> bool {
    let file = file_and_sheet(name).0.to_lowercase();
    file.ends_with(".csv") || is_workbook(&file)
}

fn is_workbook(file: &str) -> bool {
    let file = file.to_lowercase();
    WORKBOOKS.iter().any(|ending| file.ends_with(ending))
}

/// The file and the sheet of a name such as `table.xlsx#SHEET`.
pub fn file_and_sheet(name: &str) -> (&str, Option<&str>) {
    match name.rsplit_once('#') {
        Some((file, sheet)) if is_workbook(file) && !sheet.is_empty() => (file, Some(sheet)),
        _ => (name, None),
    }
}

/// A workbook with the sheet that is meant, as [`file_and_sheet`] takes them apart.
pub fn named_sheet(file: &str, sheet: Option<&str>) -> String {
    sheet.map_or_else(|| file.to_owned(), |sheet| format!("{file}#{sheet}"))
}

/// The table of that name: an embedded deck, or a file whose path is read against `directory`.
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_lab::*; }
/// use aerodeck::aerodynamics::derivatives::Derivative;
/// use aerodeck::files::derivatives::named_table;
///
/// let deck = named_table("LN21-5200", "".as_ref())?;
/// assert!(deck.points(Derivative::A1).iter().all(|p| p.value < 0.0));
/// assert!(named_table("no deck", "".as_ref()).is_err());
/// # Ok::<(), aerodeck::Error>(())
/// ```
pub fn named_table(name: &str, directory: &Path) -> Result<DerivativeTable> {
    named_table_in(name, directory, StatedConvention::default(), "")
}

/// A table as a file of settings names it, with what that says of the convention, as far as a file does not state it itself:
/// nothing for a deck, whose convention is known. `place` is the key of the convention.
///
/// # Errors
/// [`Error::Io`]; [`Error::Input`] for a table that is wrong, or contradicted.
pub fn named_table_in(
    name: &str,
    directory: &Path,
    convention: StatedConvention,
    place: &str,
) -> Result<DerivativeTable> {
    if is_table_file(name) {
        let options = ReadOptions {
            convention,
            ..ReadOptions::default()
        };
        return read_table_with(directory.join(name), &options).map(|(table, _)| table);
    }
    let expected = "a table in a file (.csv, .xlsx, .xls, .ods)";
    let found = format_args!("`{name}`, whose convention is known");
    ensure(convention.is_empty(), place, expected, found)?;
    embedded::deck_where_files_are_taken(name)
}

/// Reads a table from `path`: a workbook when the name ends so (`table.xlsx#SHEET` names a sheet of it), else a CSV. `options` are what the
/// caller states; beside the table is the convention that the file is in. A workbook is in the layout of NTNU, or has one row
/// per reduced velocity: where a sheet is named, or where the three sheets of that layout are not there.
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_lab::*; }
/// use aerodeck::files::derivatives::{ReadOptions, embedded, read_table_with, write_csv};
///
/// let folder = tempfile::tempdir().map_err(|e| aerodeck::Error::io("temporary folder", e))?;
/// let file = folder.path().join("deck.csv");
/// let deck = embedded::deck("LN21-5200")?;
/// let mut text = Vec::new();
/// write_csv(&deck, &mut text).map_err(|e| aerodeck::Error::io(&file, e))?;
/// std::fs::write(&file, text).map_err(|e| aerodeck::Error::io(&file, e))?;
/// let (table, _) = read_table_with(&file, &ReadOptions::default())?;
/// assert_eq!(table.width_m, deck.width_m);
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// # Errors
/// [`Error::Io`]; [`Error::Input`] with file and place, also where the caller contradicts the file: of a workbook with sheet and cell
/// for one that is none, a missing sheet or column, an empty cell or text in place of a number, sheets of unequal length, no common
/// width, points out of order or twice.
pub fn read_table_with(
    path: impl AsRef<Path>,
    options: &ReadOptions,
) -> Result<(DerivativeTable, Convention)> {
    let path = path.as_ref();
    let name = path.to_string_lossy();
    let (file, sheet) = match path.exists() {
        true => (&*name, None),
        false => file_and_sheet(&name),
    };
    if !is_workbook(file) {
        return read_csv_with(path, options);
    }
    let path = Path::new(file);
    let read = || {
        let mut book = xlsx_cells::open(path)?;
        if sheet.is_none() && workbook::has_three_sheets(&book) {
            return workbook::read_three_sheets(&mut book, path, options);
        }
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        wide_sheet::read(&mut book, sheet, &stem, options)
    };
    let damaged = || Err(xlsx_cells::no_workbook(&"a part that cannot be read"));
    let read = guarded(read).unwrap_or_else(damaged);
    read.map_err(|e: Error| e.in_file(path))
}
