//! This project's file of static coefficients: CSV with a header of `# key: value` lines.
//!
//! ```text
//! # aerodeck static coefficients 1
//! # name: flat plate
//! # source: …
//! # licence: …
//! # units: …              as in `UNITS`
//! # sign_convention: …    as in `SIGN_CONVENTION`
//! # generator: …
//! angle_deg,c_d,c_l,c_m
//! -10,0.01,-1.09662271123215,-0.27415567780803773
//! ```
//!
//! Angles rise from row to row. Numbers are written with as many digits as it takes to read the same double back.

use crate::aerodynamics::derivatives::TableHeader;
use crate::aerodynamics::quasi_steady::coefficients::check_rows;
use crate::aerodynamics::quasi_steady::{CoefficientRow, StaticCoefficients};
use crate::error::{Place, Result};
use crate::files::header_csv::{CommentHeader, number_rows};
use std::io::Write;

/// First line of the file.
const FORMAT: &str = "aerodeck static coefficients 1";

/// Sign convention and scaling of every table of static coefficients, as written in the header of its files.
const SIGN_CONVENTION: &str = "wind axes: drag along the relative wind, lift normal to it, up; moment and angle nose-up, moment about the axis of rotation; C_D = D/(rho V^2 B/2), C_L = L/(rho V^2 B/2), C_M = M/(rho V^2 B^2/2), B the full width";

/// Units of the columns, as written in the header of the files.
const UNITS: &str = "angle_deg in degrees; c_d, c_l, c_m dimensionless";

/// Names of the columns, which may stand in any order.
const COEFFICIENT_COLUMNS: [&str; 4] = ["angle_deg", "c_d", "c_l", "c_m"];

/// Keys of the header.
const KEYS: [&str; 6] = [
    "name",
    "source",
    "licence",
    "units",
    "sign_convention",
    "generator",
];

/// The table in `text`, the content of such a file.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) naming line, expectation and finding: missing or unknown header keys and columns, another sign
/// convention or other units, text or NaN in numbers, angles that do not rise, fewer than four rows.
pub(crate) fn parse_coefficients(text: &str) -> Result<StaticCoefficients> {
    let header = CommentHeader::read(text, &[FORMAT], &KEYS, &[])?;
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for row in number_rows(text, COEFFICIENT_COLUMNS, header.lines() + 1)? {
        let (line, [angle_deg, drag, lift, moment]) = row?;
        rows.push(CoefficientRow {
            angle_deg,
            drag,
            lift,
            moment,
        });
        lines.push(line);
    }
    let no_row = header.lines() as u64 + 1;
    check_rows(&rows, |i| {
        Place::line(lines.get(i).copied().unwrap_or(no_row))
    })?;
    header.must_say("sign_convention", SIGN_CONVENTION)?;
    header.must_say("units", UNITS)?;
    let provenance = TableHeader {
        source: header.text("source"),
        licence: header.text("licence"),
        generator: header.text("generator"),
        ..TableHeader::default()
    };
    StaticCoefficients::new(header.required("name")?.value.clone(), provenance, rows)
}

/// Writes a table; `parse_coefficients` gives the same table back, bit for bit.
pub fn write_coefficients(table: &StaticCoefficients, out: &mut dyn Write) -> std::io::Result<()> {
    let header = &table.header;
    let entries = [
        ("name", table.name.as_str()),
        ("source", &header.source),
        ("licence", &header.licence),
        ("units", UNITS),
        ("sign_convention", SIGN_CONVENTION),
        ("generator", &header.generator),
    ];
    CommentHeader::write(out, FORMAT, &entries)?;
    writeln!(out, "{}", COEFFICIENT_COLUMNS.join(","))?;
    for r in table.rows() {
        writeln!(out, "{},{},{},{}", r.angle_deg, r.drag, r.lift, r.moment)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::coefficients::embedded;
    use crate::files::text::parsed;
    use std::path::Path;

    fn written(table: &StaticCoefficients) -> String {
        let mut out = Vec::new();
        write_coefficients(table, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn write_and_read_give_the_same_table_and_file() {
        for name in embedded::names() {
            let table = embedded::coefficients(name).unwrap();
            let text = written(&table);
            let again = parse_coefficients(&text).unwrap();
            assert_eq!(again, table);
            assert_eq!(written(&again), text);
        }
    }

    #[test]
    fn bad_files_are_explained() {
        let good = written(&embedded::coefficients("synthetic box girder").unwrap());
        let cases = [
            (
                "\n-8,",
                "\n-10,",
                "line 13: expected angles that rise from row to row, found -10 after -10",
            ),
            (
                "\n-8,",
                "\nNaN,",
                "line 13: expected finite numbers, found NaN",
            ),
            (
                "\n-8,",
                "\neight,",
                "line 13, column angle_deg: expected a number, found `eight`",
            ),
            (
                "c_l,c_m",
                "cl,c_m",
                "line 8: expected a column `c_l`, found `angle_deg,c_d,cl,c_m`",
            ),
            (
                "c_l,c_m",
                "c_l,c_m,c_l",
                "line 8: expected a column `c_l` once, found it twice",
            ),
            (
                "lift normal to it, up",
                "lift down",
                "line 6 (sign_convention): expected `wind axes",
            ),
            (
                "in degrees",
                "in radians",
                "line 5 (units): expected `angle_deg in degrees",
            ),
            (
                "# name: synthetic box girder\n",
                "",
                "header: expected a line `# name: …`, found none",
            ),
            ("\n-8,", "\n-8,1,", "line 13: expected 4 columns, found 5"),
            (
                "\n10,",
                "\n200,",
                "line 22: expected an angle within ±180 deg, found 200 deg",
            ),
        ];
        for (old, new, expected) in cases {
            let bad = good.replacen(old, new, 1);
            assert_ne!(bad, good, "{old}");
            let message = parse_coefficients(&bad).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        let short: Vec<&str> = good.lines().take(10).collect();
        let message = parse_coefficients(&short.join("\n"))
            .unwrap_err()
            .to_string();
        assert_eq!(
            message,
            "line 10: expected at least 4 rows of the table, found 2"
        );
        let message = parse_coefficients("").unwrap_err().to_string();
        assert!(
            message.contains("expected a column `angle_deg`"),
            "{message}"
        );
    }

    #[test]
    fn a_missing_file_is_named() {
        let message = parsed(Path::new("no/such.csv"), parse_coefficients)
            .unwrap_err()
            .to_string();
        assert!(message.starts_with("no/such.csv: "), "{message}");
    }
}
