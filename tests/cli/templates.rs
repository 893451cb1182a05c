//! Files to begin with.

use crate::command::{aerodeck, refused, succeeds};
use tempfile::TempDir;

/// Files of a bridge and of wind to begin with: they run as they are, and what is commented is understood when it is switched on.
#[test]
fn new_files_of_bridge_and_wind_run_as_they_are() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--bridge"]);
    let text = std::fs::read_to_string(at.join("bridge.toml")).unwrap();
    // eight modes are quicker than all
    let few = text.replace(
        "# select = [1, 2, 3, 23] ",
        "select = [2, 3, 5, 12, 14, 16, 17, 23] ",
    );
    let switched_on = |line: &str| {
        let keys = [
            "# static",
            "# [wind]",
            "# profile",
            "# required",
            "# [buff",
            "# nodes",
            "# along",
            "# vertical",
        ];
        match keys.iter().any(|key| line.starts_with(key)) {
            true => line.replacen("# ", "", 1),
            false => line.to_owned(),
        }
    };
    let all: Vec<String> = few.lines().map(switched_on).collect();
    std::fs::write(at.join("bridge.toml"), few).unwrap();
    std::fs::write(at.join("all.toml"), all.join("\n")).unwrap();
    succeeds(at, &["bridge", "flutter", "bridge.toml", "--no-figures"]);
    let buffeting = [
        "bridge",
        "buffeting",
        "all.toml",
        "--speed",
        "40",
        "--no-figures",
    ];
    let (code, _, said) = aerodeck(at, &buffeting);
    assert!(matches!(code, 0 | 3), "{said}");
    refused(at, &["new", "--bridge"], &["choose another --out"]);
    succeeds(at, &["new", "--wind", "--out", "gusts.toml"]);
    succeeds(
        at,
        &["buffeting", "gusts.toml", "--no-figures", "--out", "gusts"],
    );
}
