//! This project's file of gusts: CSV with a header of `# key: value` lines.
//!
//! ```text
//! # aerodeck gust series 1
//! # name: …
//! # source: …
//! # units: time_s in s; u_m_s, w_m_s in m/s
//! # sign_convention: u along the mean wind without the mean; w up
//! time_s,u_m_s,w_m_s
//! 0,0.31,-0.12
//! ```
//!
//! Times start at zero and are equally spaced.

use crate::aerodynamics::GustSeries;
use crate::error::{Place, Result, ensure, finite};
use crate::files::header_csv::{CommentHeader, number_rows};
use crate::files::text::parsed;
use std::io::Write;
use std::path::Path;

/// First line of the file.
const FORMAT: &str = "aerodeck gust series 1";
/// Keys of the header.
const KEYS: [&str; 4] = ["name", "source", "units", "sign_convention"];
const UNITS: &str = "time_s in s; u_m_s, w_m_s in m/s";
const SIGNS: &str = "u along the mean wind without the mean; w up";
/// A sample may stand off its place by this part of the step: time stamps are often rounded.
const JITTER: f64 = 1e-3;

/// Names of the columns, which may stand in any order.
pub(crate) const GUST_COLUMNS: [&str; 3] = ["time_s", "u_m_s", "w_m_s"];

/// Reads a series of gusts.
///
/// # Errors
/// [`Error::Io`](crate::error::Error::Io) when the file cannot be read; [`Error::Input`](crate::error::Error::Input) with file and line, what was expected and what was found.
pub fn read_gusts(path: impl AsRef<Path>) -> Result<GustSeries> {
    parsed(path.as_ref(), parse_gusts)
}

/// The series in `text`, the content of such a file.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) naming the line: wrong header or columns, text or NaN in numbers, times that do not start at zero or
/// are not equally spaced, fewer than two samples.
pub(crate) fn parse_gusts(text: &str) -> Result<GustSeries> {
    let header = CommentHeader::read(text, &[FORMAT], &KEYS, &[])?;
    header.must_say("units", UNITS)?;
    header.must_say("sign_convention", SIGNS)?;
    let (mut along, mut vertical, mut step) = (Vec::new(), Vec::new(), 0.0);
    for row in number_rows(text, GUST_COLUMNS, header.lines() + 1)? {
        let (line, row) = row?;
        for (name, value) in GUST_COLUMNS.iter().zip(row) {
            finite(Place::line(line).column(name), value)?;
        }
        let [time, u, w] = row;
        if along.len() == 1 {
            step = crate::error::positive(Place::line(line).column("time_s"), time)?;
        }
        let expected = step * along.len() as f64;
        let in_step = (time - expected).abs() <= JITTER * step;
        let expected = format_args!("{expected} (equal steps from zero)");
        ensure(in_step, Place::line(line).column("time_s"), expected, time)?;
        along.push(u);
        vertical.push(w);
    }
    let samples = along.len();
    let end = Place::line(header.lines() + 1 + samples);
    ensure(samples >= 2, end, "at least 2 samples", samples)?;
    GustSeries::new(step, along, vertical)
}

/// Writes a series; `parse_gusts` gives the same gusts back, bit for bit.
pub fn write_gusts(
    name: &str,
    source: &str,
    gusts: &GustSeries,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let entries = [
        ("name", name),
        ("source", source),
        ("units", UNITS),
        ("sign_convention", SIGNS),
    ];
    CommentHeader::write(out, FORMAT, &entries)?;
    writeln!(out, "{}", GUST_COLUMNS.join(","))?;
    let pairs = gusts.along_m_s().iter().zip(gusts.vertical_m_s());
    for (i, (u, w)) in pairs.enumerate() {
        writeln!(out, "{},{u},{w}", gusts.step_s() * i as f64)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::files::gusts::*;

    fn written() -> String {
        let gusts =
            GustSeries::new(0.05, vec![0.1, -0.3, 0.7, 1e-9], vec![0.0, 1.25, -3.5, 2.0]).unwrap();
        let mut out = Vec::new();
        write_gusts("made up", "a test", &gusts, &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert_eq!(parse_gusts(&text).unwrap(), gusts);
        text
    }

    #[test]
    fn bad_files_are_explained() {
        let good = written();
        let cases = [
            (
                "\n0.05,",
                "\n0.06,",
                "line 9, column time_s: expected 0.12 (equal steps from zero), found 0.1",
            ),
            (
                "\n0.05,",
                "\n-0.05,",
                "line 8, column time_s: expected a positive number",
            ),
            (
                "-3.5",
                "inf",
                "line 9, column w_m_s: expected a finite number, found inf",
            ),
            (
                "-3.5",
                "calm",
                "line 9, column w_m_s: expected a number, found `calm`",
            ),
            (
                "w up",
                "w down",
                "line 5 (sign_convention): expected `u along",
            ),
            ("u_m_s,w_m_s\n", "u_m_s,w\n", "expected a column `w_m_s`"),
        ];
        for (old, new, expected) in cases {
            let bad = good.replacen(old, new, 1);
            assert_ne!(bad, good, "{old}");
            let message = parse_gusts(&bad).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        let short: Vec<&str> = good.lines().take(7).collect();
        let message = parse_gusts(&short.join("\n")).unwrap_err().to_string();
        assert!(message.contains("at least 2 samples, found 1"), "{message}");
    }
}
