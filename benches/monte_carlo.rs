//! Onsets of random sections a second, against a NumPy loop over the same samples in the same run.
//!
//! `cargo bench --bench monte_carlo` prints the figures; nothing is asserted here.

#[path = "../tests/common/python.rs"]
mod python;

use aerodeck::aerodynamics::{LaguerreModel, Realizable, Realization};
use aerodeck::files::derivatives::embedded;
use aerodeck::flutter::{LinearForces, OnsetSweep, SweepOutcome};
use aerodeck::identification::{Fitted, Form, FrequencyFit, fit_table};
use aerodeck::section::{Dof, SectionModel};
use aerodeck::trained_model::{Experiment, Model, Provenance, SCHEMA_VERSION, TrainedModel};
use aerodeck::uncertainty::monte_carlo::{MonteCarloPlan, monte_carlo};
use nalgebra::DMatrix;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::hint::black_box;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

/// Interleaved rounds of ours and the baseline; medians are printed.
const ROUNDS: usize = 5;
const SAMPLES: usize = 300;
const SPEED_MAX: f64 = 60.0;

const PLAN: &str = r#"
schema = 1
model = "model.json"
samples = 50000
speed_max_m_s = 60.0
[aerodynamics]
relative_scatter = 0.03
[[parameter]]
name = "vertical.mass_kg_m"
distribution = { kind = "lognormal", coefficient_of_variation = 0.05 }
[[parameter]]
name = "torsion.frequency_hz"
distribution = { kind = "lognormal", coefficient_of_variation = 0.05 }
[[parameter]]
name = "torsion.damping_ratio"
distribution = { kind = "lognormal", coefficient_of_variation = 0.4 }
[[parameter]]
name = "air_density_kg_m3"
distribution = { kind = "uniform", lower = 1.15, upper = 1.28 }
"#;

fn main() {
    let python = python::interpreter().unwrap_or_else(|why| panic!("{why}"));
    let trained = three_filters();
    let Model::Laguerre(model) = &trained.model else {
        panic!("a Laguerre model")
    };
    println!("medians of {ROUNDS} interleaved rounds, one thread each; 4 + 6 = 10 states\n");
    compare(model, &python);
    whole_analysis(&trained);
}

/// One bank of three filters per motion, fitted to the deck LN21-5200.
fn three_filters() -> TrainedModel {
    let table = embedded::deck("LN21-5200").expect("a deck");
    let fit = FrequencyFit {
        form: Form::default(),
        ..FrequencyFit::default()
    };
    let Fitted { model, report } =
        fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &fit).expect("a fit");
    let states = model.realize().states();
    assert_eq!(states, 6, "one bank of three filters");
    TrainedModel {
        schema_version: SCHEMA_VERSION,
        name: "LN21-5200".into(),
        section: SectionModel::table_4_1(),
        model,
        tested_range: report.tested_range,
        provenance: Provenance {
            source: table.header.source.clone(),
            licence: table.header.licence.clone(),
            method: report.method,
            aerodeck_version: env!("CARGO_PKG_VERSION").into(),
            notes: vec![],
        },
        experiment: Experiment {
            wind_speed_m_s: 30.0,
            initial_vertical_m: 0.01,
            initial_rotation_rad: 0.0,
            stop_time_s: 10.0,
            step_size_s: 0.01,
            onset_search_limit_m_s: SPEED_MAX,
        },
    }
}

fn rows(m: &DMatrix<f64>) -> Value {
    let rows = m.row_iter().map(|r| r.iter().copied().collect::<Vec<_>>());
    json!(rows.collect::<Vec<_>>())
}

/// The same model with other coefficients, in the order of [`LinearForces::coefficients`].
fn replaced(model: &LaguerreModel, c: &[f64]) -> LaguerreModel {
    let per_input = c.len() / 2;
    let at = |j: usize, b: usize, i: usize| c[j * per_input + 2 * b + i];
    let mut m = model.clone();
    m.e0 = DMatrix::from_fn(2, 2, |i, j| at(j, 0, i));
    m.e1 = DMatrix::from_fn(2, 2, |i, j| at(j, 1, i));
    m.e2 = DMatrix::from_fn(2, 2, |i, j| at(j, 2, i));
    for term in &mut m.terms {
        let (j, filters) = (term.input, term.coefficients.ncols());
        term.coefficients = DMatrix::from_fn(2, filters, |i, l| at(j, 3 + l, i));
    }
    m
}

fn compare(model: &LaguerreModel, python: &Path) {
    let nominal = SectionModel::table_4_1();
    let structure = nominal.structure().expect("a structure");
    let forces = LinearForces::of_laguerre(model, None);
    let sweep = OnsetSweep::new(forces, &structure, SPEED_MAX).expect("a sweep");
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut varied = |x: f64, part: f64| x * (1.0 + part * random.random_range(-1.0..1.0));
    let samples: Vec<(SectionModel, Vec<f64>)> = (0..SAMPLES)
        .map(|_| {
            let mut s = nominal.clone();
            s.air_density_kg_m3 = varied(s.air_density_kg_m3, 0.05);
            s.vertical.mass_kg_m = varied(s.vertical.mass_kg_m, 0.1);
            s.torsion.inertia_kg_m2_m = varied(s.torsion.inertia_kg_m2_m, 0.1);
            s.torsion.damping_ratio = varied(s.torsion.damping_ratio, 0.5);
            let c = sweep.forces().coefficients();
            (s, c.iter().map(|c| varied(*c, 0.05)).collect())
        })
        .collect();
    let file = tempfile::NamedTempFile::new().expect("a file");
    std::fs::write(file.path(), argument(model, &samples).to_string()).expect("a file");
    let (mut ours, mut theirs) = (vec![], vec![]);
    let mut worst = 0.0_f64;
    let mut found = vec![None; SAMPLES];
    for _ in 0..ROUNDS {
        const REPETITIONS: usize = 20;
        let start = Instant::now();
        for _ in 0..REPETITIONS {
            for ((section, coefficients), found) in samples.iter().zip(&mut found) {
                let outcome = sweep
                    .onset(black_box(section), coefficients)
                    .expect("a sample");
                *found = match outcome {
                    SweepOutcome::Onset(o) => Some(o.speed_m_s),
                    _ => None,
                };
            }
        }
        ours.push(start.elapsed().as_secs_f64() / (SAMPLES * REPETITIONS) as f64);
        let (seconds, onsets) = baseline(python, file.path());
        theirs.push(seconds);
        for (a, b) in found.iter().zip(&onsets) {
            if let (Some(a), Some(b)) = (a, b) {
                worst = worst.max((a / b - 1.0).abs());
            }
        }
    }
    let missing = found.iter().filter(|f| f.is_none()).count();
    let (ours, theirs) = (median(ours), median(theirs));
    println!(
        "one onset: {:.2} us ({:.0} a second and core); NumPy loop {:.0} us; ratio {:.0}",
        1e6 * ours,
        1.0 / ours,
        1e6 * theirs,
        theirs / ours
    );
    println!(
        "largest relative difference of the onsets {worst:.1e}; {missing} of {SAMPLES} without onset\n"
    );
}

fn argument(model: &LaguerreModel, samples: &[(SectionModel, Vec<f64>)]) -> Value {
    let Realization::Continuous(r) = model.realize() else {
        panic!("not continuous")
    };
    let one = |(section, coefficients): &(SectionModel, Vec<f64>)| {
        let s = section.structure().expect("a structure");
        let diagonal = |m: &DMatrix<f64>| m.diagonal().iter().copied().collect::<Vec<_>>();
        let Realization::Continuous(r) = replaced(model, coefficients).realize() else {
            panic!("not continuous")
        };
        json!({
            "width": s.width_m, "density": s.air_density_kg_m3, "mass": diagonal(&s.mass),
            "damping": diagonal(&s.damping), "stiffness": diagonal(&s.stiffness),
            "e0": rows(&r.e0), "e1": rows(&r.e1), "e2": rows(&r.e2), "c": rows(&r.c),
        })
    };
    json!({
        "a": rows(&r.a), "b": rows(&r.b), "speed_min": 5.0, "speed_max": SPEED_MAX, "speeds": 24,
        "samples": samples.iter().map(one).collect::<Vec<_>>(),
    })
}

fn baseline(python: &Path, argument: &Path) -> (f64, Vec<Option<f64>>) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/baseline/monte_carlo.py");
    let output = Command::new(python)
        .arg(script)
        .arg(argument)
        .envs(["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"].map(|k| (k, "1")))
        .stderr(Stdio::inherit())
        .output()
        .expect("python");
    let answer: Value = serde_json::from_slice(&output.stdout).expect("the answer of the baseline");
    let onsets = answer["onsets"].as_array().expect("onsets");
    let seconds = answer["seconds"].as_f64().expect("seconds");
    (seconds, onsets.iter().map(Value::as_f64).collect())
}

/// Random numbers, section, onset and tally of a whole analysis on one thread.
fn whole_analysis(trained: &TrainedModel) {
    let plan = MonteCarloPlan::from_toml(PLAN, "".into()).expect("a plan");
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread");
    let times = (0..ROUNDS).map(|_| {
        let start = Instant::now();
        let result = pool.install(|| monte_carlo(&plan, trained, &|_, _| ()));
        black_box(result.expect("an analysis"));
        start.elapsed().as_secs_f64()
    });
    let seconds = median(times.collect());
    println!(
        "aerodeck monte-carlo, {} samples with 28 random numbers each, one thread: {:.2} s, {:.0} onsets a second\n",
        plan.samples,
        seconds,
        plan.samples as f64 / seconds
    );
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
