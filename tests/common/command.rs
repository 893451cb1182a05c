//! Running the program in a folder, and reading what it says.

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;

pub fn aerodeck(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_aerodeck"))
        .current_dir(folder)
        .args(arguments)
        // equal exports are equal byte for byte
        .env("SOURCE_DATE_EPOCH", "1700000000")
        .output()
        .unwrap();
    (
        output.status.code().unwrap(),
        String::from_utf8(output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

#[track_caller]
pub fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let (code, stdout, stderr) = aerodeck(folder, arguments);
    assert_eq!(code, 0, "{arguments:?}\n{stdout}\n{stderr}");
    stdout
}

/// What was said, without the breaks of lines.
pub fn flowing(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Wrong input: exit code 2, every fragment in the message, and nothing new in the folder.
#[track_caller]
pub fn refused(folder: &Path, arguments: &[&str], fragments: &[&str]) {
    let before = listing(folder);
    let (code, stdout, stderr) = aerodeck(folder, arguments);
    assert_eq!(code, 2, "{arguments:?}\n{stdout}\n{stderr}");
    for fragment in fragments {
        assert!(
            stderr.contains(fragment),
            "`{fragment}` is not in: {stderr}"
        );
    }
    assert_eq!(listing(folder), before, "something was left behind");
}

pub fn listing(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(at) = folders.pop() {
        for entry in fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            names.push(path.strip_prefix(folder).unwrap().display().to_string());
            if path.is_dir() {
                folders.push(path);
            }
        }
    }
    names.sort();
    names
}

pub fn onset_of<'a>(summary: &'a Value, model: &str, method: &str) -> &'a Value {
    summary["onsets"]
        .as_array()
        .unwrap()
        .iter()
        .find(|o| o["model"] == model && o["method"] == method)
        .unwrap_or_else(|| panic!("no onset of {model} by {method}: {}", summary["onsets"]))
}
