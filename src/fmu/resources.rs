//! The folder `resources/` of an unpacked archive: its location as importers write it, and the model in it.

use super::bridge_options::{BRIDGE_FILE, BridgeOptions};
use super::force_options::{FORCE_FILE, ForceOptions};
use super::identity;
use super::variables::VariableTable;
use crate::aerodynamics::{GustForce, Transfer};
use crate::error::{Error, Result};
use crate::trained_model::TrainedModel;
use std::path::{Path, PathBuf};
use uuid::Uuid;

/// The model's file in `resources/`.
pub const MODEL_FILE: &str = "model.json";
/// The file of the gust forces in `resources/`; an archive without it takes no gusts.
pub const GUST_FILE: &str = "gusts.json";

/// Files beside the model that say what is exported of it, as bytes.
#[derive(Debug, Clone, Copy, Default)]
pub struct OptionFiles<'a> {
    /// What makes it a unit of forces alone, see [`ForceOptions`].
    pub force: Option<&'a [u8]>,
    /// Forces of gusts, see [`GustForce`].
    pub gusts: Option<&'a [u8]>,
}

impl<'a> OptionFiles<'a> {
    /// Of forces alone where there are options of them, without gusts.
    pub fn of_force(force: Option<&'a [u8]>) -> Self {
        Self { force, gusts: None }
    }
}

/// What is read once, at instantiation.
#[derive(Debug)]
pub struct Resources {
    /// The trained model.
    pub model: TrainedModel,
    /// What makes it a unit of forces alone; `None` for the coupled section.
    pub force: Option<ForceOptions>,
    /// Forces of gusts; `None` where it takes no gusts.
    pub gusts: Option<GustForce>,
    /// What makes it a whole bridge; `None` for a section.
    pub bridge: Option<BridgeOptions>,
    /// Its variables.
    pub table: VariableTable,
    /// Identity of table and model file.
    pub guid: Uuid,
}

impl Resources {
    /// Reads `model.json` from the folder that `location` names (see [`folder_of`]); where it is not there, from the
    /// folder whose name is the location as it stands, since some importers write paths without coding them. An empty
    /// location means the archive in which this library lies.
    ///
    /// # Errors
    /// [`Error::Input`] for a location that is none and for a file that is no trained model, [`Error::Io`] for a file
    /// that cannot be read; both name the file.
    pub fn read(location: &str) -> Result<Self> {
        let folder = if location.is_empty() {
            own_binary()
                .and_then(|binary| beside(&binary))
                .ok_or_else(|| refused(location))?
        } else {
            folder_of(location)?
        };
        let coded = folder.join(MODEL_FILE);
        let raw = raw_folder(location).map(|folder| folder.join(MODEL_FILE));
        let file = match raw {
            Some(raw) if !coded.exists() && raw.exists() => raw,
            _ => coded,
        };
        let read = |file: &Path| std::fs::read(file).map_err(|e| Error::io(file, e));
        let optional = |name: &str| -> Result<Option<Vec<u8>>> {
            let option = file.with_file_name(name);
            option.exists().then(|| read(&option)).transpose()
        };
        let (force, gusts) = (optional(FORCE_FILE)?, optional(GUST_FILE)?);
        if let Some(bridge) = optional(BRIDGE_FILE)? {
            let place = file.with_file_name(BRIDGE_FILE);
            return Self::of_bridge(&read(&file)?, &bridge).map_err(|e| e.in_file(&place));
        }
        let options = OptionFiles {
            force: force.as_deref(),
            gusts: gusts.as_deref(),
        };
        Self::from_bytes(&read(&file)?, options).map_err(|e| e.in_file(&file))
    }

    /// The same from the bytes of the model's file and of those beside it.
    ///
    /// # Errors
    /// [`Error::Input`] for bytes that are no trained model, or no options that fit it.
    pub fn from_bytes(bytes: &[u8], options: OptionFiles<'_>) -> Result<Self> {
        let model = TrainedModel::from_json(text(bytes)?)?;
        let force = options
            .force
            .map(|options| ForceOptions::from_json(text(options)?).map_err(|e| e.at(FORCE_FILE)))
            .transpose()?;
        let gusts = options
            .gusts
            .map(|gusts| gust_force(text(gusts)?, &model).map_err(|e| e.at(GUST_FILE)))
            .transpose()?;
        let table = VariableTable::new(&model, force.as_ref(), gusts.as_ref())?;
        let files = std::iter::once(bytes);
        let files: Vec<&[u8]> = files.chain(options.force).chain(options.gusts).collect();
        let guid = identity::guid(&table, &files);
        Ok(Self {
            model,
            force,
            gusts,
            bridge: None,
            table,
            guid,
        })
    }

    /// A whole bridge from the bytes of the file of the model of its girder and of the bridge's own.
    ///
    /// # Errors
    /// [`Error::Input`] for bytes that are no trained model, or no bridge.
    pub fn of_bridge(bytes: &[u8], bridge: &[u8]) -> Result<Self> {
        let model = TrainedModel::from_json(text(bytes)?)?;
        let options = BridgeOptions::from_json(text(bridge)?)?;
        let table = VariableTable::of_bridge(&model, &options)?;
        let guid = identity::guid(&table, &[bytes, bridge]);
        Ok(Self {
            model,
            force: None,
            gusts: None,
            bridge: Some(options),
            table,
            guid,
        })
    }
}

fn gust_force(text: &str, model: &TrainedModel) -> Result<GustForce> {
    let force: GustForce = serde_json::from_str(text).map_err(|e| {
        let place = format!("line {}, column {}", e.line(), e.column());
        Error::input(place, "forces of gusts", e.to_string())
    })?;
    force.validate(model.model.dofs())?;
    Ok(force)
}

fn text(bytes: &[u8]) -> Result<&str> {
    std::str::from_utf8(bytes).map_err(|e| {
        Error::input(
            format!("byte {}", e.valid_up_to()),
            "UTF-8 text",
            "other bytes",
        )
    })
}

/// The folder of a resource location: `file:/a`, `file:///a`, `file:////a` and `file://localhost/a`, percent-coded,
/// with or without a slash at the end, drive letters included; also an absolute path without a scheme.
///
/// The result is absolute: nothing depends on the working directory.
///
/// # Errors
/// [`Error::Input`] for an empty location, another scheme, another host, or a relative path.
pub fn folder_of(location: &str) -> Result<PathBuf> {
    let path = local_path(location, cfg!(windows))?;
    let path = PathBuf::from(path);
    if path.is_absolute() {
        Ok(path)
    } else {
        Err(refused(location))
    }
}

/// The path of a file URI without decoding it; `None` where that is no path.
fn raw_folder(location: &str) -> Option<PathBuf> {
    let path = match scheme(location) {
        Some("file") => without_authority(&location[5..], cfg!(windows))?,
        _ => return None,
    };
    let path = PathBuf::from(path);
    path.is_absolute().then_some(path)
}

/// `resources/` of the unpacked archive that holds `binaries/<platform>/<library>`.
fn beside(binary: &Path) -> Option<PathBuf> {
    let folder = binary.parent()?.parent()?.parent()?.join("resources");
    folder.join(MODEL_FILE).exists().then_some(folder)
}

/// The file that this code was loaded from, as far as the system says so without foreign functions.
fn own_binary() -> Option<PathBuf> {
    let here = own_binary as *const () as usize;
    let maps = std::fs::read_to_string("/proc/self/maps").ok()?;
    maps.lines().find_map(|line| {
        let (range, rest) = line.split_once(' ')?;
        let (from, to) = range.split_once('-')?;
        let address = |text| usize::from_str_radix(text, 16).ok();
        let inside = (address(from)?..address(to)?).contains(&here);
        // permissions, offset, device and inode stand before the path
        let path = rest.find('/').map(|at| PathBuf::from(&rest[at..]));
        path.filter(|_| inside)
    })
}

fn refused(location: &str) -> Error {
    Error::input(
        "resource location",
        "a file URI (file:///…) of this machine or an absolute path, or nothing where the library lies in its archive",
        format!("`{location}`"),
    )
}

/// The decoded path of a location; `windows` says whether `/C:/…` is a drive.
fn local_path(location: &str, windows: bool) -> Result<String> {
    let path = match scheme(location) {
        None => location.to_owned(),
        Some("file") => decoded(without_authority(&location[5..], windows).ok_or_else(|| {
            Error::input(
                "resource location",
                "a file URI without host, or with the host `localhost`",
                format!("`{location}`"),
            )
        })?)
        .ok_or_else(|| refused(location))?,
        Some(_) => return Err(refused(location)),
    };
    if path.is_empty() || path.contains('\0') {
        return Err(refused(location));
    }
    let drive = path.len() >= 3 && is_drive(&path[1..]) && path.starts_with('/');
    Ok(if windows && drive {
        path[1..].to_owned()
    } else {
        path
    })
}

/// The scheme in front of the first colon, in lower case if it is `file`; a single letter is a drive, not a scheme.
fn scheme(location: &str) -> Option<&str> {
    let (scheme, _) = location.split_once(':')?;
    let word = scheme
        .bytes()
        .all(|c| c.is_ascii_alphanumeric() || matches!(c, b'+' | b'.' | b'-'));
    if scheme.len() < 2 || !word {
        None
    } else if scheme.eq_ignore_ascii_case("file") {
        Some("file")
    } else {
        Some(scheme)
    }
}

fn is_drive(text: &str) -> bool {
    let b = text.as_bytes();
    b.len() >= 2 && b[0].is_ascii_alphabetic() && b[1] == b':'
}

/// The path after `file:`; `None` when a host other than this one is named.
fn without_authority(rest: &str, windows: bool) -> Option<&str> {
    let Some(after) = rest.strip_prefix("//") else {
        return Some(rest);
    };
    if is_drive(after) {
        return Some(after); // file://C:/… , as some importers write it
    }
    let slash = after.find('/').unwrap_or(after.len());
    let (host, path) = after.split_at(slash);
    if !host.is_empty() && !host.eq_ignore_ascii_case("localhost") {
        return None;
    }
    if windows && path.starts_with("//") {
        return Some(path); // a share: file:////server/share
    }
    // file:////a, as importers write it that put `file:///` in front of an absolute path
    let leading = path.len() - path.trim_start_matches('/').len();
    Some(&path[leading.saturating_sub(1)..])
}

/// Percent-decoding; `%` without two hexadecimal digits stands for itself, since not every importer codes.
fn decoded(path: &str) -> Option<String> {
    let bytes = path.as_bytes();
    let digit = |at: usize| bytes.get(at).and_then(|c| (*c as char).to_digit(16));
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        match (bytes[i], digit(i + 1), digit(i + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push((high * 16 + low) as u8);
                i += 3;
            }
            (c, ..) => {
                out.push(c);
                i += 1;
            }
        }
    }
    String::from_utf8(out).ok()
}

/// The location of a folder as a file URI, `file:///…`, percent-coded.
///
/// # Errors
/// [`Error::Input`] for a path that is relative or no UTF-8.
pub fn location_of(folder: &Path) -> Result<String> {
    let text = folder.to_str().filter(|_| folder.is_absolute());
    let text = text.ok_or_else(|| refused(&folder.display().to_string()))?;
    let mut uri = String::from("file://");
    if !text.starts_with('/') {
        uri.push('/');
    }
    for byte in text.replace('\\', "/").bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b'~' | b':' => {
                uri.push(byte as char);
            }
            other => uri.push_str(&format!("%{other:02X}")),
        }
    }
    Ok(uri)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_of_a_location_is_understood() {
        for (location, path) in [
            ("file:///home/u/resources", "/home/u/resources"),
            ("file:///home/u/resources/", "/home/u/resources/"),
            ("file:/home/u/resources", "/home/u/resources"),
            ("file:////home/u/resources", "/home/u/resources"),
            ("file://localhost/home/u", "/home/u"),
            ("FILE:///home/u", "/home/u"),
            ("file:///a%20b/Br%C3%BCcke", "/a b/Brücke"),
            ("file:///a b/Brücke", "/a b/Brücke"),
            ("file:///100%/x%2", "/100%/x%2"),
            ("/home/u v/resources", "/home/u v/resources"),
        ] {
            assert_eq!(local_path(location, false).unwrap(), path, "{location}");
            assert_eq!(folder_of(location).unwrap(), PathBuf::from(path));
        }
    }

    /// `%20` may be coded, or part of the folder's name.
    #[test]
    fn uncoded_locations_are_tried_second() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("a%20b");
        std::fs::create_dir(&place).unwrap();
        let model = format!(
            "{}/tests/data/models/rational.json",
            env!("CARGO_MANIFEST_DIR")
        );
        std::fs::copy(&model, place.join(MODEL_FILE)).unwrap();
        let coded = location_of(&place).unwrap();
        let raw = format!("file://{}", place.display());
        assert_ne!(coded, raw);
        for location in [coded, raw] {
            assert!(Resources::read(&location).is_ok(), "{location}");
        }
    }

    #[test]
    fn a_library_knows_its_archive() {
        let folder = tempfile::tempdir().unwrap();
        let library = folder.path().join("binaries/linux64/x.so");
        assert_eq!(beside(&library), None);
        let resources = folder.path().join("resources");
        std::fs::create_dir(&resources).unwrap();
        std::fs::write(resources.join(MODEL_FILE), "{}").unwrap();
        assert_eq!(beside(&library), Some(resources));
        #[cfg(target_os = "linux")]
        assert_eq!(own_binary(), std::env::current_exe().ok());
    }

    #[test]
    fn drives_and_shares() {
        for (location, path) in [
            ("file:///C:/t", "C:/t"),
            ("file:/C:/t", "C:/t"),
            ("file://C:/t", "C:/t"),
            ("file:////C:/t", "//C:/t"),
            ("file:////server/share", "//server/share"),
            ("C:\\t", "C:\\t"),
        ] {
            assert_eq!(local_path(location, true).unwrap(), path, "{location}");
        }
    }

    #[test]
    fn other_locations_are_refused() {
        for location in [
            "",
            "file:",
            "file://",
            "file://elsewhere/home",
            "http://example.org/resources",
            "relative/resources",
            "file:relative",
            "file:///a%00b",
            "file:///a%FFb",
        ] {
            let message = folder_of(location).unwrap_err().to_string();
            assert!(message.starts_with("resource location: expected"));
            assert!(message.contains(location));
        }
    }

    #[test]
    fn written_locations_are_read_back() {
        for path in ["/a b/Brücke/100%/#1?", "/plain"] {
            let uri = location_of(Path::new(path)).unwrap();
            assert!(uri.is_ascii() && !uri.contains(' '), "{uri}");
            assert_eq!(folder_of(&uri).unwrap(), PathBuf::from(path));
        }
    }
}
