//! Runtime binaries: the one embedded in this program, and others from a folder.

use crate::error::{Error, Result};
use crate::fmu::identity::MODEL_IDENTIFIER;
use std::borrow::Cow;
use std::path::Path;

/// Environment variable that names a folder of runtimes for further platforms, laid out as in an FMU:
/// `linux64/aerodeck_section.so`, `win64/aerodeck_section.dll`, `darwin64/aerodeck_section.dylib`,
/// `aarch64-linux/aerodeck_section.so`, …
pub const RUNTIME_DIR_VARIABLE: &str = "AERODECK_RUNTIME_DIR";

/// Platform folders below `binaries/`, ending of the library, how it begins, name in words.
const PLATFORMS: [(&str, &str, &[u8], &str); 7] = [
    ("aarch64-darwin", "dylib", MACH_O, "macOS, Apple silicon"),
    ("aarch64-linux", "so", ELF, "Linux, 64-bit ARM"),
    ("darwin64", "dylib", MACH_O, "macOS, 64-bit Intel"),
    ("linux32", "so", ELF, "Linux, 32-bit Intel"),
    ("linux64", "so", ELF, "Linux, 64-bit Intel/AMD"),
    ("win32", "dll", PE, "Windows, 32-bit"),
    ("win64", "dll", PE, "Windows, 64-bit"),
];
const ELF: &[u8] = b"\x7fELF";
const PE: &[u8] = b"MZ";
const MACH_O: &[u8] = b"\xcf\xfa\xed\xfe";

static EMBEDDED: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/aerodeck_section"));

/// A runtime binary for one platform.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Runtime {
    /// Folder below `binaries/`.
    pub platform: &'static str,
    /// The shared library.
    pub bytes: Cow<'static, [u8]>,
    /// Ending of the library's name.
    extension: &'static str,
}

impl Runtime {
    /// The runtime for the platform this program was built for; it is part of the program.
    ///
    /// # Errors
    /// [`Error::Input`] when the program was built without (under an interpreter of Rust code).
    pub fn embedded() -> Result<Self> {
        Self::new(env!("AERODECK_RUNTIME_PLATFORM"), Cow::Borrowed(EMBEDDED))
    }

    /// The embedded runtime and those in the folder that [`RUNTIME_DIR_VARIABLE`] names, if it is set. A runtime of
    /// the folder takes the place of the embedded one for the same platform.
    pub fn available() -> Result<Vec<Self>> {
        let mut all = match std::env::var_os(RUNTIME_DIR_VARIABLE) {
            Some(folder) => Self::in_folder(Path::new(&folder))?,
            None => Vec::new(),
        };
        let embedded = Self::embedded()?;
        if all.iter().all(|r| r.platform != embedded.platform) {
            all.push(embedded);
            all.sort_by_key(|r| r.platform);
        }
        Ok(all)
    }

    /// The runtimes in a folder laid out as `binaries/` of an FMU, in alphabetical order of the platforms.
    ///
    /// # Errors
    /// [`Error::Io`] for a folder or file that cannot be read, [`Error::Input`] for a folder without any runtime and
    /// for files that are no library of their platform.
    pub fn in_folder(folder: &Path) -> Result<Vec<Self>> {
        std::fs::read_dir(folder).map_err(|e| Error::io(folder, e))?;
        let mut found = Vec::new();
        for (platform, extension, ..) in PLATFORMS {
            let file = folder
                .join(platform)
                .join(format!("{MODEL_IDENTIFIER}.{extension}"));
            if file.is_file() {
                let bytes = std::fs::read(&file).map_err(|e| Error::io(&file, e))?;
                found.push(Self::new(platform, Cow::Owned(bytes)).map_err(|e| e.in_file(&file))?);
            }
        }
        if found.is_empty() {
            return Err(Error::input(
                RUNTIME_DIR_VARIABLE,
                format!("a folder with, for example, linux64/{MODEL_IDENTIFIER}.so"),
                "none of these",
            )
            .in_file(folder));
        }
        Ok(found)
    }

    fn new(platform: &str, bytes: Cow<'static, [u8]>) -> Result<Self> {
        let known = PLATFORMS.into_iter().find(|(name, ..)| *name == platform);
        let Some((platform, extension, magic, words)) = known else {
            return Err(Error::input("runtime", "a platform of FMI", platform));
        };
        if !bytes.starts_with(magic) {
            return Err(Error::input(
                format!("runtime for {platform}"),
                format!("a shared library ({words})"),
                format!("{} other bytes", bytes.len()),
            ));
        }
        Ok(Self {
            platform,
            bytes,
            extension,
        })
    }

    /// The platform in words.
    pub fn platform_words(&self) -> &'static str {
        PLATFORMS
            .iter()
            .find(|(name, ..)| *name == self.platform)
            .map_or(self.platform, |(.., words)| words)
    }

    /// Path of the library in the archive.
    pub fn path_in_archive(&self) -> String {
        format!(
            "binaries/{}/{MODEL_IDENTIFIER}.{}",
            self.platform, self.extension
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_embedded_runtime_is_for_this_platform() {
        let runtime = Runtime::embedded().unwrap();
        let path = runtime.path_in_archive();
        assert!(path.starts_with("binaries/"), "{path}");
        assert!(runtime.bytes.len() > 100_000);
    }

    #[test]
    fn folders_of_runtimes_are_read_and_checked() {
        let folder = tempfile::tempdir().unwrap();
        let empty = Runtime::in_folder(folder.path()).unwrap_err().to_string();
        assert!(empty.contains("none of these"), "{empty}");
        for (platform, extension, bytes) in [("win64", "dll", "MZ…"), ("darwin64", "dylib", "MZ…")]
        {
            let inside = folder.path().join(platform);
            std::fs::create_dir(&inside).unwrap();
            std::fs::write(inside.join(format!("aerodeck_section.{extension}")), bytes).unwrap();
        }
        let wrong = Runtime::in_folder(folder.path()).unwrap_err().to_string();
        assert!(
            wrong.contains("darwin64") && wrong.contains("macOS"),
            "{wrong}"
        );
        std::fs::remove_dir_all(folder.path().join("darwin64")).unwrap();
        let found = Runtime::in_folder(folder.path()).unwrap();
        assert_eq!(found.len(), 1);
        assert_eq!(
            found[0].path_in_archive(),
            "binaries/win64/aerodeck_section.dll"
        );
        assert!(Runtime::in_folder(&folder.path().join("missing")).is_err());
    }
}
