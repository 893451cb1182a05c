//! Speed and memory against NumPy and SciPy doing the same work in the same run, as ratios.
//!
//! `cargo bench --bench speed` prints a table; nothing is asserted here.

#[path = "../tests/common/python.rs"]
mod python;

use aerodeck::aerodynamics::{ContinuousRealization, Realizable, Realization};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::derivatives::embedded;
use aerodeck::flutter::trace_modes;
use aerodeck::fmu::importer::{Fmu, Slave};
use aerodeck::fmu::package::{GrowthPolicy, Overwrite, Runtime, write_fmu};
use aerodeck::identification::{
    FeedThrough, Fitted, Form, FrequencyFit, PoleSearch, TimeFit, TimeWeights, fit_records,
    fit_table,
};
use aerodeck::section::{Dof, SectionModel};
use aerodeck::study::demo_study_text;
use aerodeck::trained_model::{Experiment, Provenance, SCHEMA_VERSION, TrainedModel};
use aerodeck::wind_tunnel::{Record, RecordSource, TunnelPlan};
use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};
use std::hint::black_box;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Interleaved rounds of ours and the baseline; medians are printed.
const ROUNDS: usize = 5;
const POLE: f64 = 0.5;

fn main() {
    let python = python::interpreter().unwrap_or_else(|why| panic!("{why}"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let fmu = folder.path().join("speed.fmu");
    let model = twelve_states();
    write_fmu(
        &fmu,
        &model,
        &Runtime::available().expect("a runtime"),
        Overwrite::Replace,
        GrowthPolicy::Refuse,
    )
    .expect("an FMU");
    println!("medians of {ROUNDS} interleaved rounds, one thread each\n");
    stepping(&fmu);
    sweep(&model, &python);
    training(&python);
    memory_of_training(folder.path());
    growth(&fmu);
}

/// A model with four filters per motion: twelve states with the section.
fn twelve_states() -> TrainedModel {
    let deck = embedded::deck("LN21-5200").expect("an embedded deck");
    let fit = FrequencyFit {
        form: laguerre(4),
        poles: PoleSearch::fixed(&[POLE]),
        ..FrequencyFit::default()
    };
    let Fitted { model, report } =
        fit_table(&deck.samples(&Dof::TWO), &Dof::TWO, &fit).expect("a fit");
    TrainedModel {
        schema_version: SCHEMA_VERSION,
        name: "speed".into(),
        section: SectionModel::table_4_1(),
        model,
        tested_range: report.tested_range,
        provenance: Provenance {
            source: deck.header.source.clone(),
            licence: deck.header.licence.clone(),
            method: report.method,
            aerodeck_version: env!("CARGO_PKG_VERSION").into(),
            notes: vec![],
        },
        experiment: Experiment {
            wind_speed_m_s: 30.0,
            initial_vertical_m: 0.01,
            initial_rotation_rad: 0.02,
            stop_time_s: 10.0,
            step_size_s: 0.01,
            onset_search_limit_m_s: 60.0,
        },
    }
}

fn laguerre(filters: usize) -> Form {
    Form::Laguerre {
        filters: Some(filters),
        feed_through: FeedThrough::default(),
        pole_per_transfer_function: false,
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// fmi2DoStep and fmi2GetReal of four outputs against a bare matrix-vector product of the same size.
fn stepping(fmu: &Path) {
    const STEPS: usize = 1_000_000;
    let fmu = Fmu::open(fmu).expect("the FMU");
    let mut slave = fmu.instantiate("speed").expect("an instance");
    start(&fmu, &mut slave);
    let names = ["heave", "heave_rate", "rotation", "rotation_rate"];
    let references: Vec<u32> = names
        .iter()
        .map(|n| {
            fmu.model_description()
                .variable(n)
                .expect("an output")
                .value_reference
        })
        .collect();
    let matrix = DMatrix::from_fn(12, 16, |i, j| 1.0 / (1.0 + i as f64 + j as f64));
    let operand = DVector::from_element(16, 0.5);
    let mut product = DVector::zeros(12);
    let (mut ours, mut gemv, mut loops) = (vec![], vec![], vec![]);
    let mut values = [0.0; 4];
    let mut step = 0_usize;
    for _ in 0..ROUNDS {
        ours.push(seconds(|| {
            for _ in 0..STEPS {
                slave.do_step(step as f64 * 0.005, 0.005).expect("a step");
                slave.read_real(&references, &mut values).expect("values");
                step += 1;
            }
        }));
        gemv.push(seconds(|| {
            for _ in 0..STEPS {
                product.gemv(1.0, black_box(&matrix), black_box(&operand), 0.0);
                black_box(&product);
            }
        }));
        loops.push(seconds(|| {
            for _ in 0..STEPS {
                let (m, v) = (black_box(&matrix), black_box(&operand));
                for i in 0..12 {
                    product[i] = (0..16).map(|j| m[(i, j)] * v[j]).sum();
                }
                black_box(&product);
            }
        }));
    }
    let ns = |times: Vec<f64>| 1e9 * median(times) / STEPS as f64;
    let (ours, gemv, loops) = (ns(ours), ns(gemv), ns(loops));
    println!(
        "step of the FMU through its C interface, 12 states, fmi2DoStep + fmi2GetReal(4): {ours:.0} ns"
    );
    println!(
        "  bare 12x16 product: nalgebra gemv {gemv:.0} ns (ratio {:.2}), row loops {loops:.0} ns (ratio {:.2})\n",
        ours / gemv,
        ours / loops
    );
}

/// Initialises under a steady lift: a motion that dies out ends in denormal numbers, which are slow on their own account.
fn start(fmu: &Fmu, slave: &mut Slave) {
    slave.setup(0.0, None, None).expect("setup");
    slave.enter_initialization().expect("initialisation");
    let lift = fmu
        .model_description()
        .variable("external_lift")
        .expect("an input");
    slave
        .set_real(&[lift.value_reference], &[1.0])
        .expect("an input");
    slave.exit_initialization().expect("initialisation");
}

/// Runs a baseline script with a JSON argument file; gives the seconds it prints.
fn baseline(python: &Path, script: &str, argument: &Path) -> f64 {
    let output = Command::new(python)
        .arg(
            Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("benches/baseline")
                .join(script),
        )
        .arg(argument)
        .envs(["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"].map(|k| (k, "1")))
        .stderr(Stdio::inherit())
        .output()
        .expect("python");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    text.trim()
        .parse()
        .unwrap_or_else(|_| panic!("{script} printed `{text}`"))
}

fn rows(m: &DMatrix<f64>) -> Value {
    json!(
        m.row_iter()
            .map(|r| r.iter().copied().collect::<Vec<_>>())
            .collect::<Vec<_>>()
    )
}

/// The 24-speed V-g sweep with modes.
fn sweep(model: &TrainedModel, python: &Path) {
    const REPETITIONS: usize = 50;
    let structure = model.section.structure().expect("a structure");
    let realization = model.model.realize();
    let Realization::Continuous(ContinuousRealization {
        a,
        b,
        c,
        e0,
        e1,
        e2,
    }) = &realization
    else {
        panic!("not continuous");
    };
    let speeds: Vec<f64> = (17..=40).map(f64::from).collect();
    let file = tempfile::NamedTempFile::new().expect("a file");
    let argument = json!({
        "a": rows(a), "b": rows(b), "c": rows(c), "e0": rows(e0), "e1": rows(e1), "e2": rows(e2),
        "mass": rows(&structure.mass), "damping": rows(&structure.damping), "stiffness": rows(&structure.stiffness),
        "width": structure.width_m, "density": structure.air_density_kg_m3, "speeds": speeds, "repetitions": REPETITIONS,
    });
    std::fs::write(file.path(), argument.to_string()).expect("a file");
    let section = CoupledSection::new(structure, realization.clone()).expect("a section");
    let (mut ours, mut theirs) = (vec![], vec![]);
    for _ in 0..ROUNDS {
        ours.push(
            seconds(|| {
                for _ in 0..REPETITIONS {
                    black_box(trace_modes("speed", &section, &speeds).expect("modes"));
                }
            }) / REPETITIONS as f64,
        );
        theirs.push(baseline(python, "sweep.py", file.path()));
    }
    let (ours, theirs) = (median(ours), median(theirs));
    println!(
        "V-g sweep with modes, 24 speeds, 12 states: {:.0} us; NumPy eig with tracking {:.0} us; ratio {:.1}\n",
        1e6 * ours,
        1e6 * theirs,
        theirs / ours
    );
}

/// Records of 43 200 samples, four for each motion: 172 800 samples per motion.
fn full_set() -> Vec<Record> {
    let deck = embedded::deck("LN21-5200").expect("an embedded deck");
    let other = embedded::deck("LN21-5500").expect("an embedded deck");
    let plan = TunnelPlan::default();
    let mut records = plan.records_from_table(&deck, &Dof::TWO).expect("records");
    records.extend(plan.records_from_table(&other, &Dof::TWO).expect("records"));
    records
}

/// Filters and least squares over the full set of records with a given pole.
fn training(python: &Path) {
    let records = full_set();
    let sources: Vec<&dyn RecordSource> = records.iter().map(|r| r as &dyn RecordSource).collect();
    let fit = TimeFit {
        form: laguerre(6),
        poles: PoleSearch::fixed(&[POLE]),
        weights: TimeWeights::None,
        ..TimeFit::default()
    };
    let one_thread = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread");
    let file = tempfile::NamedTempFile::new().expect("a file");
    let argument: Vec<Value> = records
        .iter()
        .map(|r| {
            json!({
                "width": r.header.width_m, "speed": r.header.mean_speed_m_s, "density": r.header.air_density_kg_m3,
                "sampling": r.header.sampling_hz, "motion": r.motion, "force": r.force,
            })
        })
        .collect();
    std::fs::write(
        file.path(),
        json!({ "records": argument, "filters": 6, "pole": POLE }).to_string(),
    )
    .expect("a file");
    let (mut ours, mut theirs) = (vec![], vec![]);
    for _ in 0..ROUNDS {
        ours.push(seconds(|| {
            let result = one_thread.install(|| fit_records(&sources, &fit, &|_| ()));
            black_box(result.expect("a fit").model);
        }));
        theirs.push(baseline(python, "training.py", file.path()));
    }
    let samples: usize = records.iter().map(|r| r.motion[0].len()).sum();
    let (ours, theirs) = (median(ours), median(theirs));
    println!(
        "training, {} samples a motion, L = 6: {:.0} ms; SciPy lfilter + NumPy lstsq {:.0} ms; ratio {:.1}\n",
        samples / 2,
        1e3 * ours,
        1e3 * theirs,
        theirs / ours
    );
}

/// Peak memory of `aerodeck train` on records of one hour at 200 Hz.
fn memory_of_training(folder: &Path) {
    let program = env!("CARGO_BIN_EXE_aerodeck");
    let study = demo_study_text().replace(
        "[[model]]\nname = \"Laguerre\"",
        "[tunnel]\nsegment_s = 449.0\n\n[[model]]\nname = \"Laguerre\"",
    );
    std::fs::write(folder.join("study.toml"), study).expect("a study");
    let run = |command: &str| {
        let mut child = Command::new(program)
            .args([command, "study.toml", "--quiet"])
            .current_dir(folder)
            .stdout(Stdio::null())
            .spawn()
            .expect("the program");
        let mut peak = 0;
        let start = Instant::now();
        while child.try_wait().expect("a status").is_none() {
            peak = peak.max(memory_kib(child.id(), "VmHWM:").unwrap_or(0));
            std::thread::sleep(Duration::from_millis(2));
        }
        (peak as f64 / 1024.0, start.elapsed().as_secs_f64())
    };
    run("tunnel");
    let (peak, time) = run("train");
    println!(
        "training on four records of one hour at 200 Hz: peak memory {peak:.0} MiB, {time:.1} s\n"
    );
}

fn memory_kib(process: u32, key: &str) -> Option<usize> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find(|l| l.starts_with(key))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

/// Resident memory over many steps and over many loads of the library.
fn growth(fmu: &Path) {
    let resident = || memory_kib(std::process::id(), "VmRSS:").unwrap_or(0) as f64 / 1024.0;
    let run = |steps: usize| {
        let fmu = Fmu::open(fmu).expect("the FMU");
        let mut slave = fmu.instantiate("growth").expect("an instance");
        start(&fmu, &mut slave);
        for i in 0..steps {
            slave.do_step(i as f64 * 0.005, 0.005).expect("a step");
        }
    };
    run(1000);
    let before = resident();
    run(10_000_000);
    println!(
        "1e7 steps: {before:.1} MiB before, {:.1} MiB after",
        resident()
    );
    (0..50).for_each(|_| run(1));
    let before = resident();
    (0..1000).for_each(|_| run(1));
    println!(
        "1000 loads and unloads: {before:.1} MiB before, {:.1} MiB after",
        resident()
    );
}
