//! Cells of a workbook, read one by one and within bounds: a workbook of a few kilobytes can unpack to gigabytes or name
//! a cell whose dense range fills the memory.

use crate::error::{Error, Result};
use calamine::{DataRef, Reader, Xlsx, open_workbook};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Parts of a workbook, unpacked bytes of one part and of all: a hundred times what a study with 18 derivatives needs.
const PARTS_AT_MOST: usize = 1000;
const PART_BYTES_AT_MOST: u64 = 64 << 20;
const BYTES_AT_MOST: u64 = 256 << 20;
/// Cells with a content in one sheet: 18 derivatives at more than ten thousand points.
const CELLS_AT_MOST: usize = 200_000;

/// The content of a cell.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum CellContent {
    Number(f64),
    Text(String),
}

impl CellContent {
    /// The content as text.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Number(x) => x.to_string(),
            Self::Text(text) => text.clone(),
        }
    }
}

/// The cells of a sheet that hold something, by row and column from 0.
#[derive(Debug, Clone, Default)]
pub(super) struct Sheet {
    pub cells: BTreeMap<(u32, u32), CellContent>,
}

impl Sheet {
    /// First row with a content.
    pub(crate) fn first_row(&self) -> u32 {
        self.cells.keys().next().map_or(0, |(row, _)| *row)
    }

    /// Column and text of each cell in the first row.
    pub(crate) fn titles(&self) -> Vec<(u32, String)> {
        let first = self.first_row();
        self.cells
            .range((first, 0)..=(first, u32::MAX))
            .map(|((_, column), cell)| (*column, cell.text()))
            .collect()
    }

    /// The titles in words.
    pub(crate) fn title_words(&self) -> String {
        let titles: Vec<String> = self.titles().into_iter().map(|t| t.1).collect();
        format!("`{}`", titles.join("`, `"))
    }

    /// The last row in which one of `columns` holds something.
    pub(crate) fn last_row(&self, columns: &[u32]) -> u32 {
        let rows = self.cells.keys().filter(|(_, c)| columns.contains(c));
        rows.map(|(row, _)| *row).max().unwrap_or(0)
    }
}

/// A workbook that has been checked to fit into memory.
pub(super) struct CheckedWorkbook {
    book: Xlsx<BufReader<File>>,
}

impl CheckedWorkbook {
    /// Opens a workbook.
    ///
    /// # Errors
    /// [`Error::Io`] for a file that is not there; [`Error::Input`] for one that is no workbook or unpacks to more than any
    /// table of derivatives needs.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let file = File::open(path).map_err(|e| Error::io(path, e))?;
        check_size(file)?;
        let book = open_workbook(path).map_err(|e: calamine::XlsxError| no_workbook(&e))?;
        Ok(Self { book })
    }

    /// Names of the sheets.
    pub(crate) fn names(&self) -> Vec<String> {
        self.book.sheet_names()
    }

    /// The sheet of this name, whose capitals do not count; `None` when there is none.
    pub(crate) fn sheet(&mut self, wanted: &str) -> Result<Option<Sheet>> {
        let names = self.book.sheet_names();
        let found = names.iter().find(|n| n.trim().eq_ignore_ascii_case(wanted));
        let Some(name) = found else { return Ok(None) };
        let place = || format!("sheet {wanted}");
        let unreadable =
            |e: calamine::XlsxError| Error::input(place(), "readable cells", e.to_string());
        let mut reader = self.book.worksheet_cells_reader(name).map_err(unreadable)?;
        let mut sheet = Sheet::default();
        while let Some(cell) = reader.next_cell().map_err(unreadable)? {
            let content = match cell.get_value() {
                DataRef::Empty => continue,
                DataRef::Float(x) => CellContent::Number(*x),
                #[expect(
                    clippy::cast_precision_loss,
                    reason = "no measured figure has 16 digits before the point"
                )]
                DataRef::Int(x) => CellContent::Number(*x as f64),
                DataRef::String(text) => CellContent::Text(text.clone()),
                DataRef::SharedString(text) => CellContent::Text((*text).to_owned()),
                other => CellContent::Text(calamine::Data::from(other.clone()).to_string()),
            };
            if matches!(&content, CellContent::Text(text) if text.trim().is_empty()) {
                continue;
            }
            sheet.cells.insert(cell.get_position(), content);
            if sheet.cells.len() > CELLS_AT_MOST {
                let expected = format!("at most {CELLS_AT_MOST} cells with a content");
                return Err(Error::input(place(), expected, "more"));
            }
        }
        Ok(Some(sheet))
    }
}

fn no_workbook(error: &dyn std::fmt::Display) -> Error {
    Error::input("", "an .xlsx workbook", error.to_string())
}

/// Unpacks every part into nothing, up to the bounds: what the directory of the file says about sizes may be wrong.
fn check_size(file: File) -> Result<()> {
    let mut archive = zip::ZipArchive::new(BufReader::new(file)).map_err(|e| no_workbook(&e))?;
    if archive.len() > PARTS_AT_MOST {
        let found = archive.len().to_string();
        let expected = format!("a workbook of at most {PARTS_AT_MOST} parts");
        return Err(Error::input("", expected, found));
    }
    let mut total = 0;
    for i in 0..archive.len() {
        let part = archive.by_index(i).map_err(|e| no_workbook(&e))?;
        let name = part.name().map_err(|e| no_workbook(&e))?.into_owned();
        let bytes = std::io::copy(&mut part.take(PART_BYTES_AT_MOST + 1), &mut std::io::sink())
            .map_err(|e| no_workbook(&e))?;
        total += bytes;
        if bytes > PART_BYTES_AT_MOST || total > BYTES_AT_MOST {
            let expected = format!(
                "parts of at most {} MiB, {} MiB in all, when unpacked",
                PART_BYTES_AT_MOST >> 20,
                BYTES_AT_MOST >> 20
            );
            return Err(Error::input(format!("part {name}"), expected, "more"));
        }
    }
    Ok(())
}
