//! A grid of 50 values by 10 numbers of filters on the full set of records against NumPy and SciPy, in the same run.
//!
//! `cargo bench --bench selection` prints a table; nothing is asserted here. Ours is the time of the whole grid with all
//! its models and residuals, on all cores; the judging of the cells (data left out, onsets) is timed apart, since the
//! baseline does not do it. The baseline is timed on every tenth value and taken ten times: each value costs the same.

#[path = "../tests/common/python.rs"]
mod python;

use aerodeck::files::derivatives::embedded;
use aerodeck::flutter::OnsetSearch;
use aerodeck::identification::{Grid, GridAxis, TimeFit, TimeWeights};
use aerodeck::section::{Dof, SectionModel};
use aerodeck::selection::{SelectionPlan, select};
use aerodeck::wind_tunnel::{Record, RecordSource, TunnelPlan};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::hint::black_box;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

const VALUES: usize = 50;
const FILTERS: usize = 10;
/// Every how many values the baseline computes.
const SHARE: usize = 10;
const ROUNDS: usize = 3;

fn main() {
    let python = python::interpreter().unwrap_or_else(|why| panic!("{why}"));
    let records = full_set();
    let sources: Vec<&dyn RecordSource> = records.iter().map(|r| r as _).collect();
    let samples: usize = records.iter().map(|r| r.motion[0].len()).sum::<usize>() / 2;
    println!(
        "grid of {VALUES} values by {FILTERS} numbers of filters, {samples} samples a motion, medians of {ROUNDS} rounds\n"
    );
    let spread = |low: f64, high: f64| -> Vec<f64> {
        let last = VALUES as f64 - 1.0;
        (0..VALUES)
            .map(|i| low + (high - low) * i as f64 / last)
            .collect()
    };
    let fit = TimeFit {
        weights: TimeWeights::None,
        ..TimeFit::default()
    };
    for (name, axis) in [
        (
            "discrete, L and α",
            GridAxis::Discrete(spread(0.3, 0.95), TimeWeights::None),
        ),
        (
            "continuous, L and p",
            GridAxis::Continuous(spread(0.05, 1.9), Box::new(fit)),
        ),
    ] {
        compare(name, &records, &sources, &axis, &python);
    }
}

fn compare(
    name: &str,
    records: &[Record],
    sources: &[&dyn RecordSource],
    axis: &GridAxis,
    python: &Path,
) {
    let continuous = matches!(axis, GridAxis::Continuous(..));
    let file = tempfile::NamedTempFile::new().expect("a file");
    let shared: Vec<f64> = axis.values().iter().copied().step_by(SHARE).collect();
    let argument: Vec<Value> = records
        .iter()
        .map(|r| {
            json!({
                "width": r.header.width_m, "speed": r.header.mean_speed_m_s, "density": r.header.air_density_kg_m3,
                "sampling": r.header.sampling_hz, "motion": r.motion, "force": r.force,
            })
        })
        .collect();
    let argument = json!({
        "records": argument, "values": shared, "filters": FILTERS, "continuous": continuous,
    });
    std::fs::write(file.path(), argument.to_string()).expect("a file");
    let (mut ours, mut theirs) = (vec![], vec![]);
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let grid = Grid::new(sources, axis.clone(), FILTERS, &|_| ()).expect("a grid");
        let cells: Vec<_> = (0..VALUES)
            .into_par_iter()
            .map(|value| grid.fits(value, &|_| true))
            .collect();
        black_box(cells);
        ours.push(start.elapsed().as_secs_f64());
        theirs.push(SHARE as f64 * baseline(python, file.path()));
    }
    let (ours, theirs) = (median(ours), median(theirs));
    println!(
        "{name}: {ours:.2} s; SciPy lfilter + NumPy lstsq a cell {theirs:.1} s; ratio {:.1}",
        theirs / ours
    );
    let grid = Grid::new(sources, axis.clone(), FILTERS, &|_| ()).expect("a grid");
    let plan = SelectionPlan {
        structure: SectionModel::table_4_1().structure().expect("a structure"),
        search: OnsetSearch {
            speed_max_m_s: 60.0,
            speeds: 120,
        },
    };
    let start = Instant::now();
    let selection = select(&grid, &plan, &|_| ()).expect("a selection");
    println!(
        "  judging all cells (data left out, onsets, guards): {:.2} s\n  {}\n",
        start.elapsed().as_secs_f64(),
        selection.reason
    );
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Runs the baseline; gives the seconds it prints.
fn baseline(python: &Path, argument: &Path) -> f64 {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/baseline/selection.py");
    let output = Command::new(python)
        .arg(script)
        .arg(argument)
        .stderr(Stdio::inherit())
        .output()
        .expect("python");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    text.trim()
        .parse()
        .unwrap_or_else(|_| panic!("the baseline printed `{text}`"))
}

/// Records of 43 200 samples, four for each motion: 172 800 samples per motion.
fn full_set() -> Vec<Record> {
    let plan = TunnelPlan::default();
    ["LN21-5200", "LN21-5500"]
        .into_iter()
        .flat_map(|name| {
            let deck = embedded::deck(name).expect("an embedded deck");
            plan.records_from_table(&deck, &Dof::TWO).expect("records")
        })
        .collect()
}
