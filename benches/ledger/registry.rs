//! The lines of the ledger, in their order. A new line is one entry in one of the lists, and its job in `jobs`.

mod bridges;
mod onsets;
mod records;
mod steps;

use crate::entry::{Baseline, BenchEntry, Threads};

/// All entries.
pub(crate) fn all() -> impl Iterator<Item = &'static BenchEntry> {
    let lists = [
        steps::ENTRIES,
        onsets::ENTRIES,
        bridges::ENTRIES,
        records::ENTRIES,
    ];
    lists.into_iter().flatten()
}

/// The entry of this name.
pub(crate) fn named(name: &str) -> Result<&'static BenchEntry, String> {
    let found = all().find(|e| e.name == name);
    found.ok_or_else(|| format!("no entry `{name}`"))
}

/// One thread, once, nothing counted: what an entry does not state.
const PLAIN: BenchEntry = BenchEntry {
    name: "",
    what: "",
    size: "",
    threads: Threads::One,
    prepare: None,
    job: || crate::entry::Job::new(|| ()),
    units: 1,
    times: 1,
    baseline: Baseline::None(""),
    count: None,
    is_step: false,
    judged_peak: false,
};

const NOBODY: Baseline = Baseline::None("no package known that has it in this definition");

const OWN_FORMAT: Baseline = Baseline::None("the files and the steps are ours alone");

const NO_FMU: Baseline = Baseline::None("the reference FMUs have other equations, no aerodynamics");
