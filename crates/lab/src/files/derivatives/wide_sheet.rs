//! Sheets with one row per reduced velocity and one column per derivative, as most workbooks of laboratories and papers have them: read
//! as the same table in text ([`super::csv_wide`]), each row on the line that it has in the sheet.
//!
//! Titles, units and merged cells may stand above the row of names, which is the first with two derivatives in it; a row without numbers
//! under it (units) is passed over. Which sheet is meant needs to be said only where several hold such a row.

use super::csv_header::ReadOptions;
use super::csv_wide::{self, plain_name};
use super::workbook::{convention_in, notes_of, number_in};
use super::xlsx_cells::{DATE, OpenWorkbook, Sheet, cell_name, sheet_of};
use crate::aerodynamics::derivatives::DerivativeTable;
use crate::aerodynamics::derivatives::notation::{Convention, Notation};
use crate::error::{Error, Result, ensure, positive};
use crate::files::lab::Attribute;
use calamine::Reader;

/// The row of names as it may stand in a sheet.
const EXAMPLE: &str = "a row of names such as `V*`, `H1*`, `H2*`, …, `A4*` above the numbers";

/// The table of the sheet that is named, or of the only one that holds derivatives.
///
/// # Errors
/// [`Error::Input`] with sheet and row.
pub(super) fn read(
    book: &mut OpenWorkbook,
    sheet: Option<&str>,
    stem: &str,
    options: &ReadOptions,
) -> Result<(DerivativeTable, Convention)> {
    let stated = options.convention.notation;
    let (name, cells, names) = chosen(book, sheet, stated)?;
    let notes = notes_of(book)?;
    let convention = options.convention.and_file(convention_in(&notes)?)?;
    let width = number_in(&notes, "width_m")?;
    let width_m = options.width_m.or(width).map(|w| positive("width_m", w));
    let options = ReadOptions {
        convention,
        width_m: width_m.transpose()?,
        missing: options.missing,
        ..ReadOptions::default()
    };
    let stem = match book.sheet_names().len() {
        1 => stem.to_owned(),
        _ => format!("{stem}, {name}"),
    };
    let read = || {
        refuse_two_marks(&cells, names)?;
        csv_wide::parse(&text_of(&cells, names), &stem, &options)
    };
    read().map_err(|e| e.within(format!("sheet {name}")))
}

/// Name, cells and row of names of the sheet that is meant.
fn chosen(
    book: &mut OpenWorkbook,
    wanted: Option<&str>,
    notation: Option<Notation>,
) -> Result<(String, Sheet, u32)> {
    let names = book.sheet_names();
    let mut found = Vec::new();
    for name in &names {
        if wanted.is_some_and(|w| !name.trim().eq_ignore_ascii_case(w.trim())) {
            continue;
        }
        let cells = sheet_of(book, name.trim())?.unwrap_or_default();
        let row = row_of_names(&cells, notation);
        match row {
            Some(row) => found.push((name.clone(), cells, row)),
            None if wanted.is_some() => {
                let found = format!("{} in its first row", cells.title_words());
                return Err(Error::input(format!("sheet {name}"), EXAMPLE, found));
            }
            None => {}
        }
    }
    let several: Vec<&str> = found.iter().map(|(name, ..)| name.as_str()).collect();
    let expected =
        "the sheet that is meant, as `--sheet` or behind the name of the file (`table.xlsx#SHEET`)";
    let several_of = format_args!("derivatives in `{}`", several.join("`, `"));
    ensure(several.len() <= 1, "workbook", expected, several_of)?;
    found.pop().ok_or_else(|| {
        let all = format!("`{}`", names.join("`, `"));
        let (expected, found) = match wanted {
            Some(sheet) => (format!("a sheet `{sheet}`"), all),
            None => (
                format!("a sheet with {EXAMPLE} (or the three sheets of NTNU's workbooks)"),
                format!("the sheets {all} without"),
            ),
        };
        Error::input("workbook", expected, found)
    })
}

/// The first row with two derivatives in it, of the notation that is stated or of any.
fn row_of_names(sheet: &Sheet, notation: Option<Notation>) -> Option<u32> {
    let notations: Vec<Notation> = notation.map_or_else(|| Notation::ALL.to_vec(), |n| vec![n]);
    let is_named = |text: &str| {
        notations
            .iter()
            .any(|n| n.derivative(&plain_name(text, *n)).is_ok())
    };
    let mut row_and_count = (0, 0);
    for ((row, _), cell) in &sheet.cells {
        if *row != row_and_count.0 {
            row_and_count = (*row, 0);
        }
        if matches!(cell, Attribute::Text(text) if is_named(text)) {
            row_and_count.1 += 1;
        }
        if row_and_count.1 == 2 {
            return Some(*row);
        }
    }
    None
}

/// Refuses numbers in texts of which some have commas and some have points: `1,029` beside `0.1234` is a thousand.
fn refuse_two_marks(sheet: &Sheet, names: u32) -> Result<()> {
    let first = |mark: char| {
        let mut below = sheet.cells.range((names + 1, 0)..);
        below.find_map(|((row, column), cell)| match cell {
            Attribute::Text(text) if text.contains(mark) && is_number(&cell_text(cell)) => {
                Some((cell_name(*row, *column), text))
            }
            _ => None,
        })
    };
    match (first(','), first('.')) {
        (Some((comma, number)), Some((point, other))) => {
            let expected = format!("a point in the number, as in `{other}` of cell {point}");
            let found = format!("`{number}`");
            Err(Error::input(format!("cell {comma}"), expected, found))
        }
        _ => Ok(()),
    }
}

/// The row of names and those below it as text, with a tab between cells; what stands above is left empty.
fn text_of(sheet: &Sheet, names: u32) -> String {
    let named = sheet.cells.range((names, 0)..=(names, u32::MAX));
    let columns: Vec<u32> = named.map(|((_, column), _)| *column).collect();
    let last = sheet.last_row(&columns);
    let mut text = "\n".repeat(names as usize);
    for row in names..=last {
        let cell = |c: &u32| sheet.cells.get(&(row, *c)).map(cell_text);
        let cells = columns.iter().map(|c| cell(c).unwrap_or_default());
        let cells: Vec<String> = cells.collect();
        let numbers = cells.iter().any(|c| is_number(c) || c == DATE);
        if row == names || row > names + 1 || numbers {
            text.push_str(&cells.join("\t"));
        }
        text.push('\n');
    }
    text
}

fn is_number(text: &str) -> bool {
    text.parse::<f64>().is_ok()
}

/// A cell in a row of text: a number that was typed with a comma is one.
fn cell_text(cell: &Attribute) -> String {
    let text = cell.text().replace(['\t', '\n', '\r', ';'], " ");
    let number = text.trim().replace(',', ".");
    if is_number(&number) { number } else { text }
}

#[cfg(test)]
mod tests;
