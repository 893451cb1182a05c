//! How bridges are written down: `bridge.toml` ([`BridgeFile`]) and the modes of finite-element programs.
//!
//! Files of programs have for every mode three displacements and three rotations a node along axes of their own. [`WindAxes`] says
//! which way is up and downwind, and nothing is assumed about either. Files that know
//! vertical, lateral and rotation themselves (our own single file, MATLAB `phi`) are in those axes already.

mod abaqus;
mod blocks;
mod field;
mod matlab;
mod modal_data;
mod opensees;
mod section_forces;
mod single_file;
mod table;
mod tables;
mod toml_file;
mod turbsim;
mod wawi;

pub use blocks::{BridgeSectionBlock, DamperBlock, ProfilePoint, StaticBlock, WindBlock};
pub use field::FieldTable;
pub use modal_data::{BridgeModes, Direction, WindAxes, tributary_lengths};
pub use section_forces::{ModalSectionForces, read_section_forces};
pub use single_file::write_modes;
pub use toml_file::{BridgeFile, DampingRatios, ModesBlock, ModesFormat, SearchBlock};

use crate::error::Result;
use std::path::Path;

/// Reads turbulence along the span: a table of columns, or a binary file of TurbSim (`.bts`).
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) when it cannot be read; [`Error::Input`](crate::Error::Input) with file and place for what is
/// wrong in it.
pub fn read_field(path: &Path) -> Result<FieldTable> {
    match path.extension() {
        Some(ending) if ending == turbsim::ENDING => turbsim::read(path),
        _ => field::read(path),
    }
}

/// Modes of bridges that come with the program.
pub mod embedded {
    use super::{BridgeModes, single_file};
    use crate::aerodynamics::derivatives::DerivativeTable;
    use crate::error::{Error, Result};

    /// The Langenuen suspension bridge, MIT © 2022 juelpb.
    const LANGENUEN: &str = include_str!("../../../../data/bridges/langenuen.csv");

    /// Goland's cantilever wing, made for this program.
    const GOLAND: &str = include_str!("../../../../data/bridges/goland.csv");

    /// The suspension bridge of IABSE step 2a, MIT © 2025 Knut Andreas Kvåle.
    const IABSE_2A: &str = include_str!("../../../../data/bridges/iabse-2a.csv");

    /// Name and file of each.
    const BRIDGES: [(&str, &str); 3] = [
        ("langenuen", LANGENUEN),
        ("goland", GOLAND),
        ("iabse-2a", IABSE_2A),
    ];

    /// Derivatives of the girder of IABSE step 2a, so dense that straight lines over `K` are those of the source over `V*`.
    ///
    /// # Errors
    /// [`Error::Input`] for a file that is none.
    pub fn iabse_2a_derivatives() -> Result<DerivativeTable> {
        let text = include_str!("../../../../data/bridges/iabse-2a-derivatives.csv");
        crate::files::derivatives::parse_csv(text)
    }

    /// Modes of an embedded bridge by name.
    ///
    /// # Errors
    /// [`Error::Input`] for a name that is none.
    pub fn modes(name: &str) -> Result<BridgeModes> {
        for (known, text) in BRIDGES {
            if name.eq_ignore_ascii_case(known) {
                return single_file::parse(text);
            }
        }
        let expected = "one of the embedded bridges langenuen, goland and iabse-2a";
        Err(Error::input("modes", expected, format!("`{name}`")))
    }
}
