//! Keeps the design true of the tree: direction of imports, `unsafe` in three places, no abrupt ends, no printing, short
//! files. The table is in `rules.rs`.

mod rules;
mod source;

use rules::{ARROWS, LINES_AT_MOST, breaches};
use source::Source;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Files longer than [`LINES_AT_MOST`], each with its reason. Empty, and meant to stay so.
const LONG_FILES: &[(&str, &str)] = &[];

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
fn test_modules(path: &str, source: &Source) -> Vec<String> {
    let directory = path.rsplit_once('/').map_or("", |(d, _)| d);
    let stem = path.trim_end_matches(".rs");
    let own = match stem.rsplit_once('/') {
        Some((d, "mod" | "lib" | "main")) => d.to_owned(),
        _ => stem.to_owned(),
    };
    let file = |name: &String| match name.strip_suffix(".rs") {
        Some(by_path) => format!("{directory}/{by_path}"),
        None => format!("{own}/{name}"),
    };
    source.test_files.iter().map(file).collect()
}

fn report(breaches: &[String]) {
    assert!(breaches.is_empty(), "\n{}\n", breaches.join("\n"));
}

#[test]
fn the_tree_keeps_the_rules() {
    let files: Vec<(String, Source)> = rust_files("src")
        .into_iter()
        .map(|(path, text)| (path, Source::new(&text)))
        .collect();
    assert!(files.len() > 20, "the sources were not found");
    let tests: BTreeSet<String> = files.iter().flat_map(|(p, s)| test_modules(p, s)).collect();
    let is_test = |path: &str| {
        let stem = path.trim_end_matches(".rs");
        tests
            .iter()
            .any(|t| stem == t || stem.starts_with(&format!("{t}/")))
    };
    let found: Vec<String> = files
        .iter()
        .filter(|(path, _)| !is_test(path))
        .flat_map(|(path, source)| breaches(path, source))
        .collect();
    report(&found);
}

#[test]
fn files_are_short() {
    let directories = ["src", "tests", "benches", "examples"];
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    for directory in directories.into_iter().filter(|d| root.join(d).is_dir()) {
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

    #[track_caller]
    fn check(path: &str, text: &str, expected: &[&str]) {
        let found = breaches(path, &Source::new(text));
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!(found.contains(expected), "{found} lacks {expected}");
        }
    }

    #[test]
    fn sees_imports_against_the_arrows() {
        check(
            "src/units.rs",
            "use crate::section::Dof;",
            &["units.rs:1: `section::Dof`"],
        );
        check("src/section.rs", "use crate::units::ReducedVelocity;", &[]);
        check(
            "src/fmu/package.rs",
            "\nfn f() { crate::identification::fit() }",
            &[":2: `identification::fit`"],
        );
        check(
            "src/fmu/fmi2/exports.rs",
            "use crate::fmu::instance::Instance;",
            &[],
        );
        check(
            "src/fmu/fmi2/exports.rs",
            "use crate::flutter::Onset;",
            &["flutter::Onset"],
        );
        check(
            "src/cli/demo.rs",
            "use crate::fmu::{fmi2::exports, package};",
            &["fmu::fmi2::exports"],
        );
        check("src/nowhere/x.rs", "", &["no row"]);
        check("src/cli/x.rs", "use crate::nowhere::X;", &["without a row"]);
    }

    #[test]
    fn spreads_use_trees_and_follows_super() {
        let tree = "use crate::{\n    error::{Error, Result as R},\n    flutter::{self, Onset},\n    units::K,\n};";
        check(
            "src/aeroelastic.rs",
            tree,
            &["`flutter`", "`flutter::Onset`"],
        );
        check(
            "src/section.rs",
            "use super::flutter::Onset;",
            &["flutter::Onset"],
        );
        check("src/flutter/curves.rs", "use super::onset::Onset;", &[]);
        check(
            "src/flutter/curves.rs",
            "use super::super::fmu::Kind;",
            &["fmu::Kind"],
        );
        check("src/section.rs", "mod inner { use super::helper; }", &[]);
        check(
            "src/main.rs",
            "fn main() { aerodeck::fmu::fmi2::run() }",
            &["fmu::fmi2::run"],
        );
    }

    #[test]
    fn knows_data_types_and_functions() {
        check(
            "src/identification/fit.rs",
            "use crate::wind_tunnel::{Record, RecordSource};",
            &[],
        );
        check(
            "src/identification/fit.rs",
            "use crate::wind_tunnel::generate;",
            &["generate"],
        );
        check(
            "src/report/plot.rs",
            "use crate::flutter::FlutterCurves;",
            &[],
        );
        check(
            "src/report/plot.rs",
            "use crate::flutter::find_onset;",
            &["is no type"],
        );
        check("src/units.rs", "use crate::Result;", &[]);
    }

    #[test]
    fn reads_attributes_but_no_comments() {
        check(
            "src/units.rs",
            "#[serde(with = \"crate::section::rows\")] struct S;",
            &["section::rows"],
        );
        check(
            "src/units.rs",
            "// use crate::section::Dof; x.unwrap()\n/* /* unsafe */ panic!() */",
            &[],
        );
        check(
            "src/units.rs",
            "/// [`crate::section::Dof`]\nfn f<'a>(c: char) -> bool { c == '\"' }",
            &[],
        );
    }

    #[test]
    fn sees_abrupt_ends_and_printing() {
        check(
            "src/units.rs",
            "fn f() { x.unwrap(); y.unwrap_or(1); }",
            &["`.unwrap()`"],
        );
        check(
            "src/cli/x.rs",
            "fn f() { x.expect(\"y\"); println!(\"z\"); }",
            &["`.expect(`"],
        );
        check(
            "src/units.rs",
            "fn f() { eprintln!(\"z\"); }",
            &["`eprintln!(`"],
        );
        check(
            "src/units.rs",
            "fn f() { g(\"panic!( .unwrap() \\\" todo!(\", r#\"a\"panic!(\"#); }",
            &[],
        );
        check(
            "src/units.rs",
            "fn f() { todo!() }\nfn g() { unreachable!() }",
            &["todo", "unreachable"],
        );
    }

    #[test]
    fn sees_unsafe_where_it_may_not_be() {
        check("src/fmu/instance.rs", "unsafe fn f() {}", &["`unsafe`"]);
        check(
            "src/fmu/fmi2/exports.rs",
            "#[unsafe(no_mangle)] extern \"C\" fn f() {}",
            &[],
        );
        check("src/fmu/importer/library.rs", "unsafe { f() }", &[]);
        check("src/fmu/importer.rs", "#![allow(unsafe_code)]", &[]);
        check("src/units.rs", "#![deny(unsafe_code)]", &[]);
    }

    #[test]
    fn leaves_test_code_out() {
        let module = "#[cfg(test)]\nmod tests { use crate::section::Dof; fn f() { x.unwrap() } }\nfn g() { y.unwrap() }";
        check("src/units.rs", module, &["units.rs:3"]);
        check(
            "src/units.rs",
            "#[cfg(all(test, unix))] fn f(a: [u8; 2]) { x.unwrap() }",
            &[],
        );
        check(
            "src/units.rs",
            "#[cfg(not(test))] fn f() { x.unwrap() }",
            &["unwrap"],
        );
        let names = |path: &str, text: &str| test_modules(path, &Source::new(text));
        assert_eq!(
            names("src/a/mod.rs", "#[cfg(test)]\nmod checks;"),
            ["src/a/checks"]
        );
        assert_eq!(
            names("src/a/b.rs", "#[cfg(test)] mod checks;"),
            ["src/a/b/checks"]
        );
        let by_path = "#[cfg(test)]\n#[path = \"b_tests.rs\"]\nmod tests;";
        assert_eq!(names("src/a/b.rs", by_path), ["src/a/b_tests"]);
    }
}
