//! Runs are read in parallel; what is wrong with them is said run by run, in the order of the file.

use super::*;

/// `small()` with as many runs as there are names, each on recordings of its own name.
fn campaign_of(names: &[&str]) -> String {
    let text = small();
    let head = &text[..text.find("[[run]]").unwrap()];
    let mut all = head.to_owned();
    for name in names {
        let _ = write!(
            all,
            "[[run]]\nname = \"{name}\"\nmotion = [\"vertical\"]\nin_wind = \"{name}.csv\"\nstill_air = \"b.csv\"\n"
        );
    }
    all
}

#[test]
fn the_errors_of_all_runs_come_in_their_order() {
    let names = ["r0", "r1", "r2", "r3", "r4", "r5", "r6", "r7"];
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("campaign.toml", &campaign_of(&names));
    write("b.csv", &recording(200, still));
    // the first fails late, those behind it at once; one is sound
    write(
        "r0.csv",
        &recording(20_000, |i, row| {
            row[2] = if i == 19_999 { f64::NAN } else { row[2] }
        }),
    );
    write("r3.csv", &recording(200, |_, _| {}));
    let campaign = Campaign::read(folder.path().join("campaign.toml")).unwrap();
    let said = campaign.load().unwrap_err().to_string();
    let lines: Vec<&str> = said.lines().collect();
    assert_eq!(lines.len(), 8, "{said}");
    assert!(lines[0].contains("7 errors"), "{said}");
    let failed = names.iter().filter(|n| **n != "r3");
    for (line, name) in lines[1..].iter().zip(failed) {
        assert!(
            line.contains(&format!("{name}.csv: run `{name}`, in wind")),
            "{said}"
        );
    }
    assert!(lines[1].contains("sample 19999"), "{said}");
}
