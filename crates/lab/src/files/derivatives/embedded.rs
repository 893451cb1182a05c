//! Measured decks that come with the program.
//!
//! Section models of the Langenuen bridge girder, tested at NTNU by forced vibration: 18 derivatives at two mean
//! speeds and eight frequencies. MIT License, Copyright (c) 2022 juelpb; the text is in `data/LICENSE`.
//! The files were written by `cargo run --example import_workbook` and hold the figures at full precision.

use crate::aerodynamics::derivatives::DerivativeTable;
use crate::error::{Error, Result};
use crate::files::derivatives::parse_csv;
use crate::files::header_csv::embedded_name;

/// Licence text of the embedded figures.
pub const LICENCE: &str = include_str!("../../../../../data/decks/LICENSE");

/// Content of each file.
const DECKS: [&str; 5] = [
    include_str!("../../../../../data/decks/LN20-5500.csv"),
    include_str!("../../../../../data/decks/LN21-5200.csv"),
    include_str!("../../../../../data/decks/LN21-5500.csv"),
    include_str!("../../../../../data/decks/LN21-5800.csv"),
    include_str!("../../../../../data/decks/LN21-6100.csv"),
];

/// Endings of files that hold tables for other programs.
const OTHER_TABLES: [&str; 8] = ["xls", "xlsm", "xlsb", "ods", "txt", "dat", "tsv", "mat"];

/// Names of the embedded decks.
pub fn names() -> impl Iterator<Item = &'static str> {
    DECKS.into_iter().map(embedded_name)
}

/// An embedded deck by name; case and the kind of dash do not matter (`ln21_5200`).
///
/// # Errors
/// [`Error::Input`] listing the names when there is no such deck.
pub fn deck(name: &str) -> Result<DerivativeTable> {
    let wanted = name.trim().replace('_', "-");
    let named = |text: &&str| embedded_name(text).eq_ignore_ascii_case(&wanted);
    let text = DECKS.into_iter().find(named).ok_or_else(|| {
        let all: Vec<_> = names().collect();
        let expected = format!("one of the embedded decks {}", all.join(", "));
        Error::input("deck", expected, format!("`{name}`"))
    })?;
    parse_csv(text)
}

/// The same where the path of a table could stand as well, which its ending would show.
///
/// # Errors
/// [`Error::Input`] listing the names and the endings when there is no such deck.
pub fn deck_where_files_are_taken(name: &str) -> Result<DerivativeTable> {
    deck(name).map_err(|mut unknown| {
        let ending = std::path::Path::new(name.trim()).extension();
        if ending.is_some_and(|e| OTHER_TABLES.iter().any(|o| e.eq_ignore_ascii_case(o))) {
            let expected = "a table of derivatives as .csv or .xlsx (save it as one of these)";
            return Error::input("deck", expected, format!("the file `{name}`"));
        }
        if let Error::Input(error) = &mut unknown {
            error.expected += ", or a table (.csv, .xlsx, .xls, .ods)";
        }
        unknown
    })
}

#[cfg(test)]
mod tests {
    use crate::aerodynamics::derivatives::Derivative;
    use crate::files::derivatives::embedded::*;
    use crate::section::Dof;

    #[test]
    fn files_of_other_programs_are_no_unknown_decks() {
        for name in ["table.xls", "a/b.ODS", "table.txt"] {
            let said = deck_where_files_are_taken(name).unwrap_err().to_string();
            assert!(said.contains("as .csv or .xlsx"), "{said}");
        }
    }

    #[test]
    fn every_deck_has_18_derivatives_at_16_points_and_its_width() {
        // Widths to the four digits that the sheets' own figures give, B = V/(2πf V̂).
        let widths = [0.5057, 0.5023, 0.5057, 0.5091, 0.5126];
        for (name, width) in names().zip(widths) {
            let table = deck(name).unwrap();
            assert_eq!(table.name, name);
            assert!(
                (table.width_m - width).abs() < 5e-5,
                "{name}: {}",
                table.width_m
            );
            assert_eq!(table.header.model_length_m, Some(2.68));
            assert!(table.header.licence.contains("Copyright (c) 2022 juelpb"));
            assert_eq!(table.derivatives().count(), 18);
            assert!(Derivative::ALL.iter().all(|d| table.points(*d).len() == 16));
            assert_eq!(table.samples(&Dof::THREE).len(), 18 * 16);
            for i in 0..2 {
                let group = table.at_speed_group(i).unwrap();
                assert!(Derivative::ALL.iter().all(|d| group.points(*d).len() == 8));
            }
        }
        assert!(LICENCE.starts_with("MIT License\n\nCopyright (c) 2022 juelpb"));
    }

    #[test]
    fn mean_speeds_are_those_of_the_tests() {
        let speeds = [
            [5.47, 10.84],
            [8.18, 10.94],
            [6.36, 8.33],
            [6.36, 8.34],
            [6.38, 8.39],
        ];
        for (name, expected) in names().zip(speeds) {
            let found = deck(name).unwrap().speed_groups();
            assert_eq!(found.len(), 2);
            for (v, e) in found.iter().zip(expected) {
                assert!((v - e).abs() < 0.006, "{name}: {v} against {e}");
            }
        }
    }

    #[test]
    fn figures_are_those_of_the_workbook() {
        // First and last cells of the workbook LN21-5200 (P1 row 1, A6 row 16).
        let table = deck("ln21_5200").unwrap();
        let first = table.points(Derivative::P1)[0];
        assert_eq!(first.mean_speed_m_s, Some(8.187888031368372));
        assert_eq!(first.v_hat, 10.377701906401262);
        assert_eq!(first.value, -2.5444751604141307);
        assert_eq!(
            table.points(Derivative::A6)[15].value,
            3.8560301625805385E-2
        );
        assert_eq!(table.points(Derivative::A6)[15].v_hat, 1.3847575743508256);
    }

    #[test]
    fn an_unknown_deck_lists_the_known_ones() {
        assert_eq!(
            deck_where_files_are_taken("LN22").unwrap_err().to_string(),
            "deck: expected one of the embedded decks LN20-5500, LN21-5200, LN21-5500, LN21-5800, LN21-6100, or a table (.csv, .xlsx, .xls, .ods), found `LN22`"
        );
    }
}
