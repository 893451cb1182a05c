//! The ledger: what the program costs, in one table.
//!
//! - `cargo bench` runs every entry of `registry.rs` and prints the table; `-- --write` also writes it to
//!   `docs/performance.md`.
//! - `cargo bench -- NAME …` runs the entry of this name, or all whose names begin so; `-- --list` names them.
//! - `cargo bench -- --count` counts instructions under valgrind and peak memory, and fails where more is used than
//!   `benches/instructions.json` has; `-- --count --store` writes that file, `-- --count NAME` counts some.
//! - `cargo bench -- --growth` measures how cost grows with size, and prints a table; `-- --growth --write` also writes it to
//!   `docs/performance.md`, with `docs/growth.svg`; `-- --growth NAME …` measures some curves.
//!
//! Every entry is timed, counted and weighed in a process of its own, which this program starts from itself: so peaks are
//! its own, and the number of threads holds for it alone.

mod baseline;
#[allow(dead_code)] // the entries need some of them
#[path = "../../tests/common/bridges.rs"]
mod bridges;
mod counting;
mod entry;
mod growth;
mod jobs;
mod peak;
mod performance;
#[allow(dead_code)] // the environment alone
#[path = "../../tests/common/python.rs"]
mod python;
mod registry;
mod stored;
mod table;
mod timing;
#[path = "../../tests/common/trained.rs"]
mod trained;

use entry::BenchEntry;
use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|w| w != "--bench")
        .collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match run(&words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}

fn run(words: &[&str]) -> Result<(), String> {
    match words {
        ["--list"] => {
            for entry in registry::all() {
                println!("{:24} {}, {}", entry.name, entry.what, entry.size);
            }
            Ok(())
        }
        // in a process of its own
        ["--do", name, times] => {
            let times = times.parse().map_err(|e| format!("{times}: {e}"))?;
            (registry::named(name)?.job)().run(times);
            Ok(())
        }
        ["--time", name] => timing::print(registry::named(name)?),
        ["--peak", name] => peak::print(registry::named(name)?),
        ["--point", name, size] => growth::print_point(name, size),
        ["--growth", "--write"] => growth::run(&[], true),
        ["--growth", names @ ..] => growth::run(names, false),
        ["--count", "--store"] => counting::store(),
        ["--count", names @ ..] => counting::judge(&chosen(names)?),
        ["--write"] => {
            let head = performance::head();
            performance::write("ledger", &head, &table::print(&chosen(&[])?)?)
        }
        names => table::print(&chosen(names)?).map(drop),
    }
}

/// The entries of these names, or whose names begin so; all where there is none.
fn chosen(names: &[&str]) -> Result<Vec<&'static BenchEntry>, String> {
    if names.is_empty() {
        return Ok(registry::all().collect());
    }
    let mut all = Vec::new();
    for name in names {
        let before = all.len();
        match registry::named(name) {
            Ok(entry) => all.push(entry),
            Err(_) => all.extend(registry::all().filter(|e| e.name.starts_with(name))),
        }
        if all.len() == before {
            return Err(format!(
                "no entry begins with `{name}`; `cargo bench -- --list` names all"
            ));
        }
    }
    Ok(all)
}
