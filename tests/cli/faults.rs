//! What may not go wrong whatever happens to a run: closed outputs, signals, two runs at once, files that users edited.

use crate::command::{aerodeck, listing, refused, succeeds};
use std::fs;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A command that prints a table and writes nothing.
const PRINTS: [&str; 2] = ["derivatives", "notations"];

fn program(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_aerodeck"));
    command.current_dir(folder).args(arguments);
    command
}

fn into(stdout: impl Into<Stdio>, arguments: &[&str]) -> (Option<i32>, String) {
    let folder = TempDir::new().unwrap();
    let output: Output = program(folder.path(), arguments)
        .stdout(stdout)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
        .wait_with_output()
        .unwrap();
    (
        output.status.code(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

#[test]
fn a_closed_pipe_ends_quietly() {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    assert_eq!(into(writer, &PRINTS), (Some(0), String::new()));
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_said() {
    for json in [false, true] {
        let full = fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let mut arguments = PRINTS.to_vec();
        arguments.extend(json.then_some("--json"));
        let (code, said) = into(full, &arguments);
        assert_eq!(code, Some(1), "{said}");
        assert!(said.contains("standard output: No space left"), "{said}");
        assert!(!said.contains("panicked"), "{said}");
    }
}

/// What nobody can read is not computed: the answer of a verdict would be lost with the code of success.
#[test]
#[cfg(target_os = "linux")]
fn a_closed_standard_output_is_said() {
    let closed = |arguments: &str, open: &str| {
        let program = env!("CARGO_BIN_EXE_aerodeck");
        let line = format!("'{program}' {arguments} {open}");
        let output = Command::new("sh").args(["-c", &line]).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), said)
    };
    for arguments in [
        "derivatives notations",
        "derivatives notations --json",
        "--help",
    ] {
        let (code, said) = closed(arguments, ">&-");
        assert_eq!(code, Some(1), "{said}");
        assert!(
            said.starts_with("error: standard output is closed"),
            "{said}"
        );
        assert_eq!(closed(arguments, ">/dev/null"), (Some(0), String::new()));
        assert_eq!(
            closed(arguments, "<&- >/dev/null 2>&-"),
            (Some(0), String::new())
        );
    }
}

/// Results are text, which holds no name that is none.
#[test]
#[cfg(unix)]
fn names_that_are_no_text_are_refused() {
    use std::os::unix::ffi::OsStrExt as _;
    let name = std::ffi::OsStr::from_bytes(b"a\xff.toml");
    // the second takes texts, at which the parser of the command line would stop without a name
    for command in [&["study"][..], &["derivatives", "show"]] {
        let mut program = Command::new(env!("CARGO_BIN_EXE_aerodeck"));
        let output = program.args(command).arg(name).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        let said = String::from_utf8(output.stderr).unwrap();
        let expected =
            "error: arguments: expected names and paths in UTF-8, found a\u{fffd}.toml\n";
        assert_eq!(said, expected);
    }
}

/// The demo, as soon as it has begun to write aside.
fn demo_at_work(folder: &Path) -> Child {
    let child = program(folder, &["demo", "--quiet"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let records = |name: &String| name.contains(".aerodeck-") && name.contains("records");
    let begun = Instant::now();
    while !listing_while_changing(folder).iter().any(records) {
        assert!(begun.elapsed() < Duration::from_secs(60), "no staging");
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

/// As [`listing`], for a folder in which files come and go.
fn listing_while_changing(folder: &Path) -> Vec<String> {
    let out = folder.join("aerodeck-out");
    let inside = |path: &Path| -> Vec<std::path::PathBuf> {
        let entries = fs::read_dir(path).into_iter().flatten().flatten();
        entries.map(|e| e.path()).collect()
    };
    let top = inside(&out);
    let below = top.iter().flat_map(|path| inside(path));
    let all: Vec<_> = top.iter().cloned().chain(below).collect();
    all.iter().map(|p| p.display().to_string()).collect()
}

fn signal(child: &Child, name: &str) {
    let status = Command::new("kill")
        .args([name, &child.id().to_string()])
        .status();
    assert!(status.unwrap().success());
}

#[test]
fn signals_clean_up() {
    for (name, number) in [("-INT", 2), ("-TERM", 15)] {
        let folder = TempDir::new().unwrap();
        let child = demo_at_work(folder.path());
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(128 + number), "{output:?}");
        let left = listing(folder.path());
        assert!(left.iter().all(|n| n == "aerodeck-out"), "{left:?}");
    }
}

#[test]
fn the_next_run_clears_away_what_a_killed_one_left() {
    let folder = TempDir::new().unwrap();
    let child = demo_at_work(folder.path());
    signal(&child, "-KILL");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.signal(), Some(9));
    let hidden = |n: &String| n.contains(".aerodeck-");
    assert!(listing(folder.path()).iter().any(hidden));
    fs::write(folder.path().join("study.toml"), short_study()).unwrap();
    succeeds(
        folder.path(),
        &["tunnel", "study.toml", "--out", "aerodeck-out"],
    );
    let left = listing(folder.path());
    assert!(!left.iter().any(hidden), "{left:?}");
    assert!(left.iter().any(|n| n.starts_with("aerodeck-out/records/")));
}

#[test]
fn two_runs_in_one_folder_exclude_each_other() {
    let folder = TempDir::new().unwrap();
    let mut first = demo_at_work(folder.path());
    fs::write(folder.path().join("study.toml"), short_study()).unwrap();
    let second = ["tunnel", "study.toml", "--out", "aerodeck-out"];
    let (code, _, said) = aerodeck(folder.path(), &second);
    let running = first.try_wait().unwrap().is_none();
    signal(&first, "-TERM");
    first.wait().unwrap();
    assert!(running, "the first run was over too soon");
    assert_eq!(code, 2, "{said}");
    let pid = format!("process {}", first.id());
    for word in ["no other run of aerodeck", &pid, "aerodeck-out"] {
        assert!(said.contains(word), "`{word}` is not in: {said}");
    }
}

fn short_study() -> String {
    aerodeck::study::demo_study_text().to_owned()
}

/// Edits a file and returns its new text.
fn edit(path: impl AsRef<Path>) -> String {
    let text = fs::read_to_string(&path).unwrap() + "# edited\n";
    fs::write(&path, &text).unwrap();
    text
}

#[test]
fn edited_examples_are_left_as_they_are() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    for command in ["quasi-steady", "buffeting"] {
        let wind = at.join(command).join("wind.toml");
        succeeds(at, &[command, "--out", command]);
        succeeds(at, &[command, "--out", command]);
        let edited = edit(&wind);
        let words = ["wind.toml", "--force", "left as it is"];
        refused(at, &[command, "--out", command], &words);
        assert_eq!(fs::read_to_string(&wind).unwrap(), edited);
        succeeds(at, &[command, "--out", command, "--force"]);
        let text = fs::read_to_string(&wind).unwrap();
        assert_eq!(text, aerodeck::study::example_wind_study_text());
    }
}

#[test]
fn an_edited_campaign_and_study_are_left_as_they_are() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let campaign = [
        "campaign",
        "virtual",
        "LN21-5200",
        "--clean",
        "--out",
        "raw",
    ];
    succeeds(at, &campaign);
    succeeds(at, &campaign);
    let edited = edit(at.join("raw/campaign.toml"));
    refused(
        at,
        &campaign,
        &["campaign.toml", "--force", "left as it is"],
    );
    let text = fs::read_to_string(at.join("raw/campaign.toml")).unwrap();
    assert_eq!(text, edited);
    let forced = [&campaign[..], &["--force"]].concat();
    succeeds(at, &forced);

    let process = ["process", "raw/campaign.toml", "--out", "results"];
    let said = succeeds(at, &process);
    assert!(said.contains("state the section"), "{said}");
    // the marked place is refused in so many words, and accepted once it is filled in
    let study = at.join("results/study.toml");
    let words = ["study.toml", "section", "which no campaign or table knows"];
    refused(at, &["tunnel", "results/study.toml"], &words);
    let filled = fs::read_to_string(&study)
        .unwrap()
        .replace("# [section]", "[section]")
        .replace("# width_m", "width_m")
        .replace("# air_density", "air_density")
        .replace(
            "# vertical = { mass_kg_m = ?, frequency_hz = ?, damping_ratio = ? }",
            "vertical = { mass_kg_m = 17.5, frequency_hz = 2.1, damping_ratio = 0.004 }",
        )
        .replace(
            "# torsion = { inertia_kg_m2_m = ?, frequency_hz = ?, damping_ratio = ? }",
            "torsion = { inertia_kg_m2_m = 0.7, frequency_hz = 5.2, damping_ratio = 0.004 }",
        );
    fs::write(&study, &filled).unwrap();
    let read = aerodeck::study::Study::read(&study).unwrap();
    assert_eq!(read.section.vertical.mass_kg_m, 17.5);
    let said = succeeds(at, &process);
    assert!(said.contains("kept results/study.toml"), "{said}");
    assert_eq!(fs::read_to_string(&study).unwrap(), filled);
    succeeds(at, &[&process[..], &["--force"]].concat());
    assert_ne!(fs::read_to_string(&study).unwrap(), filled);
}
