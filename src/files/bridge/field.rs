//! Turbulence along the span as a file: `time_s,u[x1],u[x2],…,w[x1],…`, m/s, the places along the girder in metres.

use super::table::Table;
use crate::error::{Error, Result};
use std::path::Path;

/// Steps may differ by this part: times are written with a few digits.
const SAME_STEP: f64 = 1e-6;

/// Turbulence at places along a girder.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldTable {
    /// Time step, s.
    pub step_s: f64,
    /// Places of the columns, m.
    pub along_m: Vec<f64>,
    /// `u` then `w`: a row of samples a place.
    pub gusts: [Vec<Vec<f64>>; 2],
}

/// Reads a file.
///
/// # Errors
/// [`Error::Io`] when it cannot be read; [`Error::Input`] with file and place for columns or times that are wrong.
pub fn read_field(path: &Path) -> Result<FieldTable> {
    parse(&Table::read(path)?).map_err(|e| e.in_file(path))
}

fn parse(table: &Table) -> Result<FieldTable> {
    let time = table.required(&["time_s"])?;
    let columns = |name: &str| -> Result<Vec<(usize, f64)>> {
        let named = table.heading.iter().enumerate().filter_map(|(i, h)| {
            let inner = h.strip_prefix(name)?.strip_prefix('[')?.strip_suffix(']')?;
            Some((i, inner))
        });
        named
            .map(|(i, place)| {
                let along = place.parse().map_err(|_| {
                    let at = format!("heading, column {}", i + 1);
                    Error::input(at, "a place along the girder, m", format!("`{place}`"))
                })?;
                Ok((i, along))
            })
            .collect()
    };
    let (u, w) = (columns("u")?, columns("w")?);
    let places = |columns: &[(usize, f64)]| -> Vec<f64> { columns.iter().map(|c| c.1).collect() };
    if u.is_empty() || places(&u) != places(&w) {
        let found = format!("{} columns u[…] and {} columns w[…]", u.len(), w.len());
        return Err(Error::input(
            "heading",
            "columns u[x] and w[x] at the same places",
            found,
        ));
    }
    let times: Vec<f64> = table
        .rows
        .iter()
        .map(|r| Table::number(r, time))
        .collect::<Result<_>>()?;
    let step_s = step(&times, table)?;
    let samples = |columns: &[(usize, f64)]| -> Result<Vec<Vec<f64>>> {
        let row = |c: &(usize, f64)| table.rows.iter().map(|r| Table::number(r, c.0)).collect();
        columns.iter().map(row).collect()
    };
    Ok(FieldTable {
        step_s,
        along_m: places(&u),
        gusts: [samples(&u)?, samples(&w)?],
    })
}

fn step(times: &[f64], table: &Table) -> Result<f64> {
    if times.len() < 3 {
        return Err(Error::input(
            "",
            "three samples or more",
            times.len().to_string(),
        ));
    }
    let mean = (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64;
    let wrong = |t: &[f64]| (t[1] - t[0] - mean).abs() > SAME_STEP * mean.abs().max(t[1].abs());
    match times.windows(2).position(wrong) {
        None if mean > 0.0 => Ok(mean),
        at => {
            let place = format!("line {}, column time_s", table.rows[at.unwrap_or(0) + 1].0);
            Err(Error::input(
                place,
                format!("times that rise by {mean} s"),
                times[at.unwrap_or(0) + 1].to_string(),
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_by_their_headings() {
        let text = "# a comment\ntime_s,u[-10],u[10.5],w[-10],w[10.5]\n0,1,2,3,4\n0.1,5,6,7,8\n0.2,9,10,11,12\n";
        let field = parse(&Table::parse(text).unwrap()).unwrap();
        assert_eq!(field.along_m, [-10.0, 10.5]);
        assert!((field.step_s - 0.1).abs() < 1e-15);
        assert_eq!(field.gusts[1][1], [4.0, 8.0, 12.0]);
        for (from, to, expected) in [
            ("w[10.5]", "w[11]", "u[x] and w[x] at the same places"),
            (
                "0.1,",
                "0.15,",
                "line 4, column time_s: expected times that rise by 0.1 s",
            ),
            ("u[-10]", "u[here]", "heading, column 2: expected a place"),
        ] {
            let message = parse(&Table::parse(&text.replace(from, to)).unwrap())
                .unwrap_err()
                .to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
