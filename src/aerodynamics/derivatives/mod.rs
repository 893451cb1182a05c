//! Aerodynamic derivatives P*, H*, A*: what they are, tables of measured values, interpolation between them.
//!
//! `G_yy = K²(H4* + iH1*)`, `G_yθ = K²(H3* + iH2*)`, `G_θy = K²(A4* + iA1*)`, `G_θθ = K²(A3* + iA2*)`, likewise
//! `P*` and the pairs 5, 6 of `H*`, `A*` for sway (equation 1.17).

#[cfg(feature = "cli")]
pub(crate) mod comment_header;
#[cfg(feature = "cli")]
pub(in crate::aerodynamics) mod csv_file;
#[cfg(feature = "cli")]
mod csv_header;
#[cfg(feature = "cli")]
mod csv_wide;
mod derivative;
#[cfg(feature = "cli")]
pub mod embedded;
mod interpolated;
mod interpolation;
#[cfg(feature = "cli")]
mod missing;
#[cfg(feature = "cli")]
pub mod notation;
#[cfg(feature = "cli")]
mod plausibility;
mod table;
#[cfg(feature = "cli")]
mod workbook;
#[cfg(feature = "cli")]
mod workbook_writer;
#[cfg(feature = "cli")]
mod xlsx_cells;

#[cfg(feature = "cli")]
pub use csv_file::{
    CSV_COLUMNS, parse_csv, parse_csv_in, read_csv, read_csv_in, read_csv_with, write_csv,
    write_csv_in, write_points,
};
pub use derivative::{Derivative, Part};
pub use interpolated::{Extrapolation, InterpolatedTable};
pub use interpolation::Interpolation;
#[cfg(feature = "cli")]
pub use missing::Missing;
pub use table::{DerivativePoint, DerivativeTable, SIGN_CONVENTION, TableHeader, UNITS};
#[cfg(feature = "cli")]
pub use workbook::{TABLE_3_2_FREQUENCIES_HZ, WorkbookOptions, read_workbook, read_workbook_in};
#[cfg(feature = "cli")]
pub use workbook_writer::{workbook_bytes, workbook_bytes_in, write_workbook};

use crate::section::Dof;

/// One measured number of the transfer matrix: the real or imaginary part of one entry at its own `K`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransferSample {
    /// Force (row of `G`).
    pub force: Dof,
    /// Motion (column of `G`).
    pub motion: Dof,
    /// Real or imaginary.
    pub part: Part,
    /// Reduced frequency of the test point.
    pub k: crate::units::ReducedFrequency,
    /// The value of that part of `G` (not of the derivative: `K²` times it).
    pub value: f64,
    /// Mean wind speed of the test point, m/s; `None` for a source without speeds.
    pub mean_speed_m_s: Option<f64>,
}

/// Whether `name` means a file that holds a table, not an embedded deck: it ends in `.csv` or `.xlsx`.
#[cfg(feature = "cli")]
pub fn is_table_file(name: &str) -> bool {
    let name = name.to_lowercase();
    name.ends_with(".csv") || name.ends_with(".xlsx")
}

/// The table of that name: an embedded deck, or a file whose path is read against `directory`.
///
/// # Errors
/// Those of [`embedded::deck`] and [`read_table`].
#[cfg(feature = "cli")]
pub fn named_table(name: &str, directory: &std::path::Path) -> crate::Result<DerivativeTable> {
    if is_table_file(name) {
        read_table(directory.join(name))
    } else {
        embedded::deck(name)
    }
}

/// What a file of derivatives does not say of itself.
#[cfg(feature = "cli")]
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Notation, argument and axes; what the file states must not contradict them.
    pub convention: notation::StatedConvention,
    /// Width of the section model, m.
    pub width_m: Option<f64>,
    /// Frequencies of motion of a workbook in test order, Hz, from which its width follows.
    pub frequencies_hz: Option<Vec<f64>>,
    /// What stands for H4*, A4* when there are none; zero when nothing is stated.
    pub missing: Option<Missing>,
}

/// Reads a table from `path`: an NTNU workbook when the name ends in `.xlsx`, else a CSV.
///
/// # Errors
/// Those of [`read_workbook`] and [`read_csv`].
#[cfg(feature = "cli")]
pub fn read_table(path: impl AsRef<std::path::Path>) -> crate::Result<DerivativeTable> {
    read_table_with(path, &ReadOptions::default()).map(|(table, _)| table)
}

/// The same with what the caller states about the convention of the file; the second value is the one the file is in.
///
/// # Errors
/// Those of [`read_workbook`] and [`read_csv_with`].
#[cfg(feature = "cli")]
pub fn read_table_in(
    path: impl AsRef<std::path::Path>,
    stated: notation::StatedConvention,
) -> crate::Result<(DerivativeTable, notation::Convention)> {
    let options = ReadOptions {
        convention: stated,
        ..ReadOptions::default()
    };
    read_table_with(path, &options)
}

/// The same with all that can be stated.
///
/// # Errors
/// Those of [`read_workbook`] and [`read_csv_with`].
#[cfg(feature = "cli")]
pub fn read_table_with(
    path: impl AsRef<std::path::Path>,
    options: &ReadOptions,
) -> crate::Result<(DerivativeTable, notation::Convention)> {
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
