//! Where the folder `resources/` of an unpacked archive is, as importers write it.

use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// The model's file in `resources/`.
pub const MODEL_FILE: &str = "model.json";

/// The folder of a resource location: `file:/a`, `file:///a`, `file:////a` and `file://localhost/a`, percent-coded,
/// with or without a slash at the end, drive letters included; also an absolute path without a scheme.
///
/// The result is absolute: nothing depends on the working directory.
///
/// # Errors
/// [`Error::Input`] for an empty location, another scheme, another host, or a relative path.
pub(crate) fn folder_of(location: &str) -> Result<PathBuf> {
    let path = local_path(location, cfg!(windows))?;
    let path = PathBuf::from(path);
    if path.is_absolute() {
        Ok(path)
    } else {
        Err(refused(location))
    }
}

/// The path of a file URI without decoding it; `None` where that is no path.
pub(super) fn raw_folder(location: &str) -> Option<PathBuf> {
    let path = match scheme(location) {
        Some("file") => without_authority(&location[5..], cfg!(windows))?,
        _ => return None,
    };
    let path = PathBuf::from(path);
    path.is_absolute().then_some(path)
}

/// `resources/` of the unpacked archive that holds `binaries/<platform>/<library>`.
pub(super) fn beside(binary: &Path) -> Option<PathBuf> {
    let folder = binary.parent()?.parent()?.parent()?.join("resources");
    folder.join(MODEL_FILE).exists().then_some(folder)
}

/// The file that this code was loaded from, as far as the system says so without foreign functions.
pub(super) fn own_binary() -> Option<PathBuf> {
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

pub(super) fn refused(location: &str) -> Error {
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
