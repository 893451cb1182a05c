//! Cells of a workbook, read one by one and within bounds: a workbook of a few kilobytes can unpack to gigabytes or name
//! a cell whose dense range fills the memory.

use crate::error::{Error, Result, ensure};
use crate::files::lab::Attribute;
use crate::files::text::check_mebibytes;
use calamine::{Data, Reader, Sheets, Xlsx, XlsxError, open_workbook_auto};
use std::collections::{BTreeMap, HashSet};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Parts of a workbook, unpacked bytes of one part and of all: a hundred times what a study with 18 derivatives needs.
const PARTS_AT_MOST: usize = 1000;
const PART_BYTES_AT_MOST: u64 = 64 << 20;
const BYTES_AT_MOST: u64 = 256 << 20;
/// Bytes of a workbook in the old format, which is not packed.
const OLD_BYTES_AT_MOST: u64 = 64 << 20;
/// Where the header of such a workbook lists the sectors that hold the chains, and how many it has room for.
const FIRST_LISTED: usize = 76;
const LISTED_IN_HEADER: usize = 109;
/// Cells with a content in one sheet: 18 derivatives at more than ten thousand points.
const CELLS_AT_MOST: usize = 200_000;

/// What is read here.
const EXPECTED: &str = "a workbook (.xlsx, .xls, .ods)";
/// What a cell holds whose formula nobody evaluated: no number, so that it is refused where one is read, and no empty cell.
const NO_VALUE: &str = "a formula without a value: save the workbook once in a spreadsheet";
/// The same of a date, as of 1.3 that a spreadsheet took for the first of March.
pub(super) const DATE: &str = "a date";

/// The cells of a sheet that hold something, by row and column from 0.
#[derive(Debug, Clone, Default)]
pub(super) struct Sheet {
    pub cells: BTreeMap<(u32, u32), Attribute>,
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

    /// Adds a cell, unless it is empty.
    fn insert(
        &mut self,
        place: &dyn Fn() -> String,
        row: u32,
        column: u32,
        value: Data,
    ) -> Result<()> {
        let content = match value {
            Data::Empty => return Ok(()),
            Data::Float(x) => Attribute::Number(x),
            #[expect(
                clippy::cast_precision_loss,
                reason = "no measured figure has 16 digits before the point"
            )]
            Data::Int(x) => Attribute::Number(x as f64),
            Data::String(text) => Attribute::Text(text),
            Data::DateTime(_) | Data::DateTimeIso(_) | Data::DurationIso(_) => {
                Attribute::Text(DATE.to_owned())
            }
            other => Attribute::Text(other.to_string()),
        };
        if matches!(&content, Attribute::Text(text) if text.trim().is_empty()) {
            return Ok(());
        }
        self.cells.insert((row, column), content);
        let expected = format_args!("at most {CELLS_AT_MOST} cells with a content");
        let fits = self.cells.len() <= CELLS_AT_MOST;
        ensure(fits, "", expected, "more").map_err(|e| e.at(place()))
    }

    /// The last row in which one of `columns` holds something.
    pub(crate) fn last_row(&self, columns: &[u32]) -> u32 {
        let rows = self.cells.keys().filter(|(_, c)| columns.contains(c));
        rows.map(|(row, _)| *row).max().unwrap_or(0)
    }
}

/// A workbook that has been checked to fit into memory.
pub(super) type OpenWorkbook = Sheets<BufReader<File>>;

/// Opens a workbook.
///
/// # Errors
/// [`Error::Io`] for a file that is not there; [`Error::Input`] for one that is no workbook or unpacks to more than any
/// table of derivatives needs.
pub(super) fn open(path: &Path) -> Result<OpenWorkbook> {
    let file = File::open(path).map_err(|e| Error::io(path, e))?;
    let ending = path.extension().unwrap_or_default();
    if ending.eq_ignore_ascii_case("xls") {
        let size = file.metadata().map_err(|e| Error::io(path, e))?.len();
        check_mebibytes("a workbook", size, OLD_BYTES_AT_MOST)?;
        check_chains(&std::fs::read(path).map_err(|e| Error::io(path, e))?)?;
    } else {
        check_size(file)?;
    }
    open_workbook_auto(path).map_err(|e| no_workbook(&e))
}

/// The sheet of this name, whose capitals do not count; `None` when there is none.
pub(super) fn sheet_of(book: &mut OpenWorkbook, wanted: &str) -> Result<Option<Sheet>> {
    let names = book.sheet_names();
    let found = names.iter().find(|n| n.trim().eq_ignore_ascii_case(wanted));
    let Some(name) = found else { return Ok(None) };
    let place = || format!("sheet {wanted}");
    let mut sheet = Sheet::default();
    match book {
        Sheets::Xlsx(book) => read_xlsx(book, name, &place, &mut sheet)?,
        other => {
            let range = other.worksheet_range(name);
            let range =
                range.map_err(|e| Error::input(place(), "readable cells", e.to_string()))?;
            let (row, column) = range.start().unwrap_or_default();
            for (r, c, value) in range.used_cells() {
                let (row, column) = (row + index(r), column + index(c));
                sheet.insert(&place, row, column, value.clone())?;
            }
        }
    }
    Ok(Some(sheet))
}

/// The cells of a sheet one by one, then those of its formulas that nobody evaluated.
fn read_xlsx(
    book: &mut Xlsx<BufReader<File>>,
    name: &str,
    place: &dyn Fn() -> String,
    sheet: &mut Sheet,
) -> Result<()> {
    let unreadable = |e: XlsxError| Error::input(place(), "readable cells", e.to_string());
    let mut stored = HashSet::new();
    let mut reader = book.worksheet_cells_reader(name).map_err(unreadable)?;
    while let Some(cell) = reader.next_cell().map_err(unreadable)? {
        let (row, column) = cell.get_position();
        let value = Data::from(cell.get_value().clone());
        if value != Data::Empty {
            stored.insert((row, column));
        }
        sheet.insert(place, row, column, value)?;
    }
    drop(reader);
    let mut formulas = book.worksheet_cells_reader(name).map_err(unreadable)?;
    while let Some(formula) = formulas.next_formula().map_err(unreadable)? {
        let (row, column) = formula.get_position();
        if !formula.get_value().is_empty() && !stored.contains(&(row, column)) {
            sheet.insert(place, row, column, Data::String(NO_VALUE.to_owned()))?;
        }
    }
    Ok(())
}

/// The cell as spreadsheets name it, `C5`, for row and column counted from 0.
pub(super) fn cell_name(row: u32, mut column: u32) -> String {
    let mut letters = Vec::new();
    loop {
        letters.insert(0, char::from(b'A' + (column % 26) as u8));
        if column < 26 {
            return format!("{}{}", letters.into_iter().collect::<String>(), row + 1);
        }
        column = column / 26 - 1;
    }
}

/// Rows and columns of a sheet are numbered in 32 bits.
fn index(i: usize) -> u32 {
    u32::try_from(i).unwrap_or(u32::MAX)
}

pub(super) fn no_workbook(error: &dyn std::fmt::Display) -> Error {
    Error::input("", EXPECTED, error.to_string())
}

/// Refuses a workbook of the old format (\[MS-CFB\], section 2.3) in which the chain of a part runs in a circle: its reader would follow it until
/// the memory is full. The sectors of chains that a header has no room for, of files beyond 7 MB, are not looked at.
fn check_chains(bytes: &[u8]) -> Result<()> {
    let number = |at: usize| {
        let own = bytes.get(at..)?.first_chunk()?;
        usize::try_from(u32::from_le_bytes(*own)).ok()
    };
    // 512 bytes, or what the version of large files has
    let sector = if bytes.get(30) == Some(&12) {
        4096
    } else {
        512
    };
    let of_sector = |id: usize| (0..sector / 4).map(move |i| (id + 1) * sector + 4 * i);
    let listed = (0..LISTED_IN_HEADER).map_while(|i| number(FIRST_LISTED + 4 * i));
    let next = listed.filter(|id| *id <= bytes.len() / sector);
    let next: Vec<usize> = next.flat_map(of_sector).map_while(number).collect();
    let mut walked_from = vec![usize::MAX; next.len()];
    for start in 0..next.len() {
        let mut at = start;
        while let Some(from) = walked_from.get_mut(at).filter(|from| **from == usize::MAX) {
            *from = start;
            at = next[at];
        }
        let circle = walked_from.get(at) == Some(&start);
        ensure(!circle, "", EXPECTED, "a part that never ends")?;
    }
    Ok(())
}

/// Unpacks every part into nothing, up to the bounds: what the directory of the file says about sizes may be wrong.
fn check_size(file: File) -> Result<()> {
    let mut archive = zip::ZipArchive::new(BufReader::new(file)).map_err(|e| no_workbook(&e))?;
    let parts = archive.len();
    let expected = format_args!("a workbook of at most {PARTS_AT_MOST} parts");
    ensure(parts <= PARTS_AT_MOST, "", expected, parts)?;
    let mut total = 0;
    for i in 0..parts {
        let part = archive.by_index(i).map_err(|e| no_workbook(&e))?;
        let name = part.name().map_err(|e| no_workbook(&e))?.into_owned();
        let bytes = std::io::copy(&mut part.take(PART_BYTES_AT_MOST + 1), &mut std::io::sink())
            .map_err(|e| no_workbook(&e))?;
        total += bytes;
        let fits = bytes <= PART_BYTES_AT_MOST && total <= BYTES_AT_MOST;
        let (part, all) = (PART_BYTES_AT_MOST >> 20, BYTES_AT_MOST >> 20);
        let expected = format_args!("parts of at most {part} MiB, {all} MiB in all, when unpacked");
        ensure(fits, format_args!("part {name}"), expected, "more")?;
    }
    Ok(())
}
