//! Builds the wheel of the Python package into the target directory, installs it there and runs its tests.
//!
//! The wheel is built by the same cargo in the same target directory, so that it costs one link beside a build of the tests.
#[path = "common/python.rs"]
mod python;

use std::fs;
use std::path::Path;
use std::process::Command;

/// Runs a command to its end; says what it said when it fails.
fn run(what: &str, command: &mut Command) {
    let output = command.output().unwrap_or_else(|e| panic!("{what}: {e}"));
    assert!(
        output.status.success(),
        "{what} failed:\n{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn the_package_builds_installs_and_passes_its_tests() {
    let interpreter = python::interpreter().unwrap_or_else(|why| panic!("{why}"));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let target = python::target_directory();
    let (wheels, installed) = (target.join("wheels"), target.join("tmp/python-package"));
    let pip = || {
        let mut pip = Command::new(&interpreter);
        pip.args(["-m", "pip", "--disable-pip-version-check", "--no-input"])
            .args(["install", "--quiet"]);
        pip
    };
    let needs = root.join("python/tests/requirements.txt");
    run(
        "installing maturin",
        pip().args(["--only-binary=:all:", "-r"]).arg(needs),
    );
    // no wheel for this platform: the notebooks that need it are skipped and say so
    let notebooks = root.join("python/tests/requirements-optional.txt");
    let _ = pip()
        .args(["--only-binary=:all:", "-r"])
        .arg(notebooks)
        .output();
    let _ = fs::remove_dir_all(&wheels);
    let _ = fs::remove_dir_all(&installed);
    run(
        "building the wheel",
        Command::new(&interpreter)
            .args(["-m", "maturin", "build", "--release", "--target-dir"])
            .arg(&target)
            .arg("--interpreter")
            .arg(&interpreter)
            .arg("--out")
            .arg(&wheels)
            .arg("--manifest-path")
            .arg(root.join("python/Cargo.toml")),
    );
    let wheel = fs::read_dir(&wheels).unwrap().next().unwrap().unwrap();
    run(
        "installing the wheel",
        pip()
            .args(["--no-deps", "--target"])
            .arg(&installed)
            .arg(wheel.path()),
    );
    source_distribution(&interpreter, root, &target.join("tmp/python-source"));
    // a campaign for `process`, made by the program
    let campaign = target.join("tmp/python-campaign");
    let _ = fs::remove_dir_all(&campaign);
    run(
        "making a campaign",
        Command::new(env!("CARGO_BIN_EXE_aerodeck"))
            .args(["campaign", "virtual", "LN21-5200", "--out"])
            .arg(&campaign),
    );
    // a trained model with its covariance beside it
    let trained = target.join("tmp/python-trained");
    let study = trained.join("study.toml");
    let _ = fs::remove_dir_all(&trained);
    fs::create_dir_all(&trained).unwrap();
    for command in [&["new", "--out"][..], &["study", "-q", "--no-figures"]] {
        let mut program = Command::new(env!("CARGO_BIN_EXE_aerodeck"));
        run("training", program.args(command).arg(&study));
    }
    run(
        "the tests of the package",
        Command::new(&interpreter)
            .args(python::PYTEST)
            .arg(root.join("python/tests"))
            .env("PYTHONPATH", &installed)
            .env("AERODECK_CAMPAIGN", campaign.join("campaign.toml"))
            .env("AERODECK_TRAINED", trained.join("model.json")),
    );
}

/// The source distribution holds everything that the wheel is built of: whoever has Rust can install from it alone.
fn source_distribution(interpreter: &Path, root: &Path, folder: &Path) {
    let _ = fs::remove_dir_all(folder);
    run(
        "packing the sources",
        Command::new(interpreter)
            .args(["-m", "maturin", "sdist", "--manifest-path"])
            .arg(root.join("python/Cargo.toml"))
            .arg("--out")
            .arg(folder),
    );
    let packed = fs::read_dir(folder).unwrap().next().unwrap().unwrap();
    run(
        "unpacking the sources",
        Command::new(interpreter)
            .args(["-m", "tarfile", "-e"])
            .arg(packed.path())
            .arg(folder),
    );
    let name = packed.file_name().into_string().unwrap();
    let unpacked = folder.join(name.trim_end_matches(".tar.gz"));
    for file in ["Cargo.lock", "build.rs", "LICENSE-MIT", "python/Cargo.toml"] {
        assert!(unpacked.join(file).exists(), "{file} is not in the sources");
    }
    for part in [
        "src",
        "templates",
        "data",
        "fmu_build",
        "python/src",
        "docs/schema",
    ] {
        every_file_of(&root.join(part), &unpacked.join(part));
    }
    for inner in fs::read_dir(root.join("crates")).unwrap() {
        let name = inner.unwrap().file_name();
        // no part of an ordinary build
        if name != "component" {
            let sources = Path::new("crates").join(name).join("src");
            every_file_of(&root.join(&sources), &unpacked.join(&sources));
        }
    }
    every_file_of(&root.join("python/aerodeck"), &unpacked.join("aerodeck"));
}

/// All but tests, which are not packed with the inner crates.
fn every_file_of(folder: &Path, packed: &Path) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let (name, there) = (
            path.file_name().unwrap(),
            packed.join(path.file_name().unwrap()),
        );
        if ["__pycache__", "tests", "tests.rs"]
            .iter()
            .any(|left_out| name == *left_out)
        {
            continue;
        }
        if path.is_dir() {
            every_file_of(&path, &there);
        } else {
            assert!(there.exists(), "{} is not in the sources", path.display());
        }
    }
}
