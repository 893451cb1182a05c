//! The runtime for WebAssembly, built as releases build it, in archives that the program exports.

use crate::bridges::{TWO, langenuen_text};
use std::fs;
use std::path::Path;
use std::process::Command;

const TARGET: &str = "wasm32-wasip2";

/// Writes `component_section_KIND.fmu`, `component_force.fmu` and `component_bridge.fmu`; nothing, with a word on the terminal, where
/// Rust has no standard library for that target.
pub fn export(folder: &Path, models: &[(&str, &Path)]) {
    if !target_is_there() {
        println!("no runtime for WebAssembly: rustup target add {TARGET}");
        return;
    }
    let runtimes = folder.join("runtimes");
    place(&runtimes.join(TARGET));
    let bridge = folder.join("component_bridge.toml");
    let langenuen = langenuen_text("LN21-5200", TWO, "linear_v_hat");
    fs::write(&bridge, langenuen).unwrap();
    let pack = |name: &str, options: &[&str], of: &Path| {
        let output = Command::new(env!("CARGO_BIN_EXE_aerodeck"))
            .args([
                "fmu",
                "export",
                "--fmi",
                "3",
                "--allow-unstable",
                "--platforms",
            ])
            .arg(format!("{},{TARGET}", here()))
            .args(options)
            .arg("--out")
            .arg(folder.join(format!("component_{name}.fmu")))
            .arg(of)
            .env("AERODECK_RUNTIME_DIR", &runtimes)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{name}: {said}");
    };
    for (kind, model) in models {
        pack(&format!("section_{kind}"), &[], model);
    }
    let (_, model) = models[0];
    pack("force", &["--kind", "force", "--strips", "3"], model);
    pack("bridge", &["--bridge"], &bridge);
}

fn here() -> &'static str {
    aerodeck::fmu::package::Runtime::embedded()
        .unwrap()
        .platform
}

fn target_is_there() -> bool {
    let asked = Command::new("rustc")
        .args(["--print", "target-libdir", "--target", TARGET])
        .output();
    asked.is_ok_and(|answer| Path::new(String::from_utf8_lossy(&answer.stdout).trim()).is_dir())
}

/// Builds the component, in a folder that cargo has not locked, and lays it out as releases do.
fn place(folder: &Path) {
    let target = crate::python::target_directory().join("component");
    let built = Command::new(env!("CARGO"))
        .args(["build", "--locked", "--package", "aerodeck-component"])
        .args(["--profile", "component", "--target", TARGET, "--target-dir"])
        .arg(&target)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("RUSTFLAGS")
        // every engine has vectors of two numbers
        .env(
            "CARGO_TARGET_WASM32_WASIP2_RUSTFLAGS",
            "-Ctarget-feature=+simd128",
        )
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success(), "{said}");
    fs::create_dir_all(folder).unwrap();
    let component = target
        .join(TARGET)
        .join("component/aerodeck_component.wasm");
    fs::copy(component, folder.join("aerodeck_section.wasm")).unwrap();
}
