//! The table in `docs/performance.md`.

use crate::stored::compiler;
use std::path::Path;
use std::process::Command;

const BEGIN: &str = "<!-- ledger:begin -->\n";
const END: &str = "<!-- ledger:end -->";

/// Puts the table in its place, with machine and date above it.
pub(crate) fn write(table: &str) -> Result<(), String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/performance.md");
    let said = |e: std::io::Error| format!("{}: {e}", path.display());
    let page = std::fs::read_to_string(&path).map_err(said)?;
    let parts = page
        .split_once(BEGIN)
        .and_then(|(before, rest)| Some((before, rest.split_once(END)?.1)));
    let (before, after) = parts.ok_or_else(|| format!("{}: no markers", path.display()))?;
    let text = format!("{before}{BEGIN}\n{}\n\n{table}\n{END}{after}", head());
    std::fs::write(&path, text).map_err(said)
}

/// Processor, cores, compiler, day.
fn head() -> String {
    let cpus = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = cpus
        .lines()
        .find_map(|line| line.strip_prefix("model name"))
        .map_or("a processor that does not say its name", |rest| {
            rest.trim_start_matches([' ', '\t', ':'])
        });
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let day = Command::new("date").arg("+%Y-%m-%d").output();
    let day = day.map_or(String::new(), |o| {
        String::from_utf8_lossy(&o.stdout).trim().to_owned()
    });
    format!(
        "{day}, {name}, {cores} cores, {} ({}), {}.",
        std::env::consts::OS,
        std::env::consts::ARCH,
        compiler()
    )
}
