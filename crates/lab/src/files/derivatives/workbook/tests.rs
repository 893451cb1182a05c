//! Tests on the workbooks of `tests/data/make_workbook.py`.

use crate::aerodynamics::derivatives::notation::{Argument, Axes, Notation};
use crate::files::derivatives::read_table_with;
use crate::files::derivatives::workbook::*;
use crate::files::derivatives::{parse_csv, write_csv};
use std::path::PathBuf;

fn fixture(name: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "../..", "tests", "data", name]
        .iter()
        .collect()
}

fn read_workbook(path: impl AsRef<Path>, options: &ReadOptions) -> Result<DerivativeTable> {
    read_table_with(path, options).map(|(table, _)| table)
}

fn three_frequencies() -> ReadOptions {
    ReadOptions {
        frequencies_hz: Some(vec![0.5, 1.0, 2.0]),
        ..ReadOptions::default()
    }
}

fn refused(name: &str, options: &ReadOptions) -> String {
    let path = fixture(name);
    let message = read_workbook(&path, options).unwrap_err().to_string();
    let place = message.strip_prefix(&format!("{}: ", path.display()));
    place.expect("the file stands first").to_owned()
}

#[test]
fn figures_and_width_are_those_that_were_written() {
    let table = read_workbook(fixture("workbook.xlsx"), &three_frequencies()).unwrap();
    assert_eq!(table.name, "workbook");
    assert_eq!(table.header.source, "workbook workbook.xlsx");
    // The width comes back from V/(2πf V̂) to rounding.
    assert!((table.width_m - 0.5).abs() < 1e-15);
    for (c, d) in Derivative::ALL.into_iter().enumerate() {
        for (r, p) in table.points(d).iter().enumerate() {
            let sign = if c % 2 == 0 { 1.0 } else { -1.0 };
            let value = sign * (c as f64 + 1.0 + (r as f64 + 1.0) / 100.0);
            assert!((p.value - value).abs() < 1e-15 * value.abs(), "{d}");
            let speed = [4.0, 4.01, 4.02, 8.0, 8.01, 8.02][r] + c as f64 / 1000.0;
            // openpyxl writes 16 digits, one short of bit exactness.
            let written = p.mean_speed_m_s.unwrap();
            assert!((written - speed).abs() < 1e-15 * speed, "{d}");
            let v_hat = speed / (TAU * [0.5, 1.0, 2.0][r % 3] * 0.5);
            assert!((p.v_hat - v_hat).abs() < 1e-15 * v_hat, "{d}");
        }
    }
}

#[test]
fn workbook_to_csv_and_back_is_bit_exact() {
    let table = read_workbook(fixture("workbook.xlsx"), &three_frequencies()).unwrap();
    let mut text = Vec::new();
    write_csv(&table, &mut text).unwrap();
    let again = parse_csv(std::str::from_utf8(&text).unwrap()).unwrap();
    assert_eq!(again, table);
    let bits = |t: &DerivativeTable| {
        let all = t.derivatives().flat_map(|d| t.points(d).to_vec());
        all.flat_map(|p| [p.v_hat.to_bits(), p.value.to_bits()])
            .collect::<Vec<_>>()
    };
    assert_eq!(bits(&again), bits(&table));
}

#[test]
fn a_stated_width_is_taken() {
    let options = ReadOptions {
        width_m: Some(0.51),
        name: Some("deck".to_owned()),
        ..ReadOptions::default()
    };
    let table = read_workbook(fixture("workbook.xlsx"), &options).unwrap();
    assert_eq!((table.width_m, table.name.as_str()), (0.51, "deck"));
}

#[test]
fn bad_cells_are_named() {
    let options = three_frequencies();
    assert_eq!(
        refused("workbook_text.xlsx", &options),
        "sheet Reduced Velocities, cell I4: expected a number, found `n/a`"
    );
    assert_eq!(
        refused("workbook_empty.xlsx", &options),
        "sheet Reduced Velocities, cell I4: expected a number, found an empty cell"
    );
    let message = refused("workbook_negative.xlsx", &options);
    assert!(
        message.starts_with("H3, point 3: expected a positive reduced velocity V̂, found -0.6"),
        "{message}"
    );
}

#[test]
fn missing_sheets_and_columns_are_named() {
    let options = three_frequencies();
    let message = refused("workbook_no_column.xlsx", &options);
    let expected = "sheet Reduced Velocities, first row: expected a column `Vred_H3`, found `Vred_P1`, `Vred_P2`";
    assert!(message.starts_with(expected), "{message}");
    assert_eq!(
        refused("workbook_no_sheet.xlsx", &options),
        "workbook: expected a sheet `Mean wind velocity`, found `Aerodynamic Derivatives`, `Wind`, `Reduced Velocities`"
    );
}

#[test]
fn frequencies_that_do_not_fit_are_refused() {
    let options = |frequencies_hz| ReadOptions {
        frequencies_hz: Some(frequencies_hz),
        ..ReadOptions::default()
    };
    let message = refused("workbook.xlsx", &options(TABLE_3_2_FREQUENCIES_HZ.to_vec()));
    assert!(
        message.contains("expected 8 test points per speed"),
        "{message}"
    );
    let message = refused("workbook.xlsx", &options(vec![0.5, 1.0, 1.5]));
    assert!(message.ends_with("found 0.5000 m to 0.6667 m"), "{message}");
}

/// Three frequencies that nobody states: everything but the width is there, and a note says what was taken for it.
#[test]
fn other_frequencies_are_read_with_a_note_on_the_width() {
    let table = read_workbook(fixture("workbook.xlsx"), &ReadOptions::default()).unwrap();
    assert_eq!(table.width_m, 1.0);
    let [note] = &table.header.notes[..] else {
        panic!("{:?}", table.header.notes)
    };
    assert!(
        note.contains("1 m is assumed") && note.contains("found 6"),
        "{note}"
    );
}

/// As the laboratory's own package writes it: a sheet of dimensions, columns `H_1` in every sheet beside row numbers,
/// two other frequencies, and no H4, A4. Also with the plain names `H1`.
#[test]
fn workbooks_of_the_laboratorys_package_are_read() {
    for pattern in ["{}_{}", "{}{}"] {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("ADs_deck.xlsx");
        let mut book = rust_xlsxwriter::Workbook::new();
        let sheet = book.add_worksheet().set_name(DIMENSIONS).unwrap();
        for (column, (name, value)) in (1..).zip([("D", 0.1), ("B", 0.75), ("L", 2.68)]) {
            sheet.write_string(0, column, name).unwrap();
            sheet.write_number(1, column, value).unwrap();
        }
        let names = ["H1", "H2", "H3", "A1", "A2", "A3"];
        for (sheet, number) in [
            ("Aerodynamic derivatives", -1.5),
            ("Reduced velocities", 4.0),
            ("Mean wind velocity", 9.0),
        ] {
            let sheet = book.add_worksheet().set_name(sheet).unwrap();
            for row in 0..2_u32 {
                sheet.write_number(row + 1, 0, f64::from(row)).unwrap();
            }
            for (column, name) in (1..).zip(names) {
                let (letter, digit) = name.split_at(1);
                let title = pattern.replacen("{}", letter, 1).replacen("{}", digit, 1);
                sheet.write_string(0, column, title).unwrap();
                for row in 1..3_u32 {
                    let factor = if number == 4.0 { f64::from(row) } else { 1.0 };
                    sheet.write_number(row, column, number * factor).unwrap();
                }
            }
        }
        book.save(&path).unwrap();
        let table = read_workbook(&path, &ReadOptions::default()).unwrap();
        assert_eq!(table.width_m, 0.75);
        let notes = table.header.notes.join("; ");
        assert!(
            notes.contains("width 0.75 m from sheet Dim section model, B"),
            "{notes}"
        );
        assert!(
            notes.contains("does not hold H4*, A4*: taken as zero"),
            "{notes}"
        );
        assert!(table.points(Derivative::A4).iter().all(|p| p.value == 0.0));
        let quasi_steady = ReadOptions {
            missing: Some(crate::aerodynamics::derivatives::Missing::QuasiSteady),
            ..ReadOptions::default()
        };
        let table = read_workbook(&path, &quasi_steady).unwrap();
        let values = table.points(Derivative::H4).iter().map(|p| p.value);
        assert_eq!(values.collect::<Vec<_>>(), [-1.5 / 4.0, -1.5 / 8.0]);
    }
}

/// 8 kB that name a cell far away, and a shared string of 100 MB packed into 100 kB: neither fills the memory.
#[test]
fn workbooks_that_would_fill_the_memory_are_bounded() {
    let dir = tempfile::tempdir().unwrap();
    let far = dir.path().join("far.xlsx");
    let mut book = rust_xlsxwriter::Workbook::new();
    for (name, prefix) in [SPEEDS, REDUCED_VELOCITIES, DERIVATIVES] {
        let sheet = book.add_worksheet().set_name(name).unwrap();
        for (column, d) in (0..).zip(["H1", "H2", "H3", "H4", "A1", "A2", "A3", "A4"]) {
            sheet
                .write_string(0, column, format!("{prefix}{d}"))
                .unwrap();
            sheet.write_number(1, column, 2.0).unwrap();
        }
        sheet.write_number(1_048_575, 16_383, 1.0).unwrap();
    }
    book.save(&far).unwrap();
    let table = read_workbook(&far, &ReadOptions::default()).unwrap();
    assert_eq!(table.points(Derivative::A4).len(), 1);

    let bomb = dir.path().join("bomb.xlsx");
    let mut zip = zip::ZipWriter::new(std::fs::File::create(&bomb).unwrap());
    zip.start_file(
        "xl/sharedStrings.xml",
        zip::write::SimpleFileOptions::default(),
    )
    .unwrap();
    let zeros = vec![b'0'; 1 << 20];
    for _ in 0..100 {
        std::io::Write::write_all(&mut zip, &zeros).unwrap();
    }
    zip.finish().unwrap();
    assert!(std::fs::metadata(&bomb).unwrap().len() < 200_000);
    let message = read_workbook(&bomb, &ReadOptions::default())
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("part xl/sharedStrings.xml: expected parts of at most 64 MiB"),
        "{message}"
    );
}

#[test]
fn files_that_are_no_workbooks_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("text.xlsx");
    std::fs::write(&path, "a text").unwrap();
    let message = refused(path.to_str().unwrap(), &three_frequencies());
    assert!(
        message.starts_with("expected a workbook (.xlsx, .xls, .ods), found"),
        "{message}"
    );
    let missing = read_workbook("no/such.xlsx", &three_frequencies());
    assert!(matches!(missing, Err(Error::Io { .. })));
}

#[test]
fn cells_are_named_as_in_a_spreadsheet() {
    let names = [0, 25, 26, 701, 702].map(|column| cell_name(4, column));
    assert_eq!(names, ["A5", "Z5", "AA5", "ZZ5", "AAA5"]);
}

/// What 1.3 becomes in a spreadsheet of another country.
#[test]
fn a_date_is_no_number() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("dates.xlsx");
    let mut book = rust_xlsxwriter::Workbook::new();
    let sheet = book.add_worksheet();
    sheet.set_name("Aerodynamic Derivatives").unwrap();
    sheet.write_string(0, 1, "H1").unwrap();
    let date = rust_xlsxwriter::ExcelDateTime::from_ymd(2024, 3, 1).unwrap();
    let format = rust_xlsxwriter::Format::new().set_num_format("yyyy-mm-dd");
    sheet
        .write_datetime_with_format(1, 1, &date, &format)
        .unwrap();
    book.save(&path).unwrap();
    let mut book = crate::files::derivatives::xlsx_cells::open(&path).unwrap();
    let sheet = sheet_of(&mut book, DERIVATIVES.0).unwrap().unwrap();
    let refused = number(&sheet, DERIVATIVES.0, 1, 1).unwrap_err().to_string();
    assert_eq!(
        refused,
        "sheet Aerodynamic Derivatives, cell B2: expected a number, found `a date`"
    );
}

/// The same cells stated to be over V* with heave down: arguments divided by 2π, coupling signs turned; a notation needs
/// its argument stated, and columns are looked for by its names.
#[test]
fn a_stated_convention_is_obeyed() {
    let options = |stated| ReadOptions {
        width_m: Some(0.5),
        convention: stated,
        ..ReadOptions::default()
    };
    let stated = StatedConvention {
        argument: Some(Argument::VStar),
        axes: Some(Axes::HeaveDown),
        ..StatedConvention::default()
    };
    let plain = read_workbook(
        fixture("workbook.xlsx"),
        &options(StatedConvention::default()),
    )
    .unwrap();
    let other = read_workbook(fixture("workbook.xlsx"), &options(stated)).unwrap();
    for d in Derivative::ALL {
        for (p, q) in plain.points(d).iter().zip(other.points(d)) {
            assert!((p.v_hat / q.v_hat - TAU).abs() < 1e-14);
            assert_eq!(q.value, p.value * Axes::HeaveDown.sign(d));
        }
    }
    let polimi = StatedConvention::notation(Notation::Polimi);
    let message = refused("workbook.xlsx", &options(polimi));
    assert!(
        message.starts_with("argument: expected it stated"),
        "{message}"
    );
    let polimi = StatedConvention {
        argument: Some(Argument::VStar),
        ..polimi
    };
    let message = refused("workbook.xlsx", &options(polimi));
    assert!(
        message.contains("first row: expected columns named one of p1 to p6"),
        "{message}"
    );
}
