//! The command line as people expect it: the same flags everywhere, and nothing half-written after Ctrl-C.

use crate::command::{self, listing, succeeds};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// Commands that write nothing, or to standard output, or to a place that is an argument of its own.
const WITHOUT_OUT: [&str; 13] = [
    "bridge convert",
    "campaign check",
    "compare signals",
    "completions",
    "coverage",
    "derivatives convert",
    "derivatives notations",
    "derivatives show",
    "derivatives template",
    "fmu check",
    "fmu replay",
    "report",
    "validate",
];
/// Commands that write files which users edit or hand on. What can be computed again is replaced without being asked.
const WITH_FORCE: [&str; 12] = [
    "bridge convert",
    "buffeting",
    "campaign virtual",
    "demo",
    "derivatives template",
    "fmu export",
    "new",
    "process",
    "quasi-steady",
    "select",
    "ssp export",
    "study",
];

/// Every command with its help, from the program itself.
fn commands(at: &Path, path: &str) -> Vec<(String, String)> {
    let arguments: Vec<&str> = path
        .split(' ')
        .chain(["--help"])
        .filter(|a| !a.is_empty())
        .collect();
    let help = succeeds(at, &arguments);
    let listed = help.split_once("Commands:\n").map_or("", |(_, rest)| rest);
    let listed = listed.split("\n\n").next().unwrap_or("");
    let names = listed
        .lines()
        .filter(|l| l.starts_with("  ") && !l.starts_with("   "));
    let names: Vec<&str> = names.filter_map(|l| l.split_whitespace().next()).collect();
    if names.is_empty() {
        return vec![(path.to_owned(), help)];
    }
    let below = names.into_iter().filter(|n| *n != "help");
    below
        .flat_map(|n| commands(at, format!("{path} {n}").trim()))
        .collect()
}

/// What the help says of a flag; `None` where there is none.
fn said<'a>(help: &'a str, flag: &str) -> Option<&'a str> {
    let mut lines = help.lines();
    lines.find(|l| l.split([' ', ',']).any(|word| word == flag))?;
    lines.next().map(str::trim)
}

#[test]
fn flags_mean_the_same_in_every_command() {
    let folder = TempDir::new().unwrap();
    let all = commands(folder.path(), "");
    assert!(all.len() > 25, "{}", all.len());
    for (name, help) in &all {
        for flag in ["--json", "--quiet", "--verbose", "--no-figures", "--png"] {
            assert!(said(help, flag).is_some(), "{name} has no {flag}");
        }
        let out = said(help, "--out").is_some();
        assert_eq!(
            out,
            !WITHOUT_OUT.contains(&name.as_str()),
            "--out of {name}"
        );
        let force = said(help, "--force");
        assert_eq!(
            force.is_some(),
            WITH_FORCE.contains(&name.as_str()),
            "--force of {name}"
        );
        if let Some(meaning) = force {
            assert!(meaning.starts_with("Replace a "), "{name}: {meaning}");
        }
        let defaults = help.lines().map(str::trim);
        for value in defaults.filter_map(|l| l.strip_prefix("[default: ")) {
            let typed = value.contains('"') || !value.contains(' ');
            assert!(typed, "{name}: {value} is no value as it is typed");
        }
        for (short, long) in [("-o", "--out"), ("-f", "--force")] {
            assert!(
                said(help, short).is_none(),
                "{name} has {short} for {long}, the others do not"
            );
        }
    }
}

#[test]
fn wrong_arguments_are_json_where_json_was_asked_for() {
    let folder = TempDir::new().unwrap();
    for (name, _) in commands(folder.path(), "") {
        let arguments: Vec<&str> = name.split(' ').chain(["--json", "--nonsense"]).collect();
        let (code, stdout, stderr) = command::aerodeck(folder.path(), &arguments);
        assert_eq!(code, 2, "{name}");
        let value: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        let text = value["error"].as_str().unwrap();
        assert!(
            text.contains("--nonsense") && stderr.contains("--nonsense"),
            "{name}: {text}"
        );
    }
    assert_eq!(listing(folder.path()), Vec::<String>::new());
}

/// Interrupted at any time, a command leaves all of its results or none, and no temporary file anywhere.
#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing_half_written() {
    let whole = TempDir::new().unwrap();
    succeeds(whole.path(), &["demo", "--out", "d", "--quiet"]);
    let whole = listing(whole.path());
    let mut interrupted = 0;
    for after_ms in [0, 20, 80, 150, 250, 400, 700, 1000, 1400] {
        let folder = TempDir::new().unwrap();
        let temporary = TempDir::new().unwrap();
        let mut program = Command::new(env!("CARGO_BIN_EXE_aerodeck"))
            .args(["demo", "--out", "d", "--quiet"])
            .current_dir(folder.path())
            .env("TMPDIR", temporary.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(after_ms));
        let pid = program.id().to_string();
        let _ = Command::new("kill").args(["-INT", &pid]).status();
        let status = program.wait().unwrap();
        let left = listing(folder.path());
        assert!(
            left.iter().all(|name| !name.contains(".aerodeck")),
            "after {after_ms} ms: {left:?}"
        );
        assert_eq!(
            listing(temporary.path()),
            Vec::<String>::new(),
            "after {after_ms} ms"
        );
        interrupted += usize::from(!status.success());
        // the signal may come after the results and before the end
        let none = !status.success() && left.iter().all(|name| !name.contains('.'));
        assert!(none || left == whole, "after {after_ms} ms: {left:?}");
    }
    assert!(
        interrupted >= 2,
        "the program was too fast to be interrupted"
    );
}

/// `AERODECK_UPDATE=1 cargo test --test cli manual` writes the page.
#[test]
fn the_manual_lists_every_command() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/commands.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (head, listed) = page.split_once("\n## ").unwrap();
    let made = aerodeck::cli::commands_page();
    if std::env::var_os("AERODECK_UPDATE").is_some() {
        return std::fs::write(&path, format!("{head}\n{made}")).unwrap();
    }
    assert_eq!(
        format!("## {listed}"),
        made,
        "AERODECK_UPDATE=1 cargo test --test cli manual"
    );
}

/// What was set is named, and no line, since none is where it was.
#[test]
fn a_wrong_value_that_was_set_is_named() {
    let folder = TempDir::new().unwrap();
    let good = aerodeck::study::demo_study_text();
    std::fs::write(folder.path().join("study.toml"), good).unwrap();
    let set = ["study", "study.toml", "--set", "section.width_m=-1"];
    let said = "study.toml --set section.width_m=-1: section.width_m: expected a positive number";
    command::refused(folder.path(), &set, &[said]);
    let discrete = "--kind discrete --max 1.5";
    for (wrong, said) in [
        (
            "monte-carlo scatter.toml --samples 0",
            "--samples: expected a number from 1 to 1e8, found 0",
        ),
        (
            &format!("select study.toml {discrete}"),
            "--min, --max: expected two decay factors between 0 and 1",
        ),
        (
            "select study.toml --frequency nan",
            "--frequency: expected a frequency of the tests, 0.25 to 2.51 Hz",
        ),
        ("select study.toml --frequency 100", "found 100"),
    ] {
        let words: Vec<&str> = wrong.split(' ').collect();
        command::refused(folder.path(), &words, &[said]);
    }
}
