//! Static coefficients: this project's CSV, the tables that come with the program, and either by its name.

mod csv_file;
pub mod embedded;

pub use csv_file::write_coefficients;

use crate::aerodynamics::quasi_steady::StaticCoefficients;
use crate::aerodynamics::{GustForce, RationalAdmittance};
use crate::error::{Error, Result};
use crate::files::text::parsed;
use crate::section::Dof;
use csv_file::parse_coefficients;
use std::path::Path;

/// The static coefficients of that name: an embedded table, or a file (`.csv`) whose path is read against `directory`.
pub fn named_coefficients(name: &str, directory: &Path) -> Result<StaticCoefficients> {
    if name.to_lowercase().ends_with(".csv") {
        parsed(&directory.join(name), parse_coefficients)
    } else {
        embedded::coefficients(name)
    }
}

/// Forces of gusts by quasi-steady theory on a section with these motions, from the static coefficients of that name: an
/// embedded table, or a file (`.csv`).
///
/// # Errors
/// [`Error::Input`] for an admittance (over the frequency; `None` where gusts are not asked for) without coefficients, an unknown
/// name, coefficients that do not reach rotation zero or say nothing of a motion; [`Error::Io`].
pub fn gust_force(
    name: Option<&str>,
    admittance: Option<RationalAdmittance>,
    dofs: &[Dof],
) -> Result<Option<GustForce>> {
    match (name, admittance) {
        (None, None) => Ok(None),
        (None, Some(_)) => {
            let expected = "a table of static coefficients with it, through which gusts act";
            Err(Error::input("admittance", expected, "none"))
        }
        (Some(name), admittance) => {
            let table = named_coefficients(name, Path::new("."))?;
            GustForce::quasi_steady(table, dofs, admittance.unwrap_or_default()).map(Some)
        }
    }
}
