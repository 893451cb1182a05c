//! Tables of derivatives: header-CSV, wide CSV, NTNU workbooks, and the measured decks that come with the program.

mod csv_file;
mod csv_header;
mod csv_wide;
pub mod embedded;
mod workbook;
mod workbook_writer;
mod xlsx_cells;

pub use csv_file::write_points;
pub(crate) use csv_file::{parse_csv, read_csv_with};
pub use csv_file::{parse_csv_in, read_csv, write_csv, write_csv_in};
pub use csv_header::{ReadOptions, TableInConvention};
pub use workbook::TABLE_3_2_FREQUENCIES_HZ;
pub use workbook::WIDTH_ASSUMED;
pub(crate) use workbook::read_workbook_in;
pub use workbook::{WorkbookOptions, read_workbook};
pub use workbook_writer::workbook_bytes;
pub use workbook_writer::workbook_bytes_in;

use crate::aerodynamics::derivatives::DerivativeTable;
use crate::aerodynamics::derivatives::notation::StatedConvention;
use crate::error::{Error, Result};
use std::path::Path;

/// Whether `name` means a file that holds a table, not an embedded deck: it ends in `.csv` or `.xlsx`.
pub fn is_table_file(name: &str) -> bool {
    let name = name.to_lowercase();
    name.ends_with(".csv") || name.ends_with(".xlsx")
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
    if is_table_file(name) {
        read_table(directory.join(name))
    } else {
        embedded::deck(name)
    }
}

/// A table as a file of settings names it, with what that says of its convention.
#[derive(Debug, Clone, Copy)]
pub struct TableWords<'a> {
    /// An embedded deck, or a file.
    pub name: &'a str,
    /// Against which the path of a file is read.
    pub directory: &'a Path,
    /// As far as a file does not state it itself; nothing for a deck, whose convention is known.
    pub convention: StatedConvention,
}

impl TableWords<'_> {
    /// The table; `place` is the key of the convention.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Input`] for a table that is wrong, or contradicted.
    pub fn read(&self, place: &str) -> Result<DerivativeTable> {
        if is_table_file(self.name) {
            let options = ReadOptions {
                convention: self.convention,
                ..ReadOptions::default()
            };
            return Ok(read_table_with(self.directory.join(self.name), &options)?.table);
        }
        if !self.convention.is_empty() {
            return Err(Error::input(
                place,
                "a table in a file (.csv, .xlsx)",
                format!("`{}`, whose convention is known", self.name),
            ));
        }
        embedded::deck(self.name)
    }
}

/// Reads a table from `path`: an NTNU workbook when the name ends in `.xlsx`, else a CSV.
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_lab::*; }
/// use aerodeck::files::derivatives::{embedded, read_table, write_csv};
///
/// let folder = tempfile::tempdir().map_err(|e| aerodeck::Error::io("temporary folder", e))?;
/// let file = folder.path().join("deck.csv");
/// let deck = embedded::deck("LN21-5200")?;
/// let mut text = Vec::new();
/// write_csv(&deck, &mut text).expect("memory");
/// std::fs::write(&file, text).map_err(|e| aerodeck::Error::io(&file, e))?;
/// assert_eq!(read_table(&file)?.width_m, deck.width_m);
/// # Ok::<(), aerodeck::Error>(())
/// ```
pub fn read_table(path: impl AsRef<Path>) -> Result<DerivativeTable> {
    read_table_with(path, &ReadOptions::default()).map(|read| read.table)
}

/// The same with what the caller states.
///
/// # Errors
/// [`Error::Io`]; [`Error::Input`] with file and place, also where the caller contradicts the file.
pub fn read_table_with(path: impl AsRef<Path>, options: &ReadOptions) -> Result<TableInConvention> {
    let path = path.as_ref();
    let is_workbook = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("xlsx"));
    if !is_workbook {
        return read_csv_with(path, options);
    }
    let options = WorkbookOptions {
        width_m: options.width_m,
        convention: options.convention,
        frequencies_hz: options.frequencies_hz.clone(),
        missing: options.missing,
        ..WorkbookOptions::default()
    };
    read_workbook_in(path, &options)
}
