//! Keeps the design true of the tree: direction of imports, no circles between files, short files. The table is in
//! `rules.rs`. That library code neither ends abruptly nor prints, and where it may be `unsafe`, `src/lib.rs` says to the
//! compiler.

mod circles;
mod figures;
mod rules;
mod source;

use rules::{ARROWS, LINES_AT_MOST, breaches};
use source::SourceFile;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Files longer than [`LINES_AT_MOST`], each with its reason. Empty, and meant to stay so.
const LONG_FILES: &[(&str, &str)] = &[];

/// Where the rooms are: in the root package and in the crates that it is built on.
const SOURCES: &[&str] = &[
    "src",
    "crates/buffeting/src",
    "crates/core/src",
    "crates/fit/src",
    "crates/fmu-host/src",
    "crates/judgement/src",
    "crates/lab/src",
    "crates/component/src",
    "crates/live/src",
    "crates/runtime/src",
    "crates/signal/src",
    "crates/unit/src",
];

/// Rust files below `directory` as (path relative to the package with `/`, text), in order.
fn rust_files(directory: &str) -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut waiting = vec![root.join(directory)];
    let mut files = Vec::new();
    while let Some(path) = waiting.pop() {
        if path.is_dir() {
            waiting.extend(entries(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            let name = path.strip_prefix(root).unwrap();
            let name = name.to_str().unwrap().replace('\\', "/");
            files.push((name, std::fs::read_to_string(&path).unwrap()));
        }
    }
    files.sort();
    files
}

fn entries(directory: &Path) -> Vec<PathBuf> {
    let list = std::fs::read_dir(directory).unwrap();
    list.map(|entry| entry.unwrap().path()).collect()
}

/// Paths (without `.rs`) of the modules that `source` at `path` declares for tests only.
fn test_modules(path: &str, source: &SourceFile) -> Vec<String> {
    let stem = path.trim_end_matches(".rs");
    let own = match stem.rsplit_once('/') {
        Some((folder, "lib" | "main")) => folder,
        _ => stem,
    };
    let files = source.test_files.iter();
    files.map(|name| format!("{own}/{name}")).collect()
}

fn report(breaches: &[String]) {
    assert!(breaches.is_empty(), "\n{}\n", breaches.join("\n"));
}

#[test]
fn the_tree_keeps_the_rules() {
    let files: Vec<(String, SourceFile)> = SOURCES
        .iter()
        .flat_map(|directory| rust_files(directory))
        .map(|(path, text)| (path, SourceFile::new(&text)))
        .collect();
    assert!(files.len() > 20, "the sources were not found");
    let tests: BTreeSet<String> = files.iter().flat_map(|(p, s)| test_modules(p, s)).collect();
    let is_test = |path: &str| {
        let stem = path.trim_end_matches(".rs");
        tests
            .iter()
            .any(|t| stem == t || stem.starts_with(&format!("{t}/")))
    };
    let own = || files.iter().filter(|(path, _)| !is_test(path));
    let mut found: Vec<String> = own()
        .flat_map(|(path, source)| breaches(path, source))
        .collect();
    found.extend(circles::circles(
        own().map(|(path, source)| (path.as_str(), source)),
    ));
    report(&found);
}

#[test]
fn files_are_short() {
    let directories = SOURCES.iter().chain(&["tests", "benches", "examples"]);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    for directory in directories.filter(|d| root.join(d).is_dir()) {
        for (path, text) in rust_files(directory) {
            let lines = text.lines().count();
            let excused = LONG_FILES.iter().any(|(name, _)| *name == path);
            if lines > LINES_AT_MOST && !excused {
                found.push(format!("{path}: {lines} lines, at most {LINES_AT_MOST}"));
            }
        }
    }
    report(&found);
}

/// A reader who looks for what tests a room finds it under the name of the room.
#[test]
fn tests_carry_the_names_of_rooms() {
    // the house itself, its shared helpers and files, the manual, and what tests the crate from Python
    let others = [
        "architecture",
        "common",
        "data",
        "docs",
        "fmpy",
        "python_package",
    ];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let room = ARROWS.iter().any(|row| row.module == name);
        assert!(
            room || others.contains(&name),
            "tests/{name} is named after no room of src"
        );
    }
}

/// The manual's table has the modules of the rules and says of each what it may use.
#[test]
fn the_manual_shows_the_arrows() {
    let page = include_str!("../../docs/architecture.md");
    let quoted = |cell: &str| -> BTreeSet<String> {
        let words = cell.split('`').skip(1).step_by(2);
        words.map(str::to_owned).collect()
    };
    let mut shown = std::collections::BTreeMap::new();
    let (_, table) = page.split_once("| module | question").unwrap();
    for line in table.lines().take_while(|line| !line.is_empty()) {
        let cells: Vec<&str> = line.split('|').collect();
        for room in quoted(cells[1]) {
            shown.insert(room, cells[3].trim());
        }
    }
    for row in ARROWS.iter().filter(|row| !row.module.contains("::")) {
        if ["prelude", "main"].contains(&row.module) {
            continue;
        }
        let cell = shown.get(row.module);
        let cell = cell.unwrap_or_else(|| panic!("{} is not in the manual", row.module));
        let names = row.may_use.iter().map(|entry| entry.trim_end_matches('+'));
        let names = names.map(|entry| entry.split("::").next().unwrap_or(entry).to_owned());
        let may_use: BTreeSet<String> = names.collect();
        let all = *cell == "everything above";
        assert!(all || quoted(cell) == may_use, "{}: {cell}", row.module);
    }
}

/// Rows stand above the rows that may use them, so that the table has no cycle.
#[test]
fn the_arrows_run_one_way() {
    for (i, row) in ARROWS.iter().enumerate() {
        for entry in row.may_use {
            let module = entry.trim_end_matches('+').split("::").next();
            let known = ARROWS[..i].iter().any(|above| Some(above.module) == module);
            assert!(
                known,
                "`{}` may use `{entry}`, which has no row above",
                row.module
            );
        }
    }
}

/// The checker can fail: each rule catches its breach and lets the lawful neighbour pass.
mod the_checker {
    use super::*;

    /// File, its text, a part of each message.
    type Case<'a> = (&'a str, &'a str, &'a [&'a str]);

    #[track_caller]
    fn check(cases: &[Case<'_>]) {
        for (path, text, expected) in cases {
            let found = breaches(path, &SourceFile::new(text));
            assert_eq!(found.len(), expected.len(), "{text}: {found:?}");
            for (found, expected) in found.iter().zip(*expected) {
                assert!(found.contains(expected), "{found} lacks {expected}");
            }
        }
    }

    #[test]
    fn sees_imports_against_the_arrows() {
        let exports = "src/fmu/fmi2/exports.rs";
        check(&[
            (
                "src/units.rs",
                "use crate::section::Dof;",
                &["units.rs:1: `section::Dof`"],
            ),
            ("src/section.rs", "use crate::units::ReducedVelocity;", &[]),
            (
                "src/fmu/package.rs",
                "\nfn f() { crate::identification::fit() }",
                &[":2: `identification::fit`"],
            ),
            (exports, "use crate::fmu::instance::Instance;", &[]),
            (exports, "use crate::flutter::Onset;", &["flutter::Onset"]),
            (
                "src/cli/demo.rs",
                "use crate::fmu::{fmi2::exports, package};",
                &["fmu::fmi2::exports"],
            ),
            ("src/nowhere/x.rs", "", &["no row"]),
            ("src/cli/x.rs", "use crate::nowhere::X;", &["without a row"]),
        ]);
    }

    #[test]
    fn spreads_use_trees_and_follows_super() {
        let tree = "use crate::{\n    error::{Error, Result as R},\n    flutter::{self, Onset},\n    units::K,\n};";
        let curves = "src/flutter/curves.rs";
        check(&[
            (
                "src/aeroelastic.rs",
                tree,
                &["`flutter`", "`flutter::Onset`"],
            ),
            (
                "src/section.rs",
                "use super::flutter::Onset;",
                &["flutter::Onset"],
            ),
            (curves, "use super::onset::Onset;", &[]),
            (curves, "use super::super::fmu::Kind;", &["fmu::Kind"]),
            ("src/section.rs", "mod inner { use super::helper; }", &[]),
            (
                "src/main.rs",
                "fn main() { aerodeck::fmu::fmi2::run() }",
                &["fmu::fmi2::run"],
            ),
        ]);
    }

    #[test]
    fn knows_data_types_and_functions() {
        let fit = "src/identification/fit.rs";
        let plot = "src/report/plot.rs";
        check(&[
            (fit, "use crate::wind_tunnel::{Record, RecordSource};", &[]),
            (fit, "use crate::wind_tunnel::generate;", &["generate"]),
            (plot, "use crate::flutter::FlutterCurves;", &[]),
            (plot, "use crate::flutter::find_onset;", &["is no type"]),
            ("src/units.rs", "use crate::Result;", &[]),
        ]);
    }

    #[test]
    fn reads_attributes_and_macros_but_no_comments() {
        let units = "src/units.rs";
        check(&[
            (
                units,
                "#[serde(with = \"crate::section::rows\")] struct S;",
                &["section::rows"],
            ),
            (units, "fn f() { vec![crate::section::X] }", &["section::X"]),
            (
                units,
                "// use crate::section::Dof;\n/* /* crate::section */ x */",
                &[],
            ),
            (
                units,
                "/// [`crate::section::Dof`]\nfn f<'a>(c: char) -> bool { c == '\"' }",
                &[],
            ),
        ]);
    }

    #[test]
    fn leaves_test_code_out() {
        let module =
            "#[cfg(test)]\nmod tests { use crate::section::Dof; }\nfn g() { crate::section::f() }";
        let function = "#[cfg(all(test, unix))] fn f() { crate::section::f() }";
        let (other, file) = (
            function.replace("all(test, unix)", "not(test)"),
            function.replace("#[", "#!["),
        );
        check(&[
            ("src/units.rs", module, &["units.rs:3"]),
            ("src/units.rs", function, &[]),
            ("src/units.rs", &other, &["section::f"]),
            (
                "src/units.rs",
                &file.replace("all(test, unix)", "test"),
                &[],
            ),
        ]);
        let names = |path: &str, text: &str| test_modules(path, &SourceFile::new(text));
        assert_eq!(
            names("src/a.rs", "#[cfg(test)]\nmod checks;"),
            ["src/a/checks"]
        );
        assert_eq!(
            names("src/a/b.rs", "#[cfg(test)] mod checks;"),
            ["src/a/b/checks"]
        );
    }

    #[test]
    fn sees_circles_through_names_that_are_passed_on() {
        let room = "mod b; mod c;\npub use b::B;";
        let found = |b: &str, c: &str| {
            let files = [("src/a.rs", room), ("src/a/b.rs", b), ("src/a/c.rs", c)];
            let files = files.map(|(path, text)| (path, SourceFile::new(text)));
            circles::circles(files.iter().map(|(path, source)| (*path, source)))
        };
        assert_eq!(
            found("use super::c::C;", "use crate::a::B;"),
            ["src/a/b.rs ↔ src/a/c.rs"]
        );
        assert_eq!(found("use super::c::{self, C};", ""), [""; 0]);
        assert_eq!(found("", "fn f() { super::b::g() }"), [""; 0]);
    }
}
