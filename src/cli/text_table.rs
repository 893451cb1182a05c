//! Tables of a terminal: every column as wide as what stands in it.

use super::wrapping::beside;

/// A table in making: its columns from left to right, then its rows.
pub(crate) struct TextTable {
    heads: Vec<String>,
    /// For each column, whether its cells stand at the right.
    at_right: Vec<bool>,
    /// The cells of each row, and a sentence that stands in place of those that are missing.
    rows: Vec<(Vec<String>, String)>,
}

impl TextTable {
    /// One of these columns, ` | ` between their heads: `>` before the head of one of figures, which stand at the right.
    pub(crate) fn new(heads: &str) -> Self {
        let heads = heads.split(" | ");
        let columns = heads.map(|head| {
            (
                head.trim_start_matches('>').to_owned(),
                head.starts_with('>'),
            )
        });
        let (heads, at_right) = columns.unzip();
        Self {
            heads,
            at_right,
            rows: Vec::new(),
        }
    }

    /// A row of one cell a column.
    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.sentence(cells, "");
    }

    /// A row that begins with `cells` and goes on as a sentence.
    pub(crate) fn sentence(&mut self, cells: impl IntoIterator<Item = String>, sentence: &str) {
        self.rows
            .push((cells.into_iter().collect(), sentence.to_owned()));
    }

    /// The lines of the table; sentences are cut at spaces and go on below themselves.
    pub(crate) fn text(&self) -> String {
        let width = |i: usize| {
            let cells = self.rows.iter().filter_map(|(cells, _)| cells.get(i));
            let all = cells.chain(self.heads.get(i));
            all.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.heads.len()).map(width).collect();
        let line = |cells: &[String], sentence: &str| {
            let cells = cells.iter().zip(&widths).zip(&self.at_right);
            let cells = cells.map(|((cell, &width), at_right)| match at_right {
                true => format!("{cell:>width$}"),
                false => format!("{cell:<width$}"),
            });
            let line = cells.collect::<Vec<_>>().join("  ");
            match sentence {
                "" => line.trim_end().to_owned() + "\n",
                sentence => beside(&(line + " "), sentence),
            }
        };
        let rows = self.rows.iter();
        let rows = rows.map(|(cells, sentence)| line(cells, sentence));
        line(&self.heads, "") + &rows.collect::<String>()
    }
}

#[cfg(test)]
mod tests {
    use super::TextTable;

    #[test]
    fn columns_are_as_wide_as_their_cells() {
        let mut table = TextTable::new("mode | >f Hz | motion");
        let row = ["a long name", "0.1234", "heave"];
        table.row(row.map(str::to_owned));
        table.row(["θ", "12.5", "torsion"].map(str::to_owned));
        table.sentence(["none".to_owned()], "not found");
        assert_eq!(
            table.text(),
            "mode           f Hz  motion\n\
             a long name  0.1234  heave\n\
             θ              12.5  torsion\n\
             none         not found\n"
        );
    }
}
