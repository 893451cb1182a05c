//! `aerodeck plot`: columns of a CSV file of results over one of them.

use super::figures;
use super::vocabulary::{
    Answer, Error, OutputDir, PlottedSeries, Result, TimePanel, folder_of, time_history_figure,
};
use std::path::Path;

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

/// Runs the command.
pub(crate) fn run(
    file: &Path,
    x: Option<&str>,
    y: &[String],
    out: Option<&Path>,
) -> Result<Answer> {
    let (names, rows) = read(file)?;
    let column = |name: &str| {
        let at = names.iter().position(|n| n == name);
        at.ok_or_else(|| {
            let expected = format!("one of {}", names.join(", "));
            Error::input("column", expected, format!("`{name}`"))
        })
    };
    let is_number = |c: &usize| {
        let number = |row: &Vec<String>| row[*c].parse::<f64>().is_ok_and(f64::is_finite);
        !rows.is_empty() && rows.iter().all(number)
    };
    let numbers: Vec<usize> = (0..names.len()).filter(is_number).collect();
    let none = || Error::input("columns", "one of numbers", "none").in_file(file);
    let x = match x {
        Some(name) => column(name)?,
        None => *numbers.first().ok_or_else(none)?,
    };
    let y: Vec<usize> = match y {
        [] => {
            let others = numbers.into_iter().filter(|c| *c != x);
            others.take(MOST_PANELS).collect()
        }
        named => named.iter().map(|n| column(n)).collect::<Result<_>>()?,
    };
    let panel = |c: usize| TimePanel::new(label(&names[c]), curves(&names, &rows, x, c));
    let panels: Vec<TimePanel> = y.into_iter().map(panel).collect();
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let folder = out.unwrap_or(folder_of(file));
    let mut out = OutputDir::new(folder)?;
    let abscissa = label(&names[x]);
    let draw = || time_history_figure(&stem, &panels, &abscissa);
    figures::write(&stem, &mut out, draw)?;
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

/// The names of the columns of a result file, and its rows.
fn read(path: &Path) -> Result<(Vec<String>, Vec<Vec<String>>)> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(path)
        .map_err(|e| Error::io(path, std::io::Error::other(e)))?;
    let broken =
        |e: csv::Error| Error::input("", "rows of a CSV file", e.to_string()).in_file(path);
    let owned = |row: &csv::StringRecord| row.iter().map(|f| f.trim().to_owned()).collect();
    let names = owned(reader.headers().map_err(broken)?);
    let rows = reader.records();
    let rows = rows.map(|row| row.map(|r| owned(&r)).map_err(broken));
    Ok((names, rows.collect::<Result<_>>()?))
}

/// A curve of the columns `y` over `x` for every group of rows with the same words.
fn curves(names: &[String], rows: &[Vec<String>], x: usize, y: usize) -> Vec<PlottedSeries> {
    let texts: Vec<usize> = (0..names.len())
        .filter(|c| rows.iter().all(|r| r[*c].parse::<f64>().is_err()))
        .filter(|c| rows.iter().any(|r| r[*c] != "yes" && r[*c] != "no"))
        .collect();
    let mut curves: Vec<PlottedSeries> = Vec::new();
    for row in rows {
        let words: Vec<&str> = texts.iter().map(|c| row[*c].as_str()).collect();
        let name = match words.is_empty() {
            true => names[y].replace('_', " "),
            false => words.join(", "),
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
