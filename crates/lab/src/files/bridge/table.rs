//! Tables of numbers as programs write them: commas, semicolons, tabs or blanks between, comments and headings in front.

use crate::error::{Error, Place, Result, ensure, without_control_characters};
use crate::files::text::read_text;
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

/// Cells of a line: between commas, semicolons or tabs, else between blanks.
fn cells(line: &str) -> Vec<String> {
    let marked = line.contains([',', ';', '\t']);
    let parts: Vec<&str> = if marked {
        line.split([',', ';', '\t']).collect()
    } else {
        line.split_whitespace().collect()
    };
    parts
        .iter()
        .map(|c| c.trim().trim_matches('"').to_owned())
        .collect()
}

impl Table {
    /// The table in a file.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        Self::parse(&text).map_err(|e| e.in_file(path))
    }

    pub(super) fn parse(text: &str) -> Result<Self> {
        let mut table = Self::default();
        for (i, line) in text.lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with(['#', '*', '%']) {
                continue;
            }
            // names of nodes and columns are shown and written
            without_control_characters(Place::line(i + 1), line)?;
            let cells = cells(line);
            let is_heading = cells.iter().all(|c| c.parse::<f64>().is_err());
            if table.rows.is_empty() && is_heading {
                table.heading = cells;
                continue;
            }
            ensure(
                table.rows.len() != ROWS_AT_MOST,
                Place::line(i + 1),
                format_args!("at most {ROWS_AT_MOST} rows"),
                "more",
            )?;
            let line = i + 1;
            table.rows.push(TableRow { line, cells });
        }
        ensure(!table.rows.is_empty(), "", "rows of numbers", "none")?;
        Ok(table)
    }

    /// Place of the column with one of these names, in any case.
    pub(super) fn column(&self, names: &[&str]) -> Option<usize> {
        self.heading
            .iter()
            .position(|h| names.iter().any(|n| h.eq_ignore_ascii_case(n)))
    }

    /// The same, which must be there.
    pub(super) fn required(&self, names: &[&str]) -> Result<usize> {
        self.column(names).ok_or_else(|| {
            Error::input(
                "heading",
                format!("a column `{}`", names[0]),
                format!("`{}`", self.heading.join(",")),
            )
        })
    }

    /// Refuses a node in two rows; `names` are those of the nodes, row by row.
    pub(super) fn each_once<'n>(&self, names: impl Iterator<Item = &'n str>) -> Result<()> {
        let mut known = HashSet::new();
        for (row, name) in self.rows.iter().zip(names) {
            ensure(
                known.insert(name),
                Place::line(row.line),
                "each node once",
                format_args!("node {name} twice"),
            )?;
        }
        Ok(())
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

    /// The whole number in a cell.
    pub(super) fn count(&self, column: usize) -> Result<usize> {
        let x = self.number(column)?;
        ensure(
            x >= 0.0 && x.fract() == 0.0,
            self.place(column),
            "a whole number",
            format_args!("`{}`", self.cell(column)),
        )?;
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
