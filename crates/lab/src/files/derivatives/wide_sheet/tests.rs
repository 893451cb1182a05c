//! Workbooks as laboratories send them: titles, units, merged cells, several sheets, commas.

use crate::aerodynamics::derivatives::notation::{Argument, Notation};
use crate::aerodynamics::derivatives::{Derivative, DerivativeTable};
use crate::error::Result;
use crate::files::derivatives::{
    ReadOptions, StatedConvention, embedded, read_table_with, template_bytes,
};
use rust_xlsxwriter::{Format, Workbook, Worksheet};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// The eight derivatives of heave and rotation at each reduced velocity `V/(fB)` of the first mean speed of a deck.
fn rows(deck: &DerivativeTable) -> Vec<[f64; 9]> {
    let of = |d| deck.points(d);
    let names = [
        Derivative::H1,
        Derivative::H2,
        Derivative::H3,
        Derivative::H4,
        Derivative::A1,
        Derivative::A2,
        Derivative::A3,
        Derivative::A4,
    ];
    (0..5)
        .map(|i| {
            let mut row = [0.0; 9];
            row[0] = Argument::VStar.at_v_hat(2.0 + i as f64);
            for (cell, d) in row[1..].iter_mut().zip(names) {
                *cell = of(d)[i].value;
            }
            row
        })
        .collect()
}

const NAMES: [&str; 8] = ["H1*", "H2*", "H3*", "H4*", "A1*", "A2*", "A3*", "A4*"];

/// Writes names from a row on, a row of units, and the numbers.
fn write(sheet: &mut Worksheet, first: u32, argument: &str, names: [&str; 8], scale: f64) {
    sheet.write_string(first, 1, argument).unwrap();
    for (column, name) in (2..).zip(names) {
        sheet.write_string(first, column, name).unwrap();
        sheet.write_string(first + 1, column, "[-]").unwrap();
    }
    for (row, numbers) in (first + 2..).zip(rows(&embedded::deck("LN21-5200").unwrap())) {
        for (column, x) in (1..).zip(numbers) {
            let x = if column == 1 { x } else { scale * x };
            sheet.write_number(row, column, x).unwrap();
        }
    }
}

fn saved(fill: impl FnOnce(&mut Workbook)) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deck.xlsx");
    let mut book = Workbook::new();
    fill(&mut book);
    book.save(&path).unwrap();
    (folder, path)
}

fn in_scanlan(path: &Path) -> Result<DerivativeTable> {
    let convention = StatedConvention {
        notation: Some(Notation::Scanlan),
        ..StatedConvention::default()
    };
    let options = ReadOptions {
        convention,
        width_m: Some(0.4),
        ..ReadOptions::default()
    };
    read_table_with(path, &options).map(|(table, _)| table)
}

fn same(found: &DerivativeTable, scale: f64) {
    let expected = rows(&embedded::deck("LN21-5200").unwrap());
    for (column, d) in (1..).zip([Derivative::H1, Derivative::H2, Derivative::H3]) {
        for (point, row) in found.points(d).iter().zip(&expected) {
            assert_eq!(point.value, scale * row[column]);
            assert!((Argument::VStar.at_v_hat(point.v_hat) / row[0] - 1.0).abs() < 1e-14);
        }
        assert_eq!(found.points(d).len(), expected.len());
    }
}

/// A title, a merged row of groups, names with subscripts, a row of units.
#[test]
fn titles_units_and_merged_cells_are_passed_over() {
    let subscripts = [
        "H₁*", "H_2*", "H 3*", "H4* [-]", "A₁∗", "A2", "A3*", "A4* (-)",
    ];
    let (_folder, path) = saved(|book| {
        let sheet = book.add_worksheet();
        sheet
            .write_string(0, 0, "Section model tests, bridge X, H1 and more")
            .unwrap();
        sheet
            .merge_range(2, 2, 2, 5, "Lift", &Format::new())
            .unwrap();
        sheet
            .merge_range(2, 6, 2, 9, "Moment", &Format::new())
            .unwrap();
        write(sheet, 3, "U/fB", subscripts, 1.0);
    });
    let table = in_scanlan(&path).unwrap();
    same(&table, 1.0);
    assert_eq!(table.width_m, 0.4);
    // the name says which deck it is, and no sheet where there is one
    assert_eq!(table.name, "deck");
}

/// A sheet for each angle: the one that is meant has to be named.
#[test]
fn one_of_several_sheets_is_named() {
    let (_folder, path) = saved(|book| {
        for (name, scale) in [("Angle 0", 1.0), ("Angle +3", 2.0)] {
            let sheet = book.add_worksheet();
            sheet.set_name(name).unwrap();
            write(sheet, 0, "V*", NAMES, scale);
        }
        book.add_worksheet().set_name("Photos").unwrap();
    });
    let message = in_scanlan(&path).unwrap_err().to_string();
    let said = "workbook: expected the sheet that is meant, as `--sheet` or behind the name of the file (`table.xlsx#SHEET`), found \
                derivatives in `Angle 0`, `Angle +3`";
    assert!(message.ends_with(said), "{message}");
    let of = |sheet: &str| in_scanlan(Path::new(&format!("{}#{sheet}", path.display())));
    same(&of("Angle 0").unwrap(), 1.0);
    same(&of("angle +3").unwrap(), 2.0);
    let message = of("Photos").unwrap_err().to_string();
    assert!(
        message.contains("sheet Photos: expected a row of names such as `V*`, `H1*`"),
        "{message}"
    );
    let message = of("Angle 5").unwrap_err().to_string();
    assert!(
        message.contains("expected a sheet `Angle 5`, found `Angle 0`, `Angle +3`, `Photos`"),
        "{message}"
    );
}

/// `Vred` does not say what it is; a text is no number; both are said with sheet and row.
#[test]
fn what_is_not_understood_is_named() {
    let (_folder, path) = saved(|book| write(book.add_worksheet(), 0, "Vred", NAMES, 1.0));
    let message = in_scanlan(&path).unwrap_err().to_string();
    assert!(
        message.contains("argument: expected it stated"),
        "{message}"
    );
    let mut options = ReadOptions::default();
    options.convention.notation = Some(Notation::Scanlan);
    options.convention.argument = Some(Argument::VStar);
    same(&read_table_with(&path, &options).unwrap().0, 1.0);
    let (_folder, path) = saved(|book| write(book.add_worksheet(), 0, "k", NAMES, 1.0));
    let message = in_scanlan(&path).unwrap_err().to_string();
    assert!(
        message.contains("argument: expected it stated"),
        "{message}"
    );
    let (_folder, path) = saved(|book| {
        let sheet = book.add_worksheet();
        write(sheet, 0, "V*", NAMES, 1.0);
        sheet.write_string(4, 3, "n. a.").unwrap();
    });
    let message = in_scanlan(&path).unwrap_err().to_string();
    assert!(
        message.contains("sheet Sheet1, line 5, column H2*: expected a number, found `n. a.`"),
        "{message}"
    );
}

/// As programs write formulas that no spreadsheet has evaluated yet: they are no cells that were not measured.
#[test]
fn a_formula_without_a_value_is_no_empty_cell() {
    let (folder, path) = saved(|book| {
        let sheet = book.add_worksheet();
        write(sheet, 0, "V*", NAMES, 1.0);
        sheet.write_formula(4, 3, "=2*C5").unwrap();
    });
    let mut archive = zip::ZipArchive::new(std::fs::File::open(&path).unwrap()).unwrap();
    let bare = folder.path().join("bare.xlsx");
    let mut written = zip::ZipWriter::new(std::fs::File::create(&bare).unwrap());
    for i in 0..archive.len() {
        let mut part = archive.by_index(i).unwrap();
        let mut bytes = Vec::new();
        part.read_to_end(&mut bytes).unwrap();
        let name = part.name().unwrap().into_owned();
        if name.ends_with("sheet1.xml") {
            let text = String::from_utf8(bytes).unwrap();
            assert!(text.contains("</f><v>0</v>"));
            bytes = text.replace("</f><v>0</v>", "</f>").into_bytes();
        }
        let plain = zip::write::SimpleFileOptions::default();
        written.start_file(name, plain).unwrap();
        written.write_all(&bytes).unwrap();
    }
    written.finish().unwrap();
    let message = in_scanlan(&bare).unwrap_err().to_string();
    assert!(
        message.contains(
            "sheet Sheet1, line 5, column H2*: expected a number, found `a formula without a value"
        ),
        "{message}"
    );
}

/// A number that was typed with a comma is a number.
#[test]
fn decimal_commas_are_numbers() {
    let (_folder, path) = saved(|book| {
        let sheet = book.add_worksheet();
        write(sheet, 0, "V*", NAMES, 1.0);
        let first = rows(&embedded::deck("LN21-5200").unwrap())[0][1];
        sheet
            .write_string(2, 2, first.to_string().replace('.', ","))
            .unwrap();
    });
    same(&in_scanlan(&path).unwrap(), 1.0);
}

/// What `derivatives template` writes is read when it has been filled in, in the convention of its notes.
#[test]
fn a_template_states_its_convention() {
    let convention = StatedConvention {
        notation: Some(Notation::Polimi),
        ..StatedConvention::default()
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.xlsx");
    std::fs::write(&path, template_bytes(&convention.or_usual()).unwrap()).unwrap();
    let read = read_table_with(&path, &ReadOptions::default());
    let message = read.unwrap_err().to_string();
    // understood, but empty
    assert!(
        message.contains("sheet Derivatives") || message.contains("derivative"),
        "{message}"
    );
}

/// The old format of Excel, and that of LibreOffice.
#[test]
fn other_formats_are_read() {
    for ending in ["xls", "ods"] {
        let path = format!(
            "{}/../../tests/data/wide_table.{ending}",
            env!("CARGO_MANIFEST_DIR")
        );
        let table = in_scanlan(Path::new(&path)).unwrap();
        for (column, d) in [(0, Derivative::H1), (7, Derivative::A4)] {
            let values: Vec<f64> = table.points(d).iter().map(|p| p.value).collect();
            let expected: Vec<f64> = (0..4)
                .map(|r| f64::from(column + 1) + f64::from(r + 1) / 100.0)
                .collect();
            assert_eq!(values, expected, "{ending}, {d}");
        }
        let first = Argument::VStar.at_v_hat(table.points(Derivative::H1)[0].v_hat);
        assert!((first - 4.0).abs() < 1e-14, "{ending}: {first}");
    }
}

/// The reader of the old format panics on the first part of a file, and follows parts that run in a circle until the memory is full.
#[test]
fn damaged_workbooks_are_refused() {
    let whole = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/data/wide_table.xls"
    );
    let whole = std::fs::read(whole).unwrap();
    // sector 8 lists which sector follows which: the ninth, where the directory ends, then follows itself
    let mut circle = whole.clone();
    circle[9 * 512 + 4 * 9] = 9;
    circle[9 * 512 + 4 * 9 + 1..][..3].fill(0);
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, found) in [
        ("half.xls", &whole[..4834], "a part that cannot be read"),
        ("circle.xls", &circle[..], "a part that never ends"),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let refused = in_scanlan(&path).unwrap_err().to_string();
        let expected = format!("{name}: expected a workbook (.xlsx, .xls, .ods), found {found}");
        assert!(refused.ends_with(&expected), "{refused}");
    }
}

/// A comma among points is one of thousands.
#[test]
fn commas_and_points_in_texts_are_refused() {
    let (_folder, path) = saved(|book| {
        let sheet = book.add_worksheet();
        write(sheet, 0, "V*", NAMES, 1.0);
        sheet.write_string(2, 2, "1,029").unwrap();
        sheet.write_string(3, 2, "0.1234").unwrap();
    });
    let refused = in_scanlan(&path).unwrap_err().to_string();
    assert!(
        refused.contains(
            "cell C3: expected a point in the number, as in `0.1234` of cell C4, found `1,029`"
        ),
        "{refused}"
    );
}

/// A date above the table is none of its numbers; one in it is none at all.
#[test]
fn only_dates_in_the_table_are_refused() {
    let dated = |row| {
        saved(|book| {
            let sheet = book.add_worksheet();
            write(sheet, 2, "V*", NAMES, 1.0);
            let date = rust_xlsxwriter::ExcelDateTime::from_ymd(2021, 11, 3).unwrap();
            let format = Format::new().set_num_format("yyyy-mm-dd");
            sheet
                .write_datetime_with_format(row, 2, &date, &format)
                .unwrap();
        })
    };
    let (_folder, path) = dated(0);
    same(&in_scanlan(&path).unwrap(), 1.0);
    let (_folder, path) = dated(4);
    let refused = in_scanlan(&path).unwrap_err().to_string();
    assert!(
        refused.contains("line 5") && refused.contains("a date"),
        "{refused}"
    );
}
