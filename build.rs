//! Builds the FMU runtime, the shared library that every exported FMU holds, and hands it to `src/fmu/package`.
//!
//! This script calls cargo once more, on the crate of the unit, in the profile `fmu` and a target directory of its own, and copies
//! the library to `OUT_DIR`, from where it is embedded: an installed `aerodeck` exports FMUs without source tree or Rust toolchain.
//! Ready-made runtimes, also for other platforms, can be embedded instead. Where Rust has a target for WebAssembly, the module that
//! answers the sliders of a report is built in the same way; without it reports have no sliders.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Environment variable that names a ready-made runtime to embed instead of building one, such as one for an older C
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
    if env::var_os("CARGO_CFG_MIRI").is_some() {
        // an interpreter of Rust code has no use for a shared library, and cannot build one
    } else {
        if let Some(ready) = env::var_os(READY_MADE) {
            println!("cargo::rerun-if-changed={}", Path::new(&ready).display());
            runtimes = ready_made(Path::new(&ready), here)?;
        }
        if runtimes.iter().all(|(platform, _)| platform != here) {
            let library = build(&source, &out, &Part::runtime()?)?;
            watch(&library)?;
            runtimes.push((here.to_owned(), library));
        }
        let wasm = WASM.0.into_iter().find(|target| has_target(target));
        let wanted = cfg!(feature = "sliders") && env::var_os(READY_MADE).is_none();
        if let Some(target) = wasm.filter(|_| wanted) {
            let module = build(&source, &out, &Part::live(target))?;
            watch(&module)?;
            runtimes.push((WASM.1.to_owned(), module));
        }
    }
    let mut list = String::from("&[");
    for (platform, library) in runtimes {
        let copy = out.join(format!("{platform}.runtime"));
        fs::copy(&library, copy).map_err(|e| format!("{}: {e}", library.display()))?;
        list += &format!(
            "(\"{platform}\", include_bytes!(concat!(env!(\"OUT_DIR\"), \"/{platform}.runtime\"))), "
        );
    }
    let file = out.join("runtimes.rs");
    fs::write(&file, list + "]").map_err(|e| format!("{}: {e}", file.display()))
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

fn extension() -> &'static str {
    match env::var("CARGO_CFG_TARGET_OS").as_deref() {
        Ok("windows") => "dll",
        Ok("macos") => "dylib",
        _ => "so",
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

/// A library that is built beside the program.
struct Part {
    package: &'static str,
    /// For cargo.
    options: &'static [&'static str],
    triple: String,
    file: String,
}

impl Part {
    fn runtime() -> Result<Self, String> {
        let prefix = if extension() == "dll" { "" } else { "lib" };
        Ok(Self {
            package: "aerodeck-unit",
            options: &["--features", "runtime"],
            triple: variable("TARGET")?,
            file: format!("{prefix}aerodeck_unit.{}", extension()),
        })
    }

    /// Small, and quick to build: the crates are left as they are until what the module needs of them is in one piece. With
    /// the linker itself it is a module that a browser takes, not a component of WASI.
    fn live(triple: &str) -> Self {
        Self {
            package: "aerodeck-live",
            options: &[
                "--config=profile.fmu.opt-level='s'",
                "--config=profile.fmu.package.'*'.opt-level=0",
                "--config=profile.fmu.package.aerodeck-core.opt-level=0",
                "--config=target.wasm32-wasip2.linker='rust-lld'",
            ],
            triple: triple.to_owned(),
            file: "aerodeck_live.wasm".to_owned(),
        }
    }
}

/// Builds a library and says where it is.
fn build(source: &Path, out: &Path, part: &Part) -> Result<PathBuf, String> {
    let target_dir = runtime_target_dir(out);
    let mut said = String::new();
    // what the outer build has fetched and locked is enough; the rest is for lock files that do not travel along
    for network in [&["--offline", "--locked"][..], &["--locked"], &[]] {
        let output = nested_cargo(source, &target_dir, part)?
            .args(network)
            .output()
            .map_err(|e| format!("cargo cannot be started to build the FMU runtime: {e}"))?;
        if output.status.success() {
            let folder = target_dir.join(&part.triple).join("fmu");
            return Ok(folder.join(&part.file));
        }
        said = String::from_utf8_lossy(&output.stderr).into_owned();
        if said.contains("could not compile") {
            break;
        }
    }
    Err(format!(
        "{} (profile `fmu`, target {}), which this program carries, could not be built in {}; cargo said:\n{said}",
        part.package,
        part.triple,
        target_dir.display()
    ))
}

/// A target directory that the calling cargo has not locked, shared by its profiles: `<target>/fmu-runtime`.
fn runtime_target_dir(out: &Path) -> PathBuf {
    // OUT_DIR is <target>[/<triple>]/<profile>/build/<package>/out
    out.ancestors()
        .find(|a| a.file_name().is_some_and(|n| n == "build"))
        .and_then(|build| build.parent()?.parent())
        .unwrap_or(out)
        .join("fmu-runtime")
}

fn nested_cargo(source: &Path, target_dir: &Path, part: &Part) -> Result<Command, String> {
    let mut cargo = Command::new(variable("CARGO")?);
    cargo
        .args(["rustc", "--package", part.package, "--lib"])
        .args(["--crate-type", "cdylib"])
        .args(["--profile", "fmu"])
        .args(part.options)
        .args(["--target", &part.triple])
        .arg("--manifest-path")
        .arg(source.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(target_dir)
        .current_dir(source)
        .env("CARGO_BUILD_BUILD_DIR", target_dir)
        .env("CARGO_ENCODED_RUSTFLAGS", flags(source))
        .env_remove("RUSTC_WORKSPACE_WRAPPER")
        .env_remove("RUSTFLAGS");
    // what cargo tells a build script is about the outer build
    for (name, _) in env::vars_os() {
        let name = name.to_string_lossy().into_owned();
        if [
            "CARGO_FEATURE_",
            "CARGO_CFG_",
            "CARGO_PKG_",
            "CARGO_MANIFEST_",
        ]
        .iter()
        .any(|p| name.starts_with(p))
        {
            cargo.env_remove(name);
        }
    }
    Ok(cargo)
}

/// Compiler flags of the runtime. They replace those of the outer build, which may be for this machine's processor
/// only or instrumented, and take the paths of this machine out of panic messages.
fn flags(source: &Path) -> String {
    let home = env::var_os("CARGO_HOME").map(PathBuf::from).or_else(|| {
        let user = env::var_os("HOME").or_else(|| env::var_os("USERPROFILE"))?;
        Some(Path::new(&user).join(".cargo"))
    });
    let remap = |from: &Path, to: &str| format!("--remap-path-prefix={}={to}", from.display());
    let mut flags = vec![remap(source, "aerodeck")];
    if let Some(home) = home {
        flags.push(remap(&home, "cargo"));
        // the last match wins: crates lose the name of the registry they came from
        let registries = fs::read_dir(home.join("registry").join("src"));
        for registry in registries.into_iter().flatten().flatten() {
            flags.push(remap(&registry.path(), "crates"));
        }
    }
    flags.join("\u{1f}")
}

fn variable(name: &str) -> Result<String, String> {
    env::var(name).map_err(|e| format!("{name}: {e}"))
}
