//! Workbooks of derivatives written as NTNU keeps them; [`super::read_table_with`] reads them.
//!
//! Three sheets, each with a row of names and one row per test point; see [`super::workbook`] for the layout. Derivatives that the
//! table does not hold have no columns. A fourth sheet, `Notes`, which other readers of the layout do not look at, says where
//! the figures come from, in which convention they are, and which width belongs to them.

use crate::aerodynamics::derivatives::notation::{Convention, ExpressedPoint, ExpressedTable};
use crate::aerodynamics::derivatives::{Derivative, DerivativeTable};
use crate::error::{Error, Result, ensure};
use crate::files::derivatives::workbook::{DERIVATIVES, DOUBTS, NOTES, REDUCED_VELOCITIES, SPEEDS};
use rust_xlsxwriter::{Workbook, Worksheet, XlsxError};

/// One number of a test point.
type Number = fn(&ExpressedPoint) -> f64;

/// The bytes of a workbook with the figures of `table` in `convention`: columns called as in the notation, the argument
/// in the sheet of reduced velocities; the notes state it, and the reader obeys them.
///
/// # Errors
/// [`Error::Input`] when a point has no mean speed, which the layout needs; [`Error::Numerical`] when the workbook cannot be made.
pub fn workbook_bytes_in(table: &DerivativeTable, convention: &Convention) -> Result<Vec<u8>> {
    let place = |d: Derivative| format!("table {}, {d}", table.name);
    for d in table.derivatives() {
        let all_stated = table.points(d).iter().all(|p| p.mean_speed_m_s.is_some());
        let expected = "the mean speed of every point, as workbooks have it (a .csv needs none)";
        ensure(all_stated, place(d), expected, "a point without")?;
    }
    let failed = |e: XlsxError| Error::Numerical(format!("workbook: {e}"));
    let mut book = Workbook::new();
    let expressed = convention.express(table);
    let columns: [(_, Number); 3] = [
        (SPEEDS, |p| p.mean_speed_m_s.unwrap_or(f64::NAN)),
        (REDUCED_VELOCITIES, |p| p.argument),
        (DERIVATIVES, |p| p.value),
    ];
    for ((name, prefix), value) in columns {
        let sheet = book.add_worksheet();
        write_sheet(sheet, name, prefix, &expressed, value).map_err(failed)?;
    }
    let header = &table.header;
    let (width, doubts) = (table.width_m.to_string(), header.doubts.join("\n"));
    let mut lines = vec![
        ("name", table.name.as_str()),
        ("width_m", &width),
        ("source", &header.source),
        ("licence", &header.licence),
        ("generator", &header.generator),
        ("notation", convention.notation.name()),
        ("argument", convention.argument.definition()),
        ("axes", convention.axes.words()),
        ("definition", convention.notation.definition()),
    ];
    lines.extend((!doubts.is_empty()).then_some((DOUBTS, doubts.as_str())));
    write_notes(book.add_worksheet(), &lines).map_err(failed)?;
    book.save_to_buffer().map_err(failed)
}

fn write_sheet(
    sheet: &mut Worksheet,
    name: &str,
    prefix: &str,
    table: &ExpressedTable,
    value: Number,
) -> std::result::Result<(), XlsxError> {
    sheet.set_name(name)?;
    for (column, derivative) in (0_u16..).zip(&table.derivatives) {
        sheet.write_string(0, column, format!("{prefix}{}", derivative.name))?;
        for (row, point) in (1_u32..).zip(&derivative.points) {
            sheet.write_number(row, column, value(point))?;
        }
    }
    Ok(())
}

/// Writes keys and their values into the sheet of notes.
fn write_notes(
    sheet: &mut Worksheet,
    lines: &[(&str, &str)],
) -> std::result::Result<(), XlsxError> {
    sheet.set_name(NOTES)?;
    for (row, (key, value)) in (0_u32..).zip(lines) {
        sheet.write_string(row, 0, *key)?;
        sheet.write_string(row, 1, *value)?;
    }
    Ok(())
}

/// What stands in the sheet of instructions of an empty workbook.
const INSTRUCTIONS: [&str; 6] = [
    "Fill in the sheet Derivatives: one row for each reduced velocity, one column for each derivative.",
    "A cell may be empty where a derivative was not measured; columns may be left out (H4*, A4*, those of sway).",
    "The first column is the argument that its name says. Rows may stand in any number of mean speeds: add a column mean_speed_m_s.",
    "The sheet Notes states notation, argument and axes; change it where your table is in others (aerodeck derivatives notations).",
    "width_m in Notes is the full width B of the section model, m.",
    "Then: aerodeck derivatives show THIS.xlsx, aerodeck new --workbook THIS.xlsx, aerodeck study study.toml",
];

/// An empty workbook in a convention: a row of names, notes that state the convention, instructions.
///
/// # Errors
/// [`Error::Numerical`] when the workbook cannot be made.
pub fn template_bytes(convention: &Convention) -> Result<Vec<u8>> {
    template(convention).map_err(|e| Error::Numerical(format!("workbook: {e}")))
}

fn template(convention: &Convention) -> std::result::Result<Vec<u8>, XlsxError> {
    let mut book = Workbook::new();
    let sheet = book.add_worksheet();
    sheet.set_name("Derivatives")?;
    sheet.write_string(0, 0, convention.argument.name())?;
    for (column, derivative) in (1_u16..).zip(Derivative::ALL) {
        let name = convention.notation.name_of(derivative);
        sheet.write_string(0, column, format!("{name}*"))?;
    }
    sheet.set_freeze_panes(1, 1)?;
    let notes = book.add_worksheet();
    let lines = [
        ("notation", convention.notation.name()),
        ("argument", convention.argument.definition()),
        ("axes", convention.axes.words()),
    ];
    write_notes(notes, &lines)?;
    notes.write_string(3, 0, "width_m")?;
    let text = book.add_worksheet();
    text.set_name("Instructions")?;
    for (row, line) in (0_u32..).zip(INSTRUCTIONS) {
        text.write_string(row, 0, line)?;
    }
    book.save_to_buffer()
}

#[cfg(test)]
mod tests {
    use crate::files::derivatives::ReadOptions;
    use crate::files::derivatives::embedded;
    use crate::files::derivatives::read_table_with;
    use crate::files::derivatives::workbook_writer::*;
    use std::collections::BTreeMap;

    fn round_trip(table: &DerivativeTable) -> DerivativeTable {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("AerodynamicDerivatives_round.xlsx");
        std::fs::write(
            &path,
            workbook_bytes_in(table, &Convention::default()).unwrap(),
        )
        .unwrap();
        let options = ReadOptions {
            width_m: Some(table.width_m),
            ..ReadOptions::default()
        };
        read_table_with(&path, &options).unwrap().0
    }

    fn same(a: &DerivativeTable, b: &DerivativeTable) {
        assert!(a.derivatives().eq(b.derivatives()));
        for d in a.derivatives() {
            assert_eq!(a.points(d).len(), b.points(d).len());
            for (p, q) in a.points(d).iter().zip(b.points(d)) {
                for (x, y) in [
                    (p.value, q.value),
                    (p.v_hat, q.v_hat),
                    (p.mean_speed_m_s.unwrap(), q.mean_speed_m_s.unwrap()),
                ] {
                    // sixteen digits are written
                    assert!((x - y).abs() <= 1e-12 * x.abs(), "{d}: {x} {y}");
                }
            }
        }
    }

    #[test]
    fn all_eighteen_come_back() {
        let table = embedded::deck("LN21-5200").unwrap();
        same(&table, &round_trip(&table));
        // and without being told the width, which the frequencies give
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("w.xlsx");
        std::fs::write(
            &path,
            workbook_bytes_in(&table, &Convention::default()).unwrap(),
        )
        .unwrap();
        let (again, _) = read_table_with(&path, &ReadOptions::default()).unwrap();
        assert!((again.width_m / table.width_m - 1.0).abs() < 1e-12);
    }

    #[test]
    fn eight_come_back_as_eight() {
        let whole = embedded::deck("LN21-5200").unwrap();
        let eight: BTreeMap<_, _> = whole
            .derivatives()
            .filter(|d| {
                let lateral = crate::section::Dof::Lateral;
                d.force() != lateral && d.motion() != lateral
            })
            .map(|d| (d, whole.points(d).to_vec()))
            .collect();
        let table = DerivativeTable::new("eight", 0.5, Default::default(), eight).unwrap();
        same(&table, &round_trip(&table));
        // without mean speeds there is a way out
        let bare = table.derivatives().map(|d| {
            let mut points = table.points(d)[..3].to_vec();
            points.iter_mut().for_each(|p| p.mean_speed_m_s = None);
            (d, points)
        });
        let bare = DerivativeTable::new("bare", 0.5, Default::default(), bare.collect()).unwrap();
        let said = workbook_bytes_in(&bare, &Convention::default())
            .unwrap_err()
            .to_string();
        assert!(said.contains("(a .csv needs none)"), "{said}");
    }

    /// In every notation, with nothing stated: the notes are obeyed, and a contradiction is refused.
    #[test]
    fn notes_state_the_convention() {
        use crate::aerodynamics::derivatives::notation::Notation;
        use crate::files::derivatives::StatedConvention;
        let table = embedded::deck("LN21-5200").unwrap();
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("w.xlsx");
        for notation in Notation::ALL {
            let convention = Convention::usual(notation);
            std::fs::write(&path, workbook_bytes_in(&table, &convention).unwrap()).unwrap();
            let (again, said) = read_table_with(&path, &ReadOptions::default()).unwrap();
            assert_eq!(said, convention);
            same(&table, &again);
        }
        let options = ReadOptions {
            convention: StatedConvention::notation(Notation::Polimi),
            ..ReadOptions::default()
        };
        let message = read_table_with(&path, &options).unwrap_err().to_string();
        let expected = "notation: expected `polimi` as stated on import, found `starossek`";
        assert!(message.contains(expected), "{message}");
    }
}
