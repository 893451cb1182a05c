//! The table in `docs/performance.md`.

use crate::stored::compiler;
use std::path::Path;
use std::process::Command;

/// Puts a table in its place, with a head above it.
pub(crate) fn write(place: &str, head: &str, table: &str) -> Result<(), String> {
    let begin = format!("<!-- {place}:begin -->\n");
    let end = format!("<!-- {place}:end -->");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/performance.md");
    let said = |e: std::io::Error| format!("{}: {e}", path.display());
    let page = std::fs::read_to_string(&path).map_err(said)?;
    let parts = page
        .split_once(&begin)
        .and_then(|(before, rest)| Some((before, rest.split_once(&end)?.1)));
    let (before, after) = parts.ok_or_else(|| format!("{}: no markers", path.display()))?;
    let text = format!("{before}{begin}\n{head}\n\n{table}\n{end}{after}");
    std::fs::write(&path, text).map_err(said)
}

/// Processor, cores, compiler, day, and how busy the machine was before.
pub(crate) fn head() -> String {
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
    let busy = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let busy = busy.split(' ').next().filter(|load| !load.is_empty());
    let busy = busy.map_or(String::new(), |load| {
        format!(" Busy with others in the minute before: {load} cores.")
    });
    format!(
        "{day}, {name}, {cores} cores, {} ({}), {}.{busy}",
        std::env::consts::OS,
        std::env::consts::ARCH,
        compiler()
    )
}
