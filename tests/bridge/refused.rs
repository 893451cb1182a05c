//! What the files of a bridge say twice, or cannot mean, is refused where it stands.

use crate::files::{study, tables, text};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// The error of the small bridge after a change of its tables and of its bridge file.
#[track_caller]
fn refused(
    tables_after: impl Fn(&Path),
    file_after: impl Fn(String) -> String,
    fragments: &[&str],
) {
    let folder = TempDir::new().unwrap();
    tables(folder.path());
    tables_after(folder.path());
    let error = study(folder.path(), &file_after(text("csv", ""))).unwrap_err();
    let error = error.to_string();
    for fragment in fragments {
        assert!(error.contains(fragment), "`{fragment}` is not in {error}");
    }
}

/// A table with its last line once more.
fn repeated(folder: &Path, name: &str) {
    let text = fs::read_to_string(folder.join(name)).unwrap();
    let last = text.lines().last().unwrap().to_owned();
    fs::write(folder.join(name), format!("{text}{last}\n")).unwrap();
}

#[test]
fn rows_that_stand_twice_are_refused_in_their_file() {
    for (name, fragments) in [
        (
            "shapes.csv",
            [
                "line 10",
                "expected each node once in a mode, found node 14 of mode 2 twice",
            ],
        ),
        (
            "modes.csv",
            ["line 4", "expected each mode once, found mode 2 twice"],
        ),
        (
            "nodes.csv",
            ["line 7", "expected each node once, found node 14 twice"],
        ),
    ] {
        let fragments = [name, fragments[0], fragments[1]];
        refused(|at| repeated(at, name), |text| text, &fragments);
    }
}

#[test]
fn a_compact_file_has_each_node_and_mode_once() {
    let compact = "# aerodeck bridge modes 1\n# source: s\n# licence: l\n\
        # axes: vertical up, lateral downwind, rotation nose-up\n\
        # units: along_m and length_m in m; vertical, lateral in m and rotation in rad per unit of the modal coordinate\n\
        # generator: g\n# mode: 1, 0.1 Hz, 10 kg\nnode,along_m,length_m,vertical_1,lateral_1,rotation_1\n\
        1,0,5,0,0,0.1\n2,10,5,1,0,0.1\n";
    let with = |text: String| move |at: &Path| fs::write(at.join("one.csv"), &text).unwrap();
    let file = |text: String| text.replace("path = \".\"", "path = \"one.csv\"");
    let node = compact.replace("2,10,5", "1,10,5");
    let expected = "line 10: expected each node once, found node 1 twice";
    refused(with(node), file, &["one.csv", expected]);
    let mode = compact.replace("\nnode,", "\n# mode: 1, 0.2 Hz, 10 kg\nnode,");
    let expected = "line 8 (mode): expected each mode once, found `1, 0.2 Hz, 10 kg`";
    refused(with(mode), file, &["one.csv", expected]);
    let more = compact.replace("rotation_1\n", "rotation_1,vertical_2\n");
    let more = more.replace("0.1\n", "0.1,0\n");
    let expected = "expected a line `# mode: …` for the column `vertical_2`, found none";
    refused(with(more), file, &["one.csv", expected]);
}

#[test]
fn names_and_damping_that_cannot_be_are_refused_at_their_key() {
    let again = |text: String| {
        let (_, section) = text.split_once("[[section]]").unwrap();
        format!("{text}\n[[section]]{section}")
    };
    let expected = "expected a name that no section before it has, found `girder`";
    refused(|_| (), again, &["section[1].name", expected]);
    let damped = |text: String| text.replace("damping_ratio = 0.005", "damping_ratio = 1.5");
    let expected = "modes.damping_ratio: expected a ratio to critical damping below 1, found 1.5";
    refused(|_| (), damped, &["bridge.toml", expected]);
}
