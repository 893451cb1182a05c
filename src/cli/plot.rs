//! `aerodeck plot`: columns of a CSV file of results over one of them.

use super::{Answer, OutputDir, figures, folder_of};
use crate::error::{Error, Result};
use crate::report::{PlottedSeries, TimePanel, time_history_figure};
use std::path::{Path, PathBuf};

/// Panels of one figure at most.
const MOST_PANELS: usize = 6;
/// Ends of names of columns that are units, longest first.
const UNITS: [(&str, &str); 13] = [
    ("_rad_s2", "rad/s²"),
    ("_n_m_m", "N·m/m"),
    ("_per_s", "1/s"),
    ("_rad_s", "rad/s"),
    ("_m_s2", "m/s²"),
    ("_m_s", "m/s"),
    ("_n_m", "N/m"),
    ("_deg", "deg"),
    ("_rad", "rad"),
    ("_hz", "Hz"),
    ("_s", "s"),
    ("_m", "m"),
    ("_n", "N"),
];

/// Draw columns of a CSV file of results over one of them, as SVG and with --png as PNG
///
/// Example: aerodeck plot aerodeck-out/curves.csv --x speed_m_s --y frequency_hz,damping_ratio
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct PlotArgs {
    /// The file (`curves.csv`, `simulation.csv`, a record, …). Columns of text tell curves apart.
    file: PathBuf,
    /// Abscissa; by default the first column of numbers.
    #[arg(long)]
    x: Option<String>,
    /// Columns to plot, one panel per column; by default all other columns of numbers, six at most.
    #[arg(long, value_delimiter = ',')]
    y: Vec<String>,
    /// Folder of the figure; by default that of the file.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Runs the command.
pub(crate) fn run(args: &PlotArgs) -> Result<Answer> {
    let table = ResultTable::read(&args.file)?;
    let numbers: Vec<usize> = (0..table.names.len())
        .filter(|c| table.is_number(*c))
        .collect();
    let x = match &args.x {
        Some(name) => table.column(name)?,
        None => *numbers
            .first()
            .ok_or_else(|| Error::input("columns", "one of numbers", "none").in_file(&args.file))?,
    };
    let mut y: Vec<usize> = args
        .y
        .iter()
        .map(|n| table.column(n))
        .collect::<Result<_>>()?;
    if y.is_empty() {
        y = numbers
            .into_iter()
            .filter(|c| *c != x)
            .take(MOST_PANELS)
            .collect();
    }
    let panels: Vec<TimePanel> = y
        .iter()
        .map(|c| TimePanel {
            y_label: label(&table.names[*c]),
            series: table.curves(x, *c),
        })
        .collect();
    let stem = args.file.file_stem().unwrap_or_default().to_string_lossy();
    let folder = args.out.as_deref().unwrap_or(folder_of(&args.file));
    let mut out = OutputDir::new(folder)?;
    let abscissa = label(&table.names[x]);
    figures::write(&stem, &mut out, || {
        time_history_figure(&stem, &panels, &abscissa)
    })?;
    out.answer(String::new(), serde_json::json!({}))
}

/// A name with its unit in words: `frequency_hz` as `frequency (Hz)`.
fn label(name: &str) -> String {
    let unit = UNITS.iter().find(|(end, _)| name.ends_with(end));
    let (name, unit) = unit.map_or((name, None), |(end, unit)| {
        (&name[..name.len() - end.len()], Some(unit))
    });
    let words = name.replace('_', " ");
    unit.map_or(words.clone(), |unit| format!("{words} ({unit})"))
}

struct ResultTable {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl ResultTable {
    fn read(path: &Path) -> Result<Self> {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .from_path(path)
            .map_err(|e| Error::io(path, std::io::Error::other(e)))?;
        let broken =
            |e: csv::Error| Error::input("", "rows of a CSV file", e.to_string()).in_file(path);
        let owned = |row: &csv::StringRecord| row.iter().map(|f| f.trim().to_owned()).collect();
        let names = owned(reader.headers().map_err(broken)?);
        let rows = reader
            .records()
            .map(|row| row.map(|r| owned(&r)).map_err(broken));
        Ok(Self {
            names,
            rows: rows.collect::<Result<_>>()?,
        })
    }

    fn column(&self, name: &str) -> Result<usize> {
        let at = self.names.iter().position(|n| n == name);
        at.ok_or_else(|| {
            let expected = format!("one of {}", self.names.join(", "));
            Error::input("column", expected, format!("`{name}`"))
        })
    }

    fn is_number(&self, column: usize) -> bool {
        let number = |row: &Vec<String>| row[column].parse::<f64>().is_ok_and(f64::is_finite);
        !self.rows.is_empty() && self.rows.iter().all(number)
    }

    /// The curves of a column, one for each text that stands beside it; rows that are no numbers are left out.
    fn curves(&self, x: usize, y: usize) -> Vec<PlottedSeries> {
        let texts: Vec<usize> = (0..self.names.len())
            .filter(|c| self.rows.iter().all(|r| r[*c].parse::<f64>().is_err()))
            .filter(|c| self.rows.iter().any(|r| r[*c] != "yes" && r[*c] != "no"))
            .collect();
        let mut curves: Vec<PlottedSeries> = Vec::new();
        for row in &self.rows {
            let words: Vec<&str> = texts.iter().map(|c| row[*c].as_str()).collect();
            let name = if words.is_empty() {
                self.names[y].replace('_', " ")
            } else {
                words.join(", ")
            };
            let (Ok(a), Ok(b)) = (row[x].parse::<f64>(), row[y].parse::<f64>()) else {
                continue;
            };
            match curves.iter_mut().find(|c| c.label == name) {
                Some(curve) => curve.points.push((a, b)),
                None => curves.push(PlottedSeries::new(name, vec![(a, b)])),
            }
        }
        curves
    }
}

#[cfg(test)]
mod tests {
    use super::label;

    #[test]
    fn names_of_columns_become_words_with_units() {
        assert_eq!(label("frequency_hz"), "frequency (Hz)");
        assert_eq!(
            label("vertical_acceleration_m_s2"),
            "vertical acceleration (m/s²)"
        );
        assert_eq!(label("damping_ratio"), "damping ratio");
        assert_eq!(label("time_s"), "time (s)");
    }
}
