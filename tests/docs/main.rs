//! Keeps the documentation true: every key of every file format has its line, every link leads somewhere, every page is in the
//! table of contents, every formula can be shown, and the tutorial runs.
#[path = "../../examples/book_formulas.rs"]
mod book_formulas;
#[path = "../common/command.rs"]
#[allow(dead_code)] // each room needs a part of it
mod command;
mod examples;
#[allow(dead_code)] // the environment alone
#[path = "../common/python.rs"]
mod python;

use aerodeck::study::Study;
use aerodeck::trained_model::TrainedModel;
use command::{aerodeck, listing, succeeds};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn page(name: &str) -> String {
    let path = root().join(name);
    fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// What the code says it would have taken in the place of an unknown key.
fn listed(message: &str) -> Vec<String> {
    let (_, after) = message
        .split_once("expected one of ")
        .or_else(|| message.split_once("zzz`, expected "))
        .unwrap_or_else(|| panic!("no list of keys in: {message}"));
    let list = after.split(')').next().unwrap();
    let mut keys: Vec<String> = list
        .split('`')
        .skip(1)
        .step_by(2)
        .map(str::to_owned)
        .collect();
    // a long list is cut in the middle of its last word
    if list.contains('…') {
        keys.pop();
    }
    keys
}

#[track_caller]
fn documented(page_name: &str, keys: &[String]) {
    let text = page(page_name);
    assert!(!keys.is_empty());
    for key in keys {
        assert!(
            text.contains(&format!("`{key}`")),
            "`{key}` is not in {page_name}"
        );
    }
}

/// The study with `zzz = 1` in one of its tables.
fn with_unknown(path: &[&str]) -> String {
    let text = page("docs/files/study.md");
    let block = text.split("```toml study\n").nth(1).unwrap();
    let mut study: toml::Table = toml::from_str(block.split("```").next().unwrap()).unwrap();
    let mut at = &mut study;
    for part in path {
        let next = at
            .entry(*part)
            .or_insert_with(|| toml::Value::Table(toml::Table::new()));
        at = match next {
            toml::Value::Array(list) => list[0].as_table_mut().unwrap(),
            other => other.as_table_mut().unwrap(),
        };
    }
    at.insert("zzz".into(), 1.into());
    toml::to_string(&study).unwrap()
}

#[test]
fn every_key_of_a_study_has_its_line() {
    let text = page("docs/files/study.md");
    let block = text.split("```toml study\n").nth(1).unwrap();
    Study::from_toml(block.split("```").next().unwrap(), "".into()).unwrap();
    for path in [
        &[][..],
        &["section"],
        &["section", "vertical"],
        &["section", "torsion"],
        &["deck"],
        &["tunnel"],
        &["model"],
        &["model", "records"],
        &["flutter"],
        &["coefficients"],
        &["export"],
    ] {
        let refused = Study::from_toml(&with_unknown(path), "".into()).unwrap_err();
        documented("docs/files/study.md", &listed(&refused.to_string()));
    }
    // lists that are too long for a message
    let plan = toml::Table::try_from(aerodeck::wind_tunnel::TunnelPlan::default()).unwrap();
    documented(
        "docs/files/study.md",
        &plan.keys().cloned().collect::<Vec<_>>(),
    );
    for fit in [
        serde_json::to_value(aerodeck::identification::TimeFit::default()).unwrap(),
        serde_json::to_value(aerodeck::identification::FrequencyFit::default()).unwrap(),
    ] {
        let keys: Vec<String> = fit.as_object().unwrap().keys().cloned().collect();
        documented("docs/files/study.md", &keys);
    }
}

#[test]
fn every_key_of_wind_and_campaign_files_has_its_line() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("wind.toml"), "zzz = 1\nschema = 1\nname = \"a\"\n").unwrap();
    let (_, _, said) = aerodeck(at, &["quasi-steady", "wind.toml"]);
    documented("docs/files/wind.md", &listed(&said));
    fs::write(
        at.join("wind.toml"),
        "schema = 1\nname = \"a\"\n[simulation]\nzzz = 1\n",
    )
    .unwrap();
    let (_, _, said) = aerodeck(at, &["quasi-steady", "wind.toml"]);
    documented("docs/files/wind.md", &listed(&said));
    fs::write(at.join("campaign.toml"), "zzz = 1\nschema = 1\n").unwrap();
    let (_, _, said) = aerodeck(at, &["campaign", "check", "campaign.toml"]);
    let text = page("docs/campaigns.md");
    for key in listed(&said) {
        let stands = ["[{}", "{} =", "`{}`"].iter().any(|form| {
            let word = form.replace("{}", &key);
            text.contains(&word)
        });
        assert!(stands, "{key} is not in docs/campaigns.md");
    }
}

#[test]
fn every_key_of_results_has_its_line() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["demo", "--out", "d", "--no-figures"]);
    let read = |name: &str| fs::read_to_string(at.join("d").join(name)).unwrap();
    let keys = |value: &Value| {
        value
            .as_object()
            .unwrap()
            .keys()
            .cloned()
            .collect::<Vec<_>>()
    };
    let summary: Value = serde_json::from_str(&read("summary.json")).unwrap();
    documented("docs/files/results.md", &keys(&summary));
    documented("docs/files/results.md", &keys(&summary["onsets"][0]));
    documented("docs/verdict.md", &keys(&summary["verdict"]));
    documented("docs/verdict.md", &keys(&summary["verdict"]["critical"]));
    let model = read("model.json");
    TrainedModel::from_json(&model).unwrap();
    let model: Value = serde_json::from_str(&model).unwrap();
    documented("docs/files/model.md", &keys(&model));
    documented("docs/files/model.md", &keys(&model["provenance"]));
    documented("docs/files/model.md", &keys(&model["experiment"]));
    let header = |text: &str| {
        let lines = text.lines().filter_map(|l| l.strip_prefix("# "));
        let keys = lines
            .filter_map(|l| l.split_once(": "))
            .map(|(k, _)| k.to_owned());
        keys.filter(|k| !k.contains(' ')).collect::<Vec<_>>()
    };
    let record = fs::read_dir(at.join("d/records")).unwrap();
    let record = record
        .map(|e| e.unwrap().path())
        .find(|p| p.extension().is_some_and(|e| e == "csv"))
        .unwrap();
    documented(
        "docs/files/tables.md",
        &header(&fs::read_to_string(record).unwrap()),
    );
    documented(
        "docs/files/tables.md",
        &header(&page("data/decks/LN21-5200.csv")),
    );
    let curves = read("curves.csv");
    let columns = curves.lines().find(|l| !l.starts_with('#')).unwrap();
    let columns: Vec<String> = columns.split(',').map(str::to_owned).collect();
    documented("docs/files/tables.md", &columns);
}

/// All pages: the README files and everything in `docs/`.
fn pages() -> Vec<PathBuf> {
    let mut all = vec![root().join("README.md"), root().join("python/README.md")];
    let mut folders = vec![root().join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "md") {
                all.push(path);
            }
        }
    }
    all
}

#[test]
fn links_lead_somewhere_and_every_page_is_in_the_contents() {
    let mut linked = Vec::new();
    for path in pages() {
        let text = fs::read_to_string(&path).unwrap();
        for target in text
            .split("](")
            .skip(1)
            .map(|t| t.split(')').next().unwrap())
        {
            let file = target.split('#').next().unwrap();
            if file.is_empty() || target.contains("://") {
                continue;
            }
            let at = path.parent().unwrap().join(file);
            assert!(at.exists(), "{}: {target}", path.display());
            if path.ends_with("SUMMARY.md") {
                linked.push(at.canonicalize().unwrap());
            }
        }
    }
    let inside = |p: &&PathBuf| p.starts_with(root().join("docs")) && !p.ends_with("SUMMARY.md");
    for path in pages().iter().filter(inside) {
        assert!(
            linked.contains(&path.canonicalize().unwrap()),
            "{} is not in docs/SUMMARY.md",
            path.display()
        );
    }
}

#[test]
fn every_formula_is_latex() {
    let mut formulas = 0;
    for path in pages() {
        let text = fs::read_to_string(&path).unwrap();
        let book = book_formulas::converted(&text);
        let book = book.unwrap_or_else(|why| panic!("{}: {why}", path.display()));
        let here = text.matches("```math").count();
        assert_eq!(book.matches("<math").count(), here, "{}", path.display());
        formulas += here;
    }
    assert!(formulas > 15, "{formulas}");
    let wrong = book_formulas::converted("```math\n\\frac{1\n```\n");
    assert!(wrong.is_err(), "{wrong:?}");
}

/// Where there is an mdBook, the book is built; every link and every file that a page loads stands in it.
#[test]
fn the_book_is_whole() {
    let folder = TempDir::new().unwrap();
    let built = Command::new("mdbook")
        .current_dir(root())
        .args(["build", "docs", "--dest-dir"])
        .arg(folder.path())
        .output();
    let Ok(output) = built else {
        eprintln!("no mdBook here: the book is not built");
        return;
    };
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let mut formulas = 0;
    for name in listing(folder.path())
        .iter()
        .filter(|n| n.ends_with(".html"))
    {
        let path = folder.path().join(name);
        let text = fs::read_to_string(&path).unwrap();
        formulas += text.matches("<math").count();
        let quoted = |attribute: &str| -> Vec<String> {
            let parts = text.split(attribute).skip(1);
            parts
                .map(|t| t.split('"').next().unwrap().to_owned())
                .collect()
        };
        let loaded = [
            quoted(" src=\""),
            quoted("<link rel=\"stylesheet\" href=\""),
        ]
        .concat();
        assert!(
            loaded.iter().all(|l| !l.contains("://")),
            "{name}: {loaded:?}"
        );
        for target in [quoted("<a href=\""), loaded].concat() {
            let file = target.split('#').next().unwrap();
            // the page of a missing address is served from anywhere
            if file.is_empty() || target.contains("://") || name == "404.html" {
                continue;
            }
            assert!(
                path.parent().unwrap().join(file).exists(),
                "{name}: {target}"
            );
        }
    }
    assert!(formulas > 15, "{formulas}");
}

/// Each row of the glossary names a file that holds its type.
#[test]
fn the_glossary_is_true() {
    let text = page("docs/architecture.md");
    let (_, glossary) = text.split_once("## Glossary").unwrap();
    let glossary = glossary.split("\n## ").next().unwrap();
    let rows: Vec<Vec<&str>> = glossary
        .lines()
        .filter(|line| line.starts_with("| ") && line.contains(".rs`"))
        .map(|line| {
            line.split('|')
                .map(|cell| cell.trim().trim_matches('`'))
                .collect()
        })
        .collect();
    assert!(rows.len() > 20, "{glossary}");
    for row in rows {
        let (name, source) = (row[2], page(row[3]));
        let is_there = ["struct", "enum", "trait"]
            .iter()
            .any(|kind| source.contains(&format!("pub {kind} {name}")));
        assert!(is_there, "{name} is not in {}", row[3]);
    }
}

/// Items of the library that pages name by a path are there.
#[test]
fn items_that_pages_name_are_there() {
    let mut source = String::new();
    let mut waiting = ["src", "crates"].map(|name| root().join(name)).to_vec();
    while let Some(path) = waiting.pop() {
        if path.is_dir() {
            let entries = fs::read_dir(path).unwrap();
            waiting.extend(entries.map(|entry| entry.unwrap().path()));
        } else if path.extension().is_some_and(|e| e == "rs") {
            source.push_str(&fs::read_to_string(path).unwrap());
        }
    }
    let mut named = 0;
    for path in pages() {
        let text = fs::read_to_string(&path).unwrap();
        let quoted = text.split('`').skip(1).step_by(2);
        for item in quoted.filter(|q| q.contains("::") && !q.contains([' ', '\n', '/'])) {
            let name = item.rsplit("::").next().unwrap();
            let kinds = ["fn", "mod", "struct", "enum", "trait", "pub", "const", "as"];
            let is_there = kinds
                .iter()
                .any(|kind| source.contains(&format!("{kind} {name}")));
            assert!(
                is_there || item.starts_with("clippy::"),
                "{}: {item}",
                path.display()
            );
            named += 1;
        }
    }
    assert!(named > 20, "{named}");
}

/// Files of the source that pages name are there.
#[test]
fn sources_that_pages_name_are_there() {
    let pages = ["docs", "docs/files"].map(|name| fs::read_dir(root().join(name)).unwrap());
    let mut named = 0;
    for path in pages
        .into_iter()
        .flatten()
        .map(|entry| entry.unwrap().path())
    {
        if path.extension().is_none_or(|e| e != "md") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        for quoted in text.split('`').skip(1).step_by(2) {
            if !quoted.ends_with(".rs")
                || !(quoted.starts_with("src/") || quoted.starts_with("crates/"))
            {
                continue;
            }
            named += 1;
            assert!(
                root().join(quoted).is_file(),
                "{}: {quoted}",
                path.display()
            );
        }
    }
    assert!(named > 20, "{named}");
}
