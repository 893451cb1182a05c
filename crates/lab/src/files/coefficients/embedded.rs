//! Static coefficients that come with the program.
//!
//! The thin flat plate in closed form, and a box girder made up for examples and tests: its figures are of the size
//! measured on streamlined decks, but no deck has been tested for them.

use crate::aerodynamics::quasi_steady::StaticCoefficients;
use crate::error::{Error, Result};
use crate::files::coefficients::csv_file::parse_coefficients;
use crate::files::header_csv::embedded_name;

/// Content of each file.
const TABLES: [&str; 2] = [
    include_str!("../../../../../data/coefficients/flat_plate.csv"),
    include_str!("../../../../../data/coefficients/synthetic_box_girder.csv"),
];

/// Names of the embedded tables.
pub fn names() -> impl Iterator<Item = &'static str> {
    TABLES.into_iter().map(embedded_name)
}

/// An embedded table by name; case does not matter.
///
/// # Errors
/// [`Error::Input`] listing the names when there is no such table.
pub fn coefficients(name: &str) -> Result<StaticCoefficients> {
    let named = |text: &&str| embedded_name(text).eq_ignore_ascii_case(name.trim());
    let text = TABLES.into_iter().find(named).ok_or_else(|| {
        let all = names().collect::<Vec<_>>().join(", ");
        let expected = format!("one of the embedded tables {all}, or a table (.csv)");
        Error::input("static coefficients", expected, format!("`{name}`"))
    })?;
    parse_coefficients(text)
}

#[cfg(test)]
mod tests {
    use crate::files::coefficients::embedded::*;
    use std::f64::consts::PI;

    #[test]
    fn the_flat_plate_has_the_slopes_of_thin_airfoil_theory() {
        let plate = coefficients("Flat plate").unwrap();
        for degrees in [-9.5_f64, -3.3, 0.0, 4.4, 9.9] {
            let at = plate.at(degrees.to_radians()).unwrap();
            assert!((at.lift_slope - 2.0 * PI).abs() < 1e-12);
            assert!((at.moment_slope - PI / 2.0).abs() < 1e-12);
            assert!((at.lift - 2.0 * PI * degrees.to_radians()).abs() < 1e-13);
            assert!((at.drag - 0.01).abs() < 1e-15 && at.drag_slope.abs() < 1e-13);
        }
        let message = coefficients("wing").unwrap_err().to_string();
        assert!(
            message.contains("flat plate, synthetic box girder"),
            "{message}"
        );
    }
}
