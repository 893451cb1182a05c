//! The examples of the manual run.

use crate::{page, pages, python, root};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

#[test]
fn the_tutorial_runs() {
    let python = python::interpreter().unwrap_or_else(|why| panic!("{why}"));
    let folder = TempDir::new().unwrap();
    let path = search_path();
    let text = page("docs/tutorial.md");
    let mut ran = 0;
    for part in text.split("```").skip(1).step_by(2) {
        let (language, code) = part.split_once('\n').unwrap();
        let mut command = match language {
            "sh" => {
                let mut shell = Command::new("sh");
                shell.args(["-e", "-c", code]);
                shell
            }
            "python" => {
                let mut interpreter = Command::new(&python);
                interpreter.args(["-c", code]);
                interpreter
            }
            _ => continue,
        };
        let output = command
            .current_dir(folder.path())
            .env("PATH", &path)
            .output()
            .unwrap();
        assert!(
            output.status.success(),
            "{code}\n{}{}",
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        );
        ran += 1;
    }
    assert!(ran >= 6, "{ran} blocks of code");
    let report = fs::read_to_string(folder.path().join("lab/report.html")).unwrap();
    assert!(
        report.contains("Flutter onset 3"),
        "no answer in the report"
    );
}

/// `PATH` with the program in front.
fn search_path() -> std::ffi::OsString {
    let program = Path::new(env!("CARGO_BIN_EXE_aerodeck")).parent().unwrap();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let mut folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    folders.insert(0, program.to_path_buf());
    std::env::join_paths(folders).unwrap()
}

/// Pages of what is looked up, of other programs, or of the project itself begin without an example that could run here.
const WITHOUT_EXAMPLE: [&str; 10] = [
    "SUMMARY",
    "architecture",
    "bibliography",
    "commands",
    "comparison",
    "hosts",
    "index",
    "performance",
    "python",
    "variables",
];

/// Every page begins with an example, before its first heading, that runs in an empty folder.
#[test]
fn every_page_begins_with_an_example_that_runs() {
    let mut ran = 0;
    for path in pages() {
        let name = path.file_stem().unwrap().to_string_lossy();
        let is_of_manual = path.starts_with(root().join("docs"));
        if !is_of_manual || name == "tutorial" || WITHOUT_EXAMPLE.contains(&&*name) {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let head = text.split("\n## ").next().unwrap();
        let example = head
            .split("```sh\n")
            .nth(1)
            .and_then(|e| e.split("```").next());
        let example = example.unwrap_or_else(|| panic!("{}: no example", path.display()));
        let folder = TempDir::new().unwrap();
        let output = Command::new("sh")
            .args(["-e", "-c", example])
            .current_dir(folder.path())
            .env("PATH", search_path())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.success(),
            "{}\n{example}\n{said}",
            path.display()
        );
        ran += 1;
    }
    assert!(ran >= 20, "{ran} examples");
}
