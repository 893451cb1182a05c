//! A Python environment of our own below the target directory, for tests and benchmarks that run Python.
//!
//! Made once from `tests/fmpy/requirements.txt` and kept until that file, the interpreter or this recipe changes.
//! `AERODECK_PYTHON` names another interpreter than the first `python3` or `python` on the path.

use std::env;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Oldest Python for which the pinned packages exist.
const OLDEST: (u32, u32) = (3, 11);

/// The interpreter of the environment; makes the environment first where it is missing or out of date.
///
/// Safe to call from several processes and threads at once: one makes, the others wait.
///
/// # Errors
/// A message for the user: no suitable Python, no module `venv`, or what pip said.
pub fn interpreter() -> Result<PathBuf, String> {
    let home = target_directory().join("python-env");
    let _lock = lock(&home.with_extension("lock"))?;
    let python = home.join(if cfg!(windows) {
        "Scripts/python.exe"
    } else {
        "bin/python"
    });
    let base = base_interpreter()?;
    let stamp = home.join("made-from.txt");
    let wanted = recipe(&base)?;
    if fs::read_to_string(&stamp).is_ok_and(|made| made == wanted) {
        return Ok(python);
    }
    make(&base, &home, &python)?;
    fs::write(&stamp, wanted).map_err(|e| format!("{}: {e}", stamp.display()))?;
    Ok(python)
}

/// Words for the interpreter that runs pytest on all cores, up to eight: a test that takes long does not keep the others waiting.
pub const PYTEST: [&str; 8] = [
    "-m",
    "pytest",
    "-q",
    "-n=auto",
    "--maxprocesses=8",
    "--dist=worksteal",
    "-p",
    "no:cacheprovider",
];

/// The target directory of the build at hand.
pub fn target_directory() -> PathBuf {
    let tmp = Path::new(env!("CARGO_TARGET_TMPDIR"));
    tmp.parent().unwrap_or(tmp).to_path_buf()
}

fn requirements(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fmpy")
        .join(name)
}

/// Held until dropped, also when the process is killed.
#[allow(clippy::incompatible_msrv)] // locks of files came with Rust 1.89; tests may be newer than the product
fn lock(path: &Path) -> Result<File, String> {
    let said = |e: std::io::Error| format!("{}: {e}", path.display());
    let file = File::create(path).map_err(said)?;
    file.lock().map_err(said)?;
    Ok(file)
}

/// Everything that an environment depends on, as text.
fn recipe(base: &Base) -> Result<String, String> {
    let mut text = format!("{}\n{}\n", base.program, base.version);
    for name in ["requirements.txt", "requirements-optional.txt"] {
        let file = requirements(name);
        text += &fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
    }
    Ok(text)
}

struct Base {
    program: String,
    version: String,
}

/// The first Python that is new enough.
fn base_interpreter() -> Result<Base, String> {
    let named = env::var("AERODECK_PYTHON").ok();
    let candidates = match &named {
        Some(one) => vec![one.as_str()],
        None => vec!["python3", "python"],
    };
    let mut seen = Vec::new();
    for program in candidates {
        let Ok(output) = Command::new(program)
            .args([
                "-c",
                "import sys; print(sys.executable); print(sys.version)",
            ])
            .output()
        else {
            seen.push(format!("{program}: not found"));
            continue;
        };
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let (executable, version) = text.split_once('\n').unwrap_or_default();
        if number(version).is_some_and(|v| v >= OLDEST) {
            return Ok(Base {
                program: executable.trim().to_owned(),
                version: version.trim().to_owned(),
            });
        }
        seen.push(format!("{program}: version {}", version.trim()));
    }
    Err(format!(
        "Python {}.{} or newer is needed to drive the FMUs with FMPy ({}); install it with its module venv (Debian and \
         Ubuntu: apt install python3-venv), or name one in AERODECK_PYTHON",
        OLDEST.0,
        OLDEST.1,
        seen.join(", ")
    ))
}

/// Major and minor of `3.11.7 (main, …)`.
fn number(version: &str) -> Option<(u32, u32)> {
    let mut parts = version.split('.');
    Some((parts.next()?.parse().ok()?, parts.next()?.parse().ok()?))
}

fn make(base: &Base, home: &Path, python: &Path) -> Result<(), String> {
    let hint = "the module venv is needed (Debian and Ubuntu: apt install python3-venv)";
    run(Command::new(&base.program)
        .args(["-m", "venv", "--clear"])
        .arg(home))
    .map_err(|said| format!("{hint}\n{said}"))?;
    let install = |file: &str| {
        run(Command::new(python)
            .args(["-m", "pip", "install", "--disable-pip-version-check"])
            .args(["--no-input", "--quiet", "--only-binary=:all:", "-r"])
            .arg(requirements(file)))
    };
    install("requirements.txt")?;
    // no wheel for this platform: the suite goes without what is missing and says so
    let _ = install("requirements-optional.txt");
    Ok(())
}

fn run(command: &mut Command) -> Result<(), String> {
    let shown = format!("{command:?}");
    let output = command.output().map_err(|e| format!("{shown}: {e}"))?;
    if output.status.success() {
        return Ok(());
    }
    Err(format!(
        "{shown} failed ({}):\n{}{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    ))
}
