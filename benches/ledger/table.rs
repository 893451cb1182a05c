//! The table: on the screen as it comes, and as Markdown.

use crate::entry::{Baseline, BenchEntry, Threads};
use crate::peak;
use crate::stored::StoredCounts;
use crate::timing::{Rival, Seconds, timed};

const HEAD: [&str; 8] = [
    "what",
    "size",
    "threads",
    "ours",
    "baseline",
    "ratio",
    "instructions",
    "peak memory",
];

/// Runs the entries, prints each as it is done, and gives the table as Markdown.
pub(crate) fn print(entries: &[&BenchEntry]) -> Result<String, String> {
    let stored = StoredCounts::read()?;
    let mut text = format!("| {} |\n|{}\n", HEAD.join(" | "), "---|".repeat(HEAD.len()));
    print!("{text}");
    let mut failed = Vec::new();
    for entry in entries {
        match cells(entry, &stored) {
            Ok(cells) => {
                let row = format!("| {} |\n", cells.join(" | "));
                print!("{row}");
                text += &row;
            }
            // the others are worth having
            Err(why) => failed.push(format!("{}: {why}", entry.name)),
        }
    }
    if failed.is_empty() {
        Ok(text)
    } else {
        Err(failed.join("\n"))
    }
}

fn cells(entry: &BenchEntry, stored: &StoredCounts) -> Result<[String; 8], String> {
    let found = timed(entry)?;
    let (baseline, ratio, theirs) = match (&found.baseline, &entry.baseline) {
        (
            Some(Rival {
                name,
                seconds,
                peak_mib,
            }),
            _,
        ) => {
            let ratio = format!("{:.2}", seconds.median / found.ours.median);
            (format!("{name}: {}", words(*seconds)), ratio, *peak_mib)
        }
        (None, Baseline::None(reason)) => (format!("none: {reason}"), "–".into(), None),
        (None, _) => return Err("its baseline did not run".into()),
    };
    let own = match entry.judged_peak {
        true => peak::measured(entry)?,
        false => None,
    };
    let mib = |x: f64| format!("{x:.0} MiB");
    let peak = match (own, theirs) {
        (Some(own), Some(theirs)) => format!("{}; {}", mib(own), mib(theirs)),
        (Some(own), None) => mib(own),
        _ => "–".into(),
    };
    let instructions = stored.instructions.get(entry.name);
    Ok([
        format!("`{}` {}", entry.name, entry.what),
        entry.size.to_owned(),
        match entry.threads {
            Threads::One => "1".into(),
            Threads::All => "all".into(),
        },
        words(found.ours),
        baseline,
        ratio,
        instructions.map_or("–".into(), |f| grouped(f.value)),
        peak,
    ])
}

/// Median with least and most, in one unit.
fn words(s: Seconds) -> String {
    let number = |x| in_unit_of(s.median, x);
    let (unit, median) = (unit(s.median).1, number(s.median));
    format!(
        "{median} {unit} ({} to {})",
        number(s.least),
        number(s.most)
    )
}

/// A time in the unit that it is read in.
pub(crate) fn time_in_words(seconds: f64) -> String {
    format!("{} {}", in_unit_of(seconds, seconds), unit(seconds).1)
}

fn unit(seconds: f64) -> (f64, &'static str) {
    match seconds {
        m if m < 1e-6 => (1e9, "ns"),
        m if m < 1e-3 => (1e6, "µs"),
        m if m < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    }
}

fn in_unit_of(median: f64, seconds: f64) -> String {
    let x = seconds * unit(median).0;
    let decimals = 2_usize.saturating_sub(x.abs().log10().floor().max(0.0) as usize);
    format!("{x:.decimals$}")
}

/// Digits by threes.
fn grouped(value: f64) -> String {
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}
