//! Hands the FMU runtime, the shared library that every exported FMU holds, to `src/fmu/package`, which embeds it: an installed
//! `aerodeck` exports FMUs without source tree or Rust toolchain.
//!
//! `aerodeck-runtime` is a dependency like others and shares all of their builds. Ready-made runtimes, also for other platforms, can be
//! embedded besides. Where Rust has a target for WebAssembly, a release build calls cargo once more for the module that answers the
//! sliders of a report; without it reports have no sliders.

use std::env;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Environment variable that names a ready-made runtime to embed instead of that of this build, such as one for an older C
/// library; or a folder of them, laid out as `binaries/` of an FMU, which are embedded all.
const READY_MADE: &str = "AERODECK_RUNTIME";

/// Targets of the module that answers the sliders of a report, of which one is enough, and its folder among the runtimes.
const WASM: ([&str; 2], &str) = (["wasm32-unknown-unknown", "wasm32-wasip2"], "wasm32");

/// Name of the libraries in their folders.
const LIBRARY: &str = "aerodeck_section";

fn main() -> ExitCode {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed={READY_MADE}");
    match embed_runtimes() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            for line in message.lines() {
                println!("cargo::error={line}");
            }
            ExitCode::FAILURE
        }
    }
}

fn embed_runtimes() -> Result<(), String> {
    let source = PathBuf::from(variable("CARGO_MANIFEST_DIR")?);
    let out = PathBuf::from(variable("OUT_DIR")?);
    let here = platform()?;
    println!("cargo::rustc-env=AERODECK_RUNTIME_PLATFORM={here}");
    let mut runtimes = Vec::new();
    if env::var_os("CARGO_CFG_MIRI").is_none() {
        // an interpreter of Rust code has no use for a shared library, and cannot build one
        if let Some(ready) = env::var_os(READY_MADE) {
            println!("cargo::rerun-if-changed={}", Path::new(&ready).display());
            runtimes = ready_made(Path::new(&ready), here)?;
        }
        if runtimes.iter().all(|(platform, _)| platform != here) {
            runtimes.push((here.to_owned(), own(&out)?));
        }
        let wasm = WASM.0.into_iter().find(|target| has_target(target));
        // not for a trial of a change, which it would make wait longer than all the rest
        let wanted = cfg!(feature = "sliders")
            && env::var_os(READY_MADE).is_none()
            && variable("PROFILE")? == "release";
        if let Some(target) = wasm.filter(|_| wanted) {
            let module = build_live(&source, &out, target)?;
            watch(&module)?;
            let copy = out.join("live.wasm");
            fs::copy(&module, &copy).map_err(|e| format!("{}: {e}", module.display()))?;
            runtimes.push((WASM.1.to_owned(), copy));
        }
    }
    let mut list = String::from("&[");
    for (platform, library) in runtimes {
        list += &format!("({platform:?}, include_bytes!({library:?})), ");
    }
    write(&out.join("runtimes.rs"), &(list + "]"))?;
    write(&out.join("built_in.rs"), &format!("&{:?}", built_in()))
}

fn write(file: &Path, text: &str) -> Result<(), String> {
    fs::write(file, text).map_err(|e| format!("{}: {e}", file.display()))
}

/// The runtime of this build: cargo makes it beside the library, before it compiles what embeds it.
fn own(out: &Path) -> Result<PathBuf, String> {
    let (prefix, suffix) = match variable("CARGO_CFG_TARGET_OS")?.as_str() {
        "windows" => ("", "dll"),
        "macos" => ("lib", "dylib"),
        _ => ("lib", "so"),
    };
    let deps = folder_of_profile(out).join("deps");
    let library = deps.join(format!("{prefix}{LIBRARY}.{suffix}"));
    // what is only checked has no library, but needs a file to look at
    let absent = fs::create_dir_all(&deps).and_then(|()| File::create_new(&library));
    match absent {
        Err(e) if e.kind() != ErrorKind::AlreadyExists => {
            Err(format!("{}: {e}", library.display()))
        }
        _ => Ok(library),
    }
}

/// `<target>[/<triple>]/<profile>`, of which OUT_DIR is `build/<package>/out`.
fn folder_of_profile(out: &Path) -> &Path {
    let build = out.ancestors().find(|a| a.ends_with("build"));
    build.and_then(Path::parent).unwrap_or(out)
}

/// Folders of this machine that places of panics may begin with.
fn built_in() -> Vec<String> {
    let home = env::var_os("CARGO_HOME").map(PathBuf::from).or_else(|| {
        let user = env::var_os("HOME").or_else(|| env::var_os("USERPROFILE"))?;
        Some(Path::new(&user).join(".cargo"))
    });
    let sources = home.map(|home| home.join("registry").join("src"));
    let registries = sources.and_then(|sources| fs::read_dir(sources).ok());
    let registries = registries.into_iter().flatten().flatten();
    let folders = registries.map(|registry| registry.path());
    let folders = folders.chain(env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from));
    folders.map(|folder| folder.display().to_string()).collect()
}

/// Platform and library of the runtimes in a folder; of a single library, which is for this platform.
fn ready_made(ready: &Path, here: &str) -> Result<Vec<(String, PathBuf)>, String> {
    if !ready.is_dir() {
        return Ok(vec![(here.to_owned(), ready.to_path_buf())]);
    }
    let entries = fs::read_dir(ready).map_err(|e| format!("{}: {e}", ready.display()))?;
    let mut runtimes = Vec::new();
    for folder in entries.flatten().map(|e| e.path()) {
        let platform = folder.file_name().unwrap_or_default().to_string_lossy();
        let libraries =
            ["so", "dll", "dylib", "wasm"].map(|e| folder.join(LIBRARY).with_extension(e));
        if let Some(library) = libraries.into_iter().find(|l| l.is_file()) {
            println!("cargo::rerun-if-changed={}", library.display());
            runtimes.push((platform.into_owned(), library));
        }
    }
    runtimes.sort();
    Ok(runtimes)
}

/// Asks cargo to call this script again when a source of the runtime changes: what the compiler has read for `library` stands
/// beside it, in the form of a makefile. A new file changes the `mod` line of one that is watched.
fn watch(library: &Path) -> Result<(), String> {
    let read = library.with_extension("d");
    let rule = fs::read_to_string(&read).map_err(|e| format!("{}: {e}", read.display()))?;
    println!("cargo::rerun-if-changed=Cargo.toml");
    println!("cargo::rerun-if-changed=Cargo.lock");
    // a space inside a path is escaped, one between two paths is not
    let rule = rule.replace("\\ ", "\0");
    let sources = rule.lines().filter_map(|line| line.split_once(": "));
    for path in sources.flat_map(|(_, paths)| paths.split(' ')) {
        println!("cargo::rerun-if-changed={}", path.replace('\0', " "));
    }
    Ok(())
}

/// Folder below `binaries/` of the platform that is compiled for: FMI 2.0 names, FMI 3.0 tuples where 2.0 has none.
fn platform() -> Result<&'static str, String> {
    let (system, processor) = (
        variable("CARGO_CFG_TARGET_OS")?,
        variable("CARGO_CFG_TARGET_ARCH")?,
    );
    match (system.as_str(), processor.as_str()) {
        ("linux", "x86_64") => Ok("linux64"),
        ("linux", "x86") => Ok("linux32"),
        ("linux", "aarch64") => Ok("aarch64-linux"),
        ("windows", "x86_64") => Ok("win64"),
        ("windows", "x86") => Ok("win32"),
        ("macos", "x86_64") => Ok("darwin64"),
        ("macos", "aarch64") => Ok("aarch64-darwin"),
        _ => Err(format!("FMI names no platform for {system} on {processor}")),
    }
}

/// Whether Rust can build for a target here.
fn has_target(target: &str) -> bool {
    let rustc = env::var_os("RUSTC").unwrap_or_default();
    let output = Command::new(rustc)
        .args(["--print", "target-libdir", "--target", target])
        .output();
    let folder = output.map(|o| String::from_utf8_lossy(&o.stdout).trim().to_owned());
    folder.is_ok_and(|folder| Path::new(&folder).is_dir())
}

/// Builds the module for WebAssembly, in a target directory that the calling cargo has not locked and that its profiles and features
/// share, and says where it is.
fn build_live(source: &Path, out: &Path, target: &str) -> Result<PathBuf, String> {
    let target_dir = folder_of_profile(out).with_file_name("live-module");
    let mut said = String::new();
    // what the outer build has fetched and locked is enough; the rest is for lock files that do not travel along
    for network in [&["--offline", "--locked"][..], &["--locked"], &[]] {
        let output = Command::new(variable("CARGO")?)
            .args(["rustc", "--package", "aerodeck-live", "--lib"])
            .args(["--crate-type", "cdylib", "--profile", "live"])
            .args(["--target", target, "--target-dir"])
            .arg(&target_dir)
            .args(network)
            .current_dir(source)
            .env("CARGO_BUILD_BUILD_DIR", &target_dir)
            // with the linker itself it is a module that a browser takes, not a component of WASI
            .env("CARGO_TARGET_WASM32_WASIP2_LINKER", "rust-lld")
            .env_remove("CARGO_ENCODED_RUSTFLAGS")
            .env_remove("RUSTC_WORKSPACE_WRAPPER")
            .env_remove("RUSTFLAGS")
            .output()
            .map_err(|e| format!("cargo cannot be started to build aerodeck-live: {e}"))?;
        if output.status.success() {
            return Ok(target_dir.join(target).join("live/aerodeck_live.wasm"));
        }
        said = String::from_utf8_lossy(&output.stderr).into_owned();
        if said.contains("could not compile") {
            break;
        }
    }
    Err(format!(
        "aerodeck-live could not be built in {}; cargo said:\n{said}",
        target_dir.display()
    ))
}

fn variable(name: &str) -> Result<String, String> {
    env::var(name).map_err(|e| format!("{name}: {e}"))
}
