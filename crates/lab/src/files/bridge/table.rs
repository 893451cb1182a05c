//! Tables of numbers as programs write them: semicolons, tabs, commas or blanks between, the same in all rows, comments and headings
//! in front. Where no comma stands between, numbers may have decimal commas.

use crate::error::{Error, Place, Result, counted, ensure, without_control_characters};
use crate::files::text::{is_blank, parsed};
use std::collections::HashSet;
use std::path::Path;

/// Rows of a file at most: a thousand nodes by thousands of modes.
const ROWS_AT_MOST: usize = 5_000_000;

/// A table with the heading of its columns, if it has one.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Table {
    pub(super) heading: Vec<String>,
    pub(super) rows: Vec<TableRow>,
}

/// A row of a table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TableRow {
    /// Line in the file.
    pub(super) line: usize,
    pub(super) cells: Vec<String>,
}

/// Between columns that are not marked.
const BLANK: char = ' ';

/// What stands between the cells of a line by itself.
fn separator(line: &str) -> char {
    let marks = [';', '\t', ','];
    let found = marks.into_iter().find(|c| line.contains(*c));
    found.unwrap_or(BLANK)
}

/// Cells of a line.
fn cells(line: &str, between: char) -> Vec<String> {
    let parts: Vec<&str> = match between {
        BLANK => line.split_whitespace().collect(),
        mark => line.split(mark).collect(),
    };
    let cell = |text: &&str| {
        let text = text.trim().trim_matches('"');
        let with_point = text.replace(',', ".");
        match with_point.parse::<f64>() {
            Ok(_) => with_point,
            Err(_) => text.to_owned(),
        }
    };
    parts.iter().map(cell).collect()
}

fn are_names(cells: &[String]) -> bool {
    cells.iter().all(|c| c.parse::<f64>().is_err())
}

impl Table {
    /// What `make` makes of the table in a file; errors name the file.
    pub(super) fn read<T>(path: &Path, make: impl FnOnce(&Self) -> Result<T>) -> Result<T> {
        parsed(path, |text| make(&Self::parse(text)?))
    }

    pub(super) fn parse(text: &str) -> Result<Self> {
        let mut table = Self::default();
        let mut between = None;
        for (i, line) in text.lines().enumerate() {
            let line = line.trim();
            if is_blank(line) || line.starts_with(['#', '*', '%']) {
                continue;
            }
            // names of nodes and columns are shown and written
            without_control_characters(Place::line(i + 1), line)?;
            let own = separator(line);
            let mut cells = self::cells(line, *between.get_or_insert(own));
            let by_itself = self::cells(line, own);
            if table.rows.is_empty() && are_names(&cells) && are_names(&by_itself) {
                between = Some(own);
                table.heading = by_itself;
                continue;
            }
            let (line, expected) = (i + 1, format_args!("at most {ROWS_AT_MOST} rows"));
            let fits = table.fit(&mut cells, between);
            fits.map_err(|e| e.at(Place::line(line)))?;
            let is_room = table.rows.len() != ROWS_AT_MOST;
            ensure(is_room, Place::line(line), expected, "more")?;
            table.rows.push(TableRow { line, cells });
        }
        ensure(!table.rows.is_empty(), "", "rows of numbers", "none")?;
        Ok(table)
    }

    /// Refuses a row that has not as many cells as the heading, as far as these are marked; empty ones behind are none.
    fn fit(&self, cells: &mut Vec<String>, between: Option<char>) -> Result<()> {
        let columns = self.heading.len();
        if columns == 0 || between == Some(BLANK) {
            return Ok(());
        }
        while cells.len() > columns && cells.last().is_some_and(String::is_empty) {
            cells.pop();
        }
        let expected = counted(columns, "column");
        ensure(cells.len() == columns, "", expected, cells.len())
    }

    /// Place of the column with one of these names, in any case.
    pub(super) fn column(&self, names: &[&str]) -> Option<usize> {
        self.heading
            .iter()
            .position(|h| names.iter().any(|n| h.eq_ignore_ascii_case(n)))
    }

    /// The same, which must be there.
    pub(super) fn required(&self, names: &[&str]) -> Result<usize> {
        let at = self.column(names).ok_or_else(|| {
            let expected = format!("a column `{}`", names[0]);
            Error::input("heading", expected, format!("`{}`", self.heading.join(",")))
        })?;
        let (name, behind) = (&self.heading[at], &self.heading[at + 1..]);
        let again = behind.iter().any(|h| h.eq_ignore_ascii_case(name));
        let expected = format_args!("a column `{name}` once");
        ensure(!again, "heading", expected, "it twice")?;
        Ok(at)
    }

    /// Places of columns that must be there, each by one of its names.
    pub(super) fn columns<const N: usize>(&self, names: [&[&str]; N]) -> Result<[usize; N]> {
        let mut columns = [0; N];
        for (column, names) in columns.iter_mut().zip(names) {
            *column = self.required(names)?;
        }
        Ok(columns)
    }

    /// Refuses a node in two rows; `names` are those of the nodes, row by row.
    pub(super) fn each_once<'n>(&self, names: impl Iterator<Item = &'n str>) -> Result<()> {
        let mut known = HashSet::new();
        for (row, name) in self.rows.iter().zip(names) {
            let (is_new, found) = (known.insert(name), format_args!("node {name} twice"));
            ensure(is_new, Place::line(row.line), "each node once", found)?;
        }
        Ok(())
    }

    /// The numbers in these columns of all rows.
    pub(super) fn all<const N: usize>(&self, columns: [usize; N]) -> Result<Vec<[f64; N]>> {
        self.rows.iter().map(|row| row.numbers(columns)).collect()
    }

    /// All numbers of all rows, in order.
    pub(super) fn all_numbers(&self) -> Result<Vec<f64>> {
        let cells = self
            .rows
            .iter()
            .flat_map(|row| (0..row.cells.len()).map(move |c| row.number(c)));
        cells.collect()
    }
}

impl TableRow {
    fn place(&self, column: usize) -> Place {
        Place::line(self.line).column(column + 1)
    }

    fn cell(&self, column: usize) -> &str {
        self.cells.get(column).map_or("", String::as_str)
    }

    /// The number in a cell.
    pub(super) fn number(&self, column: usize) -> Result<f64> {
        let (place, cell) = (self.place(column), self.cell(column));
        let number: Option<f64> = cell.parse().ok();
        number
            .filter(|x| x.is_finite())
            .ok_or_else(|| Error::input(place, "a finite number", format!("`{cell}`")))
    }

    /// The numbers in some cells.
    pub(super) fn numbers<const N: usize>(&self, columns: [usize; N]) -> Result<[f64; N]> {
        let mut numbers = [0.0; N];
        for (number, column) in numbers.iter_mut().zip(columns) {
            *number = self.number(column)?;
        }
        Ok(numbers)
    }

    /// The whole number in a cell.
    pub(super) fn count(&self, column: usize) -> Result<usize> {
        let (x, found) = (self.number(column)?, self.cell(column));
        let (is_whole, found) = (x >= 0.0 && x.fract() == 0.0, format_args!("`{found}`"));
        ensure(is_whole, self.place(column), "a whole number", found)?;
        Ok(x as usize)
    }

    /// The positive number in a cell.
    pub(super) fn positive(&self, column: usize, expected: &str) -> Result<f64> {
        let x = self.number(column)?;
        ensure(x > 0.0, self.place(column), expected, x)?;
        Ok(x)
    }

    /// The name in a cell; numbers lose what a spreadsheet added to them (`12.0`).
    pub(super) fn name(&self, column: usize) -> String {
        let cell = self.cell(column);
        match cell.parse::<f64>() {
            Ok(x) if x.fract() == 0.0 && x.abs() < 1e15 => format!("{x:.0}"),
            _ => cell.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(text: &str) -> Result<Vec<f64>> {
        Table::parse(text)?.all_numbers()
    }

    /// Semicolons or blanks with decimal commas, tabs, a title above, what a spreadsheet leaves of empty cells.
    #[test]
    fn one_separator_is_that_of_the_heading() {
        for text in [
            "mode;frequency_hz;mass\n1;0,055;234,5\n2;0,31;2\n;;\n",
            "mode frequency_hz mass\n1  0,055 234,5\n2 0.31 2\n",
            "Modes of the bridge\nmode\tfrequency_hz\tmass\n1\t0,055\t234.5\n2\t0.31\t2\t\n",
            "mode,frequency_hz,mass\n1,0.055,234.5\n2,0.31,2,,\n,,\n",
            "1 0,055 234,5\n2 0,31 2\n",
            "1,0.055,234.5\n2,0.31,2\n",
        ] {
            let found = numbers(text).unwrap_or_default();
            let expected = [1.0, 0.055, 234.5, 2.0, 0.31, 2.0];
            // a comma in the first row without a heading stands between
            match text.starts_with("1 ") {
                true => assert!(found.is_empty(), "{text}: {found:?}"),
                false => assert_eq!(found, expected, "{text}"),
            }
        }
        let table = Table::parse("mode;f\n1;0,5\n").unwrap();
        assert_eq!(table.heading, ["mode", "f"]);
    }

    #[test]
    fn a_column_stands_once() {
        let table = Table::parse("node,ux,UX\n1,2,3\n").unwrap();
        let said = table.columns([&["ux"]]).unwrap_err().to_string();
        assert_eq!(said, "heading: expected a column `ux` once, found it twice");
    }

    #[test]
    fn rows_have_the_cells_of_the_heading() {
        for (text, expected) in [
            (
                "mode,f,m\n1,0,055,234,5\n",
                "line 2: expected 3 columns, found 5",
            ),
            ("a;b\n1;2\n\n3\n", "line 4: expected 2 columns, found 1"),
        ] {
            assert_eq!(numbers(text).unwrap_err().to_string(), expected);
        }
    }
}
