//! Folders of results: complete or not there, and nothing that an earlier run left.

use super::*;

#[test]
fn complete_folders_of_killed_runs_are_put_in_place_and_others_removed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let make = |name: &str, text: &str| {
        let path = at.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    make("model.json", "old");
    make(".aerodeck-abc/model.json", "half");
    make(".aerodeck-complete-def/model.json", "new");
    make(".aerodeck-complete-def/records/a.csv", "a");
    drop(OutputDir::new(at).unwrap());
    let read = |name: &str| fs::read_to_string(at.join(name)).unwrap();
    assert_eq!(read("model.json"), "new");
    assert_eq!(read("records/a.csv"), "a");
    assert_eq!(fs::read_dir(at).unwrap().count(), 2);
}

#[test]
fn what_an_earlier_run_left_goes_when_this_one_has_none() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for name in ["old.fmu", "both.json"] {
        fs::write(at.join(name), "old").unwrap();
    }
    let mut out = OutputDir::new(at).unwrap();
    for name in ["old.fmu", "both.json", "never.svg"] {
        out.outdated(name);
    }
    out.write("both.json", "new").unwrap();
    assert!(at.join("old.fmu").exists(), "until the others come");
    out.commit().unwrap();
    assert!(!at.join("old.fmu").exists());
    assert_eq!(fs::read_to_string(at.join("both.json")).unwrap(), "new");
}

#[test]
fn a_file_is_no_folder_of_results() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("results");
    fs::write(&file, "mine").unwrap();
    let said = OutputDir::new(&file).err().unwrap().to_string();
    assert!(
        said.ends_with("expected a folder for the results, found a file"),
        "{said}"
    );
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
}

#[test]
fn one_run_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let first = OutputDir::new(folder.path()).unwrap();
    let refused = OutputDir::new(folder.path()).err().unwrap().to_string();
    let pid = std::process::id().to_string();
    assert!(refused.contains(&pid), "{refused}");
    first.commit().unwrap();
    OutputDir::new(folder.path()).unwrap();
    // a lock file that a killed run left locks nobody out
    fs::write(folder.path().join(LOCK_FILE), "1").unwrap();
    OutputDir::new(folder.path()).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_new_folder_goes_with_a_run_that_fails() {
    let folder = tempfile::tempdir().unwrap();
    let mut out = OutputDir::new(&folder.path().join("new")).unwrap();
    out.write("a/b.txt", "b").unwrap();
    drop(out);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
