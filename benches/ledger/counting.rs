//! Instructions by valgrind and peaks by the operating system, against what is stored.

use crate::entry::BenchEntry;
use crate::peak;
use crate::registry;
use crate::stored::{StoredCounts, StoredFigure, compiler};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How far above what is stored a count may lie: one and the same program repeats itself to a fraction of this.
const COUNT_AT_MOST: f64 = 1.03;
/// The same of a peak, which pages and threads move.
const PEAK_AT_MOST: f64 = 1.10;

/// The C library's plainest functions, whatever the processor could do: their choice alone moves counts by up to 3 %. Names of
/// libraries before and since 2.33; unknown ones are passed over.
const PLAIN_FUNCTIONS: &str =
    "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-ERMS,-AVX_Fast_Unaligned_Load,-AVX2_Usable,-FMA_Usable";

/// How much more than the median of its like a single step may cost, once its kind of change has been seen.
const STEP_AT_MOST: f64 = 3.0;
/// Steps that are looked at one by one, and those before them.
const SINGLE_STEPS: u32 = 100;
const FIRST_STEPS: usize = 12;

/// What one entry uses.
#[derive(Clone, Copy, Default)]
struct Used {
    instructions: Option<f64>,
    peak_mib: Option<f64>,
    /// The dearest single step over the median.
    dearest: Option<f64>,
}

/// Counts again and fails where more is used than is stored.
pub(crate) fn judge(entries: &[&BenchEntry]) -> Result<(), String> {
    let stored = StoredCounts::read()?;
    let found = measured(entries)?;
    // another compiler makes another program
    let comparable = stored.compiler == compiler();
    let count_at_most = if comparable {
        COUNT_AT_MOST
    } else {
        f64::INFINITY
    };
    let mut wrong = Vec::new();
    for (entry, used) in entries.iter().zip(&found) {
        let figures = [
            (
                "instructions",
                used.instructions,
                &stored.instructions,
                count_at_most,
            ),
            ("MiB at most", used.peak_mib, &stored.peak_mib, PEAK_AT_MOST),
        ];
        if let Some(dearest) = used.dearest {
            let line = format!("{:24} {dearest:>14.2} times the median step", entry.name);
            println!("{line}");
            if dearest > STEP_AT_MOST {
                wrong.push(line);
            }
        }
        for (unit, now, before, factor) in figures {
            let Some(now) = now else { continue };
            let line = line(entry, unit, now, before.get(entry.name));
            println!("{line}");
            let most = before.get(entry.name).map_or(0.0, |f| f.value * factor);
            if now > most {
                wrong.push(line);
            }
        }
    }
    if !comparable {
        println!(
            "instructions are NOT JUDGED: stored with {}, counted with {}",
            stored.compiler,
            compiler()
        );
    }
    if wrong.is_empty() {
        return Ok(());
    }
    Err(format!(
        "\nmore than stored in benches/instructions.json ({} % of instructions, {} % of memory are let pass):\n{}\n\
         Where it is meant to rise: cargo bench --bench ledger -- --count --store, and the reason beside the figure.",
        (100.0 * (COUNT_AT_MOST - 1.0)).round(),
        (100.0 * (PEAK_AT_MOST - 1.0)).round(),
        wrong.join("\n"),
    ))
}

fn line(entry: &BenchEntry, unit: &str, now: f64, before: Option<&StoredFigure>) -> String {
    let against = match before {
        None => "nothing stored".to_owned(),
        Some(f) => {
            let change = 100.0 * (now / f.value - 1.0);
            let reason = f
                .reason
                .as_ref()
                .map_or(String::new(), |r| format!(" ({r})"));
            format!("stored {}{reason}: {change:+.1} %", f.value)
        }
    };
    format!("{:24} {now:>14} {unit}, {against}", entry.name)
}

/// Writes what is used now; reasons stay beside the figures that they belong to.
pub(crate) fn store() -> Result<(), String> {
    let all: Vec<&BenchEntry> = registry::all().collect();
    let found = measured(&all)?;
    let before = StoredCounts::read()?;
    let mut stored = StoredCounts {
        compiler: compiler(),
        ..StoredCounts::default()
    };
    for (entry, used) in all.iter().zip(&found) {
        let name = entry.name;
        keep(
            &mut stored.instructions,
            &before.instructions,
            name,
            used.instructions,
        );
        keep(&mut stored.peak_mib, &before.peak_mib, name, used.peak_mib);
    }
    stored.write()
}

fn keep(
    into: &mut BTreeMap<String, StoredFigure>,
    before: &BTreeMap<String, StoredFigure>,
    name: &str,
    value: Option<f64>,
) {
    let reason = before.get(name).and_then(|f| f.reason.clone());
    if let Some(value) = value {
        into.insert(name.to_owned(), StoredFigure { value, reason });
    }
}

/// What each entry uses, as far as it is counted; as many at once as there are cores.
fn measured(entries: &[&BenchEntry]) -> Result<Vec<Used>, String> {
    if !cfg!(target_arch = "x86_64") {
        return Err("instructions are stored for x86-64".to_owned());
    }
    // peaks first and one by one: they use all cores, and their preparation is kept for the counting
    let mut found = Vec::new();
    for entry in entries {
        let peak_mib = match entry.judged_peak {
            true => peak::measured(entry)?,
            false => None,
        };
        found.push(Used {
            peak_mib,
            ..Used::default()
        });
    }
    let next = AtomicUsize::new(0);
    let results = Mutex::new(vec![Ok((None, None)); entries.len()]);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                while let Some((i, entry)) = next_of(&next, entries) {
                    let count = instructions(entry).and_then(|n| Ok((n, dearest_step(entry)?)));
                    if let Ok(mut results) = results.lock() {
                        results[i] = count;
                    }
                }
            });
        }
    });
    let results = results.into_inner().map_err(|e| e.to_string())?;
    for (used, count) in found.iter_mut().zip(results) {
        (used.instructions, used.dearest) = count?;
    }
    Ok(found)
}

fn next_of<'a>(next: &AtomicUsize, entries: &[&'a BenchEntry]) -> Option<(usize, &'a BenchEntry)> {
    let i = next.fetch_add(1, Ordering::Relaxed);
    entries.get(i).map(|e| (i, *e))
}

/// Instructions of a unit: the difference of two runs, free of what comes before.
fn instructions(entry: &BenchEntry) -> Result<Option<f64>, String> {
    let Some([few, many]) = entry.count else {
        return Ok(None);
    };
    let more = of_whole_run(entry, many)? - of_whole_run(entry, few)?;
    let each = more / f64::from(many - few) / f64::from(entry.units);
    Ok(Some(each.round()))
}

/// The dearest of many single steps over their median, each from one call of `fmi2DoStep` to the next.
fn dearest_step(entry: &BenchEntry) -> Result<Option<f64>, String> {
    if !entry.is_step {
        return Ok(None);
    }
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let file = folder.path().join("part");
    let options = ["--dump-before=fmi2DoStep".to_owned(), out_file(&file)];
    under_valgrind(entry, SINGLE_STEPS, &options)?;
    // part n ends with the call n; what follows the last call is not a step
    let part = |n: u32| {
        let text = std::fs::read_to_string(file.with_extension(n.to_string())).ok()?;
        let line = text
            .lines()
            .find_map(|line| line.strip_prefix("totals: "))?;
        line.trim().parse::<f64>().ok()
    };
    let parts: Option<Vec<f64>> = (2..=SINGLE_STEPS).map(part).collect();
    let parts = parts.ok_or_else(|| format!("{}: callgrind saw no steps", entry.name))?;
    let mut steps = parts[FIRST_STEPS..].to_vec();
    steps.sort_by(f64::total_cmp);
    Ok(Some(steps[steps.len() - 1] / steps[steps.len() / 2]))
}

fn out_file(path: &Path) -> String {
    format!("--callgrind-out-file={}", path.display())
}

/// Instructions of a process that does the job so often.
fn of_whole_run(entry: &BenchEntry, times: u32) -> Result<f64, String> {
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let said = under_valgrind(entry, times, &[out_file(&folder.path().join("counts"))])?;
    let line = said.lines().find(|line| line.contains("Collected :"));
    line.and_then(|line| line.rsplit(' ').next()?.parse().ok())
        .ok_or_else(|| format!("{}: {said}", entry.name))
}

/// What callgrind says about it.
fn under_valgrind(entry: &BenchEntry, times: u32, options: &[String]) -> Result<String, String> {
    let own = entry.process("--do")?;
    let output = Command::new("valgrind")
        .arg("--tool=callgrind")
        .args(options)
        .arg(own.get_program())
        .args(own.get_args())
        .arg(times.to_string())
        .env("RAYON_NUM_THREADS", "1")
        .env("GLIBC_TUNABLES", PLAIN_FUNCTIONS)
        .output()
        .map_err(|e| format!("valgrind: {e}"))?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if output.status.success() {
        Ok(said)
    } else {
        Err(format!("{} under valgrind:\n{said}", entry.name))
    }
}
