//! Runtime binaries: the one embedded in this program, and others from a folder.

use crate::error::{Error, Result, ensure};
use crate::fmu::vocabulary::{FmiVersion, MODEL_IDENTIFIER};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// Environment variable that names a folder of runtimes for further platforms, laid out as in an FMU:
/// `linux64/aerodeck_section.so`, `win64/aerodeck_section.dll`, `darwin64/aerodeck_section.dylib`,
/// `aarch64-linux/aerodeck_section.so`, …
pub(crate) const RUNTIME_DIR_VARIABLE: &str = "AERODECK_RUNTIME_DIR";

/// Folder of the module for WebAssembly, which is no runtime of an FMU but is made and found as one.
const LIVE: &str = "wasm32";

/// Folder of the runtime as a component for WebAssembly, of the draft FMI-LS-WASM: it is packed only where it is asked for.
pub(crate) const COMPONENT: &str = "wasm32-wasip2";

/// Platform folders below `binaries/`, ending of the library, how it may begin, name in words.
const PLATFORMS: [(&str, &str, &[&[u8]], &str); 8] = [
    ("aarch64-darwin", "dylib", DYLIB, "macOS, Apple silicon"),
    ("aarch64-linux", "so", ELF, "Linux, 64-bit ARM"),
    ("darwin64", "dylib", DYLIB, "macOS, 64-bit Intel"),
    ("linux32", "so", ELF, "Linux, 32-bit Intel"),
    ("linux64", "so", ELF, "Linux, 64-bit Intel/AMD"),
    (COMPONENT, "wasm", WASM, "WebAssembly, for FMI 3.0"),
    ("win32", "dll", PE, "Windows, 32-bit"),
    ("win64", "dll", PE, "Windows, 64-bit"),
];
const ELF: &[&[u8]] = &[b"\x7fELF"];
const WASM: &[&[u8]] = &[b"\0asm\x0d\0\x01\0"];
const PE: &[&[u8]] = &[b"MZ"];
const DYLIB: &[&[u8]] = &[b"\xcf\xfa\xed\xfe", UNIVERSAL];
/// A dynamic library for Intel and Apple silicon at once.
const UNIVERSAL: &[u8] = b"\xca\xfe\xba\xbe";

/// Not a platform of FMI: importers on 64-bit ARM Linux look for `linux64` as well, so that they need an archive of
/// their own.
const ARM_LINUX: &str = "arm-linux";

/// The runtimes that were given to the build of this program, or made by it: platform and library.
static EMBEDDED: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/runtimes.rs"));

/// Folders of the machine that built this program, which places of panics begin with.
const BUILT_IN: &[&str] = include!(concat!(env!("OUT_DIR"), "/built_in.rs"));
/// What they begin with in an FMU, as long as the folder by slashes behind it.
const CRATES: &[u8] = b"crates";

/// The embedded runtimes as they travel: without a word of where they were built.
static RUNTIMES: LazyLock<Vec<(&str, Vec<u8>)>> = LazyLock::new(|| {
    let runtimes = EMBEDDED.iter().filter(|(platform, _)| *platform != LIVE);
    runtimes.map(|(p, bytes)| (*p, anonymous(bytes))).collect()
});

fn anonymous(library: &[u8]) -> Vec<u8> {
    let mut library = library.to_vec();
    let folders = BUILT_IN.iter().map(|folder| folder.as_bytes());
    for folder in folders.filter(|folder| folder.len() > CRATES.len()) {
        let mut at = 0;
        while let Some(next) = library[at..].iter().position(|b| *b == folder[0]) {
            at += next;
            if library[at..].starts_with(folder) {
                let place = &mut library[at..at + folder.len()];
                place.fill(b'/');
                place[..CRATES.len()].copy_from_slice(CRATES);
            }
            at += 1;
        }
    }
    library
}

/// A runtime binary for one platform.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Runtime {
    /// Folder below `binaries/`.
    pub platform: &'static str,
    /// The shared library.
    pub bytes: Cow<'static, [u8]>,
    /// Ending of the library's name.
    extension: &'static str,
    /// The platform in words.
    pub(crate) words: &'static str,
}

impl Runtime {
    /// The runtime for the platform this program was built for; it is part of the program.
    ///
    /// # Errors
    /// [`Error::Input`] when the program was built without (under an interpreter of Rust code).
    pub fn embedded() -> Result<Self> {
        let here = env!("AERODECK_RUNTIME_PLATFORM");
        let own = RUNTIMES.iter().find(|(platform, _)| *platform == here);
        Self::new(here, Cow::Borrowed(own.map_or(&[], |(_, bytes)| bytes)))
    }

    /// The runtimes in the folder that `RUNTIME_DIR_VARIABLE` names, if it is set, and for other platforms those
    /// that this program carries; the component for WebAssembly has to be named, see [`Runtime::chosen`].
    ///
    /// # Errors
    /// [`Error::Io`] for a folder or file that cannot be read, [`Error::Input`] for a folder without any runtime and for
    /// files that are no library of their platform.
    pub fn available() -> Result<Vec<Self>> {
        let all = Self::all()?.into_iter();
        Ok(all.filter(|runtime| !runtime.is_component()).collect())
    }

    fn all() -> Result<Vec<Self>> {
        let mut all = match std::env::var_os(RUNTIME_DIR_VARIABLE) {
            Some(folder) => Self::in_folder(Path::new(&folder))?,
            None => Vec::new(),
        };
        for (platform, bytes) in RUNTIMES.iter() {
            if all.iter().all(|r| r.platform != *platform) {
                all.push(Self::new(platform, Cow::Borrowed(bytes))?);
            }
        }
        all.sort_by_key(|r| r.platform);
        Ok(all)
    }

    /// The runtimes for these platforms out of those that are here; `arm-linux` is the one for 64-bit ARM, in the
    /// folder `linux64` where importers on such a machine look, and in its own.
    ///
    /// # Errors
    /// [`Error::Io`] for a folder or file that cannot be read, [`Error::Input`] for a platform without a runtime.
    pub fn chosen(platforms: &[String]) -> Result<Vec<Self>> {
        let available = Self::all()?;
        let find = |wanted: &str| {
            let found = available.iter().find(|r| r.platform == wanted).cloned();
            found.ok_or_else(|| {
                let known: Vec<_> = available.iter().map(|r| r.platform).collect();
                let expected = format!("one whose runtime is here: {}", known.join(", "));
                Error::input("platform", expected, wanted)
            })
        };
        let mut chosen = Vec::new();
        for platform in platforms {
            if platform == ARM_LINUX {
                let own = find("aarch64-linux")?;
                chosen.push(Self::new("linux64", own.bytes.clone())?);
                chosen.push(own);
            } else {
                chosen.push(find(platform)?);
            }
        }
        Ok(chosen)
    }

    /// The runtimes in a folder laid out as `binaries/` of an FMU, in alphabetical order of the platforms.
    ///
    /// # Errors
    /// [`Error::Io`] for a folder or file that cannot be read, [`Error::Input`] for a folder without any runtime and
    /// for files that are no library of their platform.
    pub(crate) fn in_folder(folder: &Path) -> Result<Vec<Self>> {
        std::fs::read_dir(folder).map_err(|e| Error::io(folder, e))?;
        let mut found = Vec::new();
        for (platform, extension, ..) in PLATFORMS {
            let own = folder.join(platform);
            let file = own.join(format!("{MODEL_IDENTIFIER}.{extension}"));
            if file.is_file() {
                let bytes = std::fs::read(&file).map_err(|e| Error::io(&file, e))?;
                found.push(Self::new(platform, Cow::Owned(bytes)).map_err(|e| e.in_file(&file))?);
            }
        }
        let (any, place) = (!found.is_empty(), RUNTIME_DIR_VARIABLE);
        let any = any || live_file(folder).is_file();
        let expected = format_args!("a folder with, for example, linux64/{MODEL_IDENTIFIER}.so");
        ensure(any, place, expected, "none of these").map_err(|e| e.in_file(folder))?;
        Ok(found)
    }

    fn new(platform: &str, bytes: Cow<'static, [u8]>) -> Result<Self> {
        let known = PLATFORMS.into_iter().find(|(name, ..)| *name == platform);
        let Some((platform, extension, beginnings, words)) = known else {
            return Err(Error::input("runtime", "a platform of FMI", platform));
        };
        let begins = beginnings.iter().any(|b| bytes.starts_with(b));
        let (place, found) = (format!("runtime for {platform}"), bytes.len());
        let expected = format_args!("a shared library ({words})");
        ensure(begins, place, expected, format_args!("{found} other bytes"))?;
        Ok(Self {
            words: match platform {
                "linux64" if is_arm(&bytes) => "Linux, 64-bit ARM",
                "darwin64" if bytes.starts_with(UNIVERSAL) => {
                    "macOS, 64-bit Intel and Apple silicon"
                }
                _ => words,
            },
            platform,
            bytes,
            extension,
        })
    }

    /// Whether it is a component for WebAssembly, of FMI 3.0 alone.
    pub(super) fn is_component(&self) -> bool {
        self.platform == COMPONENT
    }

    /// Path of the library in the archive.
    pub(crate) fn path_in_archive(&self, version: FmiVersion) -> String {
        let platform = match (version, self.platform) {
            (FmiVersion::Two, platform) => platform,
            (FmiVersion::Three, "linux64") if is_arm(&self.bytes) => "aarch64-linux",
            (FmiVersion::Three, "linux64") => "x86_64-linux",
            (FmiVersion::Three, "win64") => "x86_64-windows",
            (FmiVersion::Three, "darwin64") => "x86_64-darwin",
            (FmiVersion::Three, "linux32") => "x86-linux",
            (FmiVersion::Three, "win32") => "x86-windows",
            (FmiVersion::Three, tuple) => tuple,
        };
        format!("binaries/{platform}/{MODEL_IDENTIFIER}.{}", self.extension)
    }
}

fn live_file(folder: &Path) -> PathBuf {
    folder.join(LIVE).join(format!("{MODEL_IDENTIFIER}.wasm"))
}

/// The module that answers the sliders of a report, [`crate::live`] for WebAssembly: the one in the folder that
/// `RUNTIME_DIR_VARIABLE` names, else the one that this program carries; `None` without either.
///
/// # Errors
/// [`Error::Io`] for a file that cannot be read, [`Error::Input`] for one that is no such module.
pub(crate) fn live_module() -> Result<Option<Cow<'static, [u8]>>> {
    if let Some(folder) = std::env::var_os(RUNTIME_DIR_VARIABLE) {
        let file = live_file(Path::new(&folder));
        if file.is_file() {
            let bytes = std::fs::read(&file).map_err(|e| Error::io(&file, e))?;
            if !bytes.starts_with(b"\0asm") {
                let found = format!("{} other bytes", bytes.len());
                return Err(Error::input("module", "WebAssembly", found).in_file(&file));
            }
            return Ok(Some(Cow::Owned(bytes)));
        }
    }
    let own = EMBEDDED.iter().find(|(platform, _)| *platform == LIVE);
    Ok(own.map(|(_, bytes)| Cow::Borrowed(*bytes)))
}

/// Whether an ELF file is for 64-bit ARM: its machine, at byte 18, is 183.
fn is_arm(elf: &[u8]) -> bool {
    elf.get(18..20) == Some(&[183, 0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_embedded_runtime_is_for_this_platform() {
        let runtime = Runtime::embedded().unwrap();
        let path = runtime.path_in_archive(FmiVersion::Two);
        assert!(path.starts_with("binaries/"), "{path}");
        assert!(runtime.bytes.len() > 100_000);
    }

    /// What panics name as their place must not tell where the library was built.
    #[test]
    fn the_embedded_runtime_holds_no_path_of_the_machine_that_built_it() {
        if option_env!("AERODECK_RUNTIME").is_some() {
            return; // ready-made: whoever made it has checked it (fmu_build/build.py)
        }
        let bytes = Runtime::embedded().unwrap().bytes;
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("nalgebra"), "no place of a panic at all");
        let home = std::env::var("HOME").unwrap_or_default();
        let cargo = std::env::var("CARGO_HOME").unwrap_or_default();
        for path in [env!("CARGO_MANIFEST_DIR"), home.as_str(), cargo.as_str()] {
            assert!(path.len() < 3 || !text.contains(path), "{path}");
        }
        assert!(!text.contains(".cargo"), "the registry of crates");
    }

    #[test]
    fn platforms_are_chosen_or_refused() {
        let own = Runtime::embedded().unwrap();
        let chosen = Runtime::chosen(&[own.platform.to_owned()]).unwrap();
        assert_eq!(chosen, [own]);
        let refused = Runtime::chosen(&["solaris".to_owned()]).unwrap_err();
        let message = refused.to_string();
        assert!(
            message.contains("solaris") && message.contains("is here:"),
            "{message}"
        );
    }

    #[test]
    fn components_are_of_fmi_3_alone() {
        let component = Runtime::new(COMPONENT, Cow::Borrowed(WASM[0])).unwrap();
        let runtimes = [component];
        let refused = super::super::binaries(&runtimes, FmiVersion::Two).unwrap_err();
        assert!(refused.to_string().contains("--fmi 3"), "{refused}");
        let files = super::super::binaries(&runtimes, FmiVersion::Three).unwrap();
        let names: Vec<_> = files.keys().map(String::as_str).collect();
        let place = "binaries/wasm32-wasip2/aerodeck_section.wasm";
        assert_eq!(names, [place, super::super::WASM_MANIFEST]);
        // a module is none: browsers take it, hosts of components do not
        assert!(Runtime::new(COMPONENT, Cow::Borrowed(b"\0asm\x01\0\0\0")).is_err());
    }

    #[test]
    fn libraries_say_what_machine_they_are_for() {
        let mut arm = b"\x7fELF".to_vec();
        arm.resize(64, 0);
        arm[18] = 183;
        let words = |platform, bytes: &[u8]| {
            let runtime = Runtime::new(platform, Cow::Owned(bytes.to_vec())).unwrap();
            runtime.words
        };
        assert_eq!(words("linux64", &arm), "Linux, 64-bit ARM");
        assert!(words("darwin64", UNIVERSAL).contains("Apple silicon"));
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
            found[0].path_in_archive(FmiVersion::Two),
            "binaries/win64/aerodeck_section.dll"
        );
        assert!(Runtime::in_folder(&folder.path().join("missing")).is_err());
    }
}
