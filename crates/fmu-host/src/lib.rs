//! An importer for FMUs of co-simulation, FMI 2.0 and 3.0, of whatever origin: unpack, read, check, run.
//!
//! [`Fmu::open`] unpacks into a temporary directory and reads the description; [`Fmu::check`] looks for everything
//! that some importer would stumble over and then runs the FMU; [`Fmu::instantiate`] gives a [`Slave`] to be driven
//! call by call:
//!
//! ```no_run
//! # mod aerodeck { pub mod fmu { pub use aerodeck_fmu_host as importer; } pub use aerodeck_core::error; }
//! use aerodeck::fmu::importer::{Fmu, Value};
//!
//! let fmu = Fmu::open("deck_section.fmu")?;
//! let mut slave = fmu.instantiate("released")?;
//! slave.set("wind_speed", &Value::Real(30.0))?;
//! slave.enter_initialization(0.0, None, None)?;
//! slave.exit_initialization()?;
//! let step_s = 0.01;
//! for i in 0..1000 {
//!     slave.do_step(f64::from(i) * step_s, step_s)?;
//!     println!("{} {}", f64::from(i + 1) * step_s, slave.get("heave")?);
//! }
//! slave.terminate()?;
//! # Ok::<(), aerodeck::error::Error>(())
//! ```
//!
//! The code of an FMU runs in this process: one that crashes takes it along.
#![cfg_attr(not(test), deny(clippy::undocumented_unsafe_blocks))]

use aerodeck_core::{error, flutter, state_space};
use aerodeck_unit::{location, standard};

mod archive;
mod checks;
mod description;
mod findings;
mod growth;
mod library;
mod log;
mod reading;
mod reading_fmi3;
mod replay;
mod simulation;
mod slave;
mod trials;
pub mod xml;

pub use description::{
    Causality, CoSimulation, DefaultExperiment, Initial, ModelDescription, ScalarVariable,
    SimpleType, TypeAttributes, UnitDefinition, Unknown, Value, Variability, VariableType,
};
pub use findings::{CheckReport, FmuFinding, FmuSeverity, Trial};
pub use growth::{GrowthOnset, GrowthPoint, SteppedSearch, growth_by_stepping, onset_by_stepping};
pub use reading_fmi3::array_element_name;
pub use replay::{LS_REF, LS_REF_MANIFEST, ReplayedRun, replay};
pub use slave::{FmuState, Slave};

use crate::error::{Error, Result, ensure};
use crate::xml::Element;
use description::FILE;
use findings::FmuFindings;
use library::Binary;
pub use library::Status;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use tempfile::TempDir;

/// Folders below `binaries/` that may serve this machine, the one of FMI 2.0 first; and the ending of libraries.
fn native() -> (&'static [&'static str], &'static str) {
    use std::env::consts::{ARCH, DLL_EXTENSION, OS};
    let folders: &[&str] = match (OS, ARCH) {
        ("linux", "x86_64") => &["linux64", "x86_64-linux"],
        ("linux", "x86") => &["linux32", "x86-linux"],
        // an archive for importers that look for 64-bit Linux alone
        ("linux", "aarch64") => &["aarch64-linux", "linux64"],
        ("windows", "x86_64") => &["win64", "x86_64-windows"],
        ("windows", "x86") => &["win32", "x86-windows"],
        ("macos", "x86_64") => &["darwin64", "x86_64-darwin"],
        ("macos", "aarch64") => &["aarch64-darwin", "darwin64"],
        _ => &[],
    };
    (folders, DLL_EXTENSION)
}

/// An unpacked FMU.
#[derive(Clone)]
pub struct Fmu {
    path: PathBuf,
    folder: Arc<TempDir>,
    entries: Vec<String>,
    description: Arc<ModelDescription>,
    /// Found while unpacking and reading.
    findings: FmuFindings,
    /// The folder below `binaries/` to take; the first for this machine where none is named.
    platform: Option<String>,
    loaded: OnceLock<Arc<Binary>>,
}

impl Fmu {
    /// Unpacks the FMU and reads its description. Defects of the description do not stop it; [`Fmu::check`] tells them.
    ///
    /// # Errors
    /// [`Error::Io`] when the file cannot be read, [`Error::Input`] naming it when it is no archive, unsafe to unpack, or
    /// holds no well-formed `modelDescription.xml`.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::read(path).map_err(|e| e.in_file(path))
    }

    fn read(path: &Path) -> Result<Self> {
        let (folder, entries, mut findings) = archive::unpack(path)?;
        let file = folder.path().join(FILE);
        let found = entries.iter().take(5).cloned().collect::<Vec<_>>();
        let expected = format_args!("{FILE} at its root");
        ensure(file.is_file(), "archive", expected, found.join(", "))?;
        let bytes = std::fs::read(&file).map_err(|e| Error::io(&file, e))?;
        let root = decoded(bytes)
            .and_then(|text| Element::parse(&text))
            .map_err(|e| e.in_file(FILE))
            .map_err(|e| Error::input("archive", "a readable description", e.to_string()))?;
        let (root, elements) = match root.attribute("fmiVersion") {
            Some(version) if version.starts_with('3') => {
                reading_fmi3::translated(&root, &mut findings)
            }
            _ => (root, Vec::new()),
        };
        let mut description = findings.description(&root);
        description.elements = elements;
        Ok(Self {
            path: path.to_path_buf(),
            folder: Arc::new(folder),
            entries,
            description: Arc::new(description),
            findings,
            platform: None,
            loaded: OnceLock::new(),
        })
    }

    /// The same with the binary of one platform, a folder below `binaries/`.
    #[must_use]
    pub fn on(&self, platform: &str) -> Self {
        Self {
            platform: Some(platform.to_owned()),
            loaded: OnceLock::new(),
            ..self.clone()
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What `modelDescription.xml` says.
    pub fn model_description(&self) -> &ModelDescription {
        &self.description
    }

    /// Files of the archive.
    pub fn entries(&self) -> &[String] {
        &self.entries
    }

    /// Where the archive is unpacked, until this value and all its instances are gone.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Folders below `binaries/` that hold anything, in alphabetical order.
    pub fn platforms(&self) -> Vec<String> {
        let folder = |e: &String| Some(e.strip_prefix("binaries/")?.split_once('/')?.0.to_owned());
        let folders: BTreeSet<String> = self.entries.iter().filter_map(folder).collect();
        folders.into_iter().collect()
    }

    /// The shared library for this machine.
    ///
    /// # Errors
    /// [`Error::Input`] when there is none, with the platforms that there are.
    pub fn binary(&self) -> Result<PathBuf> {
        let (folders, ending) = native();
        let slave = self.description.co_simulation.as_ref();
        let identifier = slave.map_or("", |c| c.model_identifier.as_str());
        let binaries = self.folder.path().join("binaries");
        folders
            .iter()
            .filter(|f| self.platform.as_ref().is_none_or(|p| p == *f))
            .map(|f| binaries.join(f).join(format!("{identifier}.{ending}")))
            .find(|file| file.is_file())
            .ok_or_else(|| {
                let first = folders.first().unwrap_or(&"(this platform)");
                let expected = format!("binaries/{first}/{identifier}.{ending}");
                let found = match &self.platforms()[..] {
                    [] => "no binary at all".to_owned(),
                    others => format!("binaries for {}", others.join(", ")),
                };
                Error::input("archive", expected, found).in_file(&self.path)
            })
    }

    /// A new instance; errors are logged by the FMU, nothing else.
    ///
    /// # Errors
    /// [`Error::Input`] when there is no binary for this machine or it does not load, [`Error::Numerical`] with the log
    /// when the FMU refuses.
    pub fn instantiate(&self, name: &str) -> Result<Slave> {
        Slave::new(&self.load()?, name, &self.description.guid, false)
    }

    /// A new instance with another fingerprint than the one in the description, which a careful FMU refuses.
    pub fn instantiate_with_guid(&self, name: &str, guid: &str) -> Result<Slave> {
        Slave::new(&self.load()?, name, guid, false)
    }

    /// The binary, loaded once.
    fn load(&self) -> Result<Arc<Binary>> {
        if let Some(loaded) = self.loaded.get() {
            return Ok(Arc::clone(loaded));
        }
        let loaded = Binary::load(&self.binary()?, &self.folder, &self.description);
        let loaded = Arc::new(loaded.map_err(|e| e.in_file(&self.path))?);
        Ok(Arc::clone(self.loaded.get_or_init(|| loaded)))
    }
}

/// Text of the description: UTF-8, or Latin-1 where the file says so.
fn decoded(bytes: Vec<u8>) -> Result<String> {
    let bytes = match bytes.strip_prefix(b"\xEF\xBB\xBF") {
        Some(rest) => rest.to_vec(),
        None => bytes,
    };
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(100)]).to_lowercase();
    if head.contains("encoding=\"iso-8859-1\"") || head.contains("encoding='iso-8859-1'") {
        return Ok(bytes.into_iter().map(char::from).collect());
    }
    String::from_utf8(bytes).map_err(|e| {
        let place = format!("byte {}", e.utf8_error().valid_up_to());
        Error::input(place, "UTF-8 text", "other bytes")
    })
}

#[cfg(test)]
mod tests;
