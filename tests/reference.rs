//! Every reference case is met, and the table in docs/validation.md says so.
use aerodeck::reference::{CaseResult, Citation, run_all, validation_table};
use std::path::Path;
use std::sync::OnceLock;

const BEGIN: &str = "<!-- validation:begin -->\n";
const END: &str = "<!-- validation:end -->";

fn results() -> &'static [CaseResult] {
    static RESULTS: OnceLock<Vec<CaseResult>> = OnceLock::new();
    RESULTS.get_or_init(|| run_all().unwrap())
}

#[test]
fn reference_cases_are_met() {
    let failed: Vec<String> = results()
        .iter()
        .filter(|r| !r.passed)
        .map(|r| {
            format!(
                "{}: {} {:?} instead of {} ± {} {} {}",
                r.name,
                r.quantity,
                r.found,
                r.expected,
                r.tolerance,
                r.unit,
                r.problem.as_deref().unwrap_or("")
            )
        })
        .collect();
    assert!(failed.is_empty(), "\n{}\n", failed.join("\n"));
}

/// `AERODECK_UPDATE=1 cargo test --test reference` writes the table.
#[test]
fn the_manual_shows_the_results() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/validation.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(BEGIN).unwrap();
    let (block, after) = rest.split_once(END).unwrap();
    let table = format!("\n{}\n", validation_table(results()));
    if std::env::var_os("AERODECK_UPDATE").is_some() {
        std::fs::write(&path, [before, BEGIN, &table, END, after].concat()).unwrap();
        return;
    }
    assert_eq!(
        block, table,
        "the table is out of date: AERODECK_UPDATE=1 cargo test --test reference"
    );
}

/// The README says how many figures there are, and how many of them are published.
#[test]
fn the_readme_counts_the_figures() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = std::fs::read_to_string(path).unwrap();
    let count = results().len();
    let published = |result: &&CaseResult| matches!(result.source, Citation::Published(_));
    let published = results().iter().filter(published).count();
    let said =
        format!("{count} of {count} reference figures are met, {published} of them published");
    let words: Vec<&str> = readme.split_whitespace().collect();
    assert!(words.join(" ").contains(&said), "{said}");
}
