//! A whole bridge of 39 modes and 195 states: a step against the bare product of its size, a sweep of 60 wind speeds against the
//! eigenvalues of the same matrices (ours, and NumPy's where `AERODECK_BENCH_PYTHON` names an interpreter with NumPy), ten
//! minutes of buffeting and the field they need.
//!
//! `cargo bench --bench bridge` prints medians and ratios; nothing is asserted here.

#[allow(dead_code)]
#[path = "../tests/common/bridges.rs"]
mod bridges;

use aerodeck::aerodynamics::RationalModel;
use aerodeck::aeroelastic::{CoupledSection, CoupledSystem};
use aerodeck::bridge::{Bridge, BridgeMode, Node, StripGroup, tributary_lengths};
use aerodeck::buffeting::{
    Coherence, Gust, GustSpectrum, SpanProblem, SpectrumShape, Turbulence, span_record,
    turbulence_field,
};
use aerodeck::flutter::trace_modes;
use aerodeck::response::{Inputs, Stepper};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;
use std::io::Write;
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

const ROUNDS: usize = 5;
const SPEEDS: usize = 60;
const STEPS: usize = 2000;

fn main() {
    let study = bridges::langenuen("LN21-5200", bridges::TWO);
    let bridge = &study.by_model;
    let realised = bridge.forces().realize().expect("a realisation");
    let section = CoupledSection::new(bridge.structure(), realised).expect("a coupled bridge");
    println!("{} modes, {} states", bridge.modes.len(), section.states());
    step(&section);
    sweep(&section);
    turbulence();
    hundred_strips();
    thousand_nodes();
}

/// Median of the seconds that each round takes.
fn median(mut round: impl FnMut()) -> f64 {
    let mut all: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let begin = Instant::now();
            round();
            begin.elapsed().as_secs_f64()
        })
        .collect();
    all.sort_by(f64::total_cmp);
    all[ROUNDS / 2]
}

fn step(section: &CoupledSection) {
    let (n, states) = (section.structure().dofs.len(), section.states());
    let mut stepper = Stepper::new(section.clone());
    let mut state = stepper
        .released(&vec![1.0; n], &vec![0.0; n])
        .expect("a release");
    let inputs = Inputs::steady(60.0, n);
    stepper.advance(&mut state, &inputs, 0.1).expect("a step");
    let ours = median(|| {
        for _ in 0..STEPS {
            stepper.advance(&mut state, &inputs, 0.1).expect("a step");
        }
    });
    let matrix = DMatrix::from_fn(states, states, |i, j| if i == j { 0.9 } else { 1e-4 });
    let mut x = DVector::from_element(states, 1.0);
    let mut y = x.clone();
    let bare = median(|| {
        for _ in 0..STEPS {
            matrix.mul_to(&x, &mut y);
            std::mem::swap(&mut x, &mut y);
        }
    });
    let micros = |s: f64| 1e6 * s / STEPS as f64;
    println!(
        "step {:.2} µs, bare product {:.2} µs, ratio {:.2}",
        micros(ours),
        micros(bare),
        ours / bare
    );
}

fn sweep(section: &CoupledSection) {
    let speeds: Vec<f64> = (1..=SPEEDS)
        .map(|i| 90.0 * i as f64 / SPEEDS as f64)
        .collect();
    let ours = median(|| {
        trace_modes("bridge", section, &speeds).expect("modes");
    });
    let matrices: Vec<DMatrix<f64>> = speeds
        .iter()
        .map(|v| match section.at(*v).expect("a system") {
            CoupledSystem::Continuous(s) => s.a,
            CoupledSystem::Sampled(s) => s.a,
        })
        .collect();
    let begin = Instant::now();
    for m in &matrices {
        aerodeck::state_space::eigenvalues(m).expect("eigenvalues");
    }
    let dense = begin.elapsed().as_secs_f64();
    println!(
        "sweep of {SPEEDS} speeds {ours:.3} s, all eigenvalues {dense:.3} s, ratio {:.1}",
        dense / ours
    );
    match numpy(&matrices) {
        Some(theirs) => println!("NumPy's eigvals {theirs:.3} s, ratio {:.1}", theirs / ours),
        None => println!(
            "NumPy's eigvals not timed: AERODECK_BENCH_PYTHON names no interpreter with NumPy"
        ),
    }
}

/// Seconds that NumPy takes for the eigenvalues of all matrices.
fn numpy(matrices: &[DMatrix<f64>]) -> Option<f64> {
    let python = std::env::var_os("AERODECK_BENCH_PYTHON")?;
    let folder = tempfile::tempdir().ok()?;
    let path = folder.path().join("matrices");
    let mut file = std::fs::File::create(&path).ok()?;
    for x in matrices.iter().flat_map(|m| m.as_slice()) {
        file.write_all(&x.to_le_bytes()).ok()?;
    }
    drop(file);
    let script = "import sys,time,numpy as np\n\
                  n=int(sys.argv[2]); a=np.fromfile(sys.argv[1]).reshape(-1,n,n)\n\
                  t=time.perf_counter(); [np.linalg.eigvals(m) for m in a]; print(time.perf_counter()-t)";
    let output = Command::new(python)
        .args(["-c", script])
        .arg(&path)
        .arg(matrices[0].nrows().to_string())
        .output()
        .ok()?;
    String::from_utf8(output.stdout).ok()?.trim().parse().ok()
}

/// A field of 63 nodes and 12 000 samples, and ten minutes at 20 Hz stepped through it.
fn turbulence() {
    let text = bridges::langenuen_text("LN21-5200", bridges::TWO, "modified_akima").replace(
        "motions =",
        "static = { drag = 0.08, lift = -0.1, lift_slope = 4.0, moment = 0.02, moment_slope = 1.1 }\nmotions =",
    ) + "[buffeting]\n\
         along = { spectrum = { shape = { kind = \"kaimal\" }, length_m = 150.0, intensity = 0.12 } }\n\
         vertical = { spectrum = { shape = { kind = \"kaimal\" }, length_m = 15.0, intensity = 0.06 } }\n\
         time = { records = 2, duration_s = 600.0, step_s = 0.05 }\n";
    let study = bridges::read(&text);
    let block = study.buffeting_block().expect("a block");
    let field = median(|| {
        study.first_field(&block, 35.0).expect("a field");
    });
    let begin = Instant::now();
    let found = study
        .buffeting(&block, 35.0, &|_, _| {})
        .expect("a response");
    let all = begin.elapsed().as_secs_f64();
    println!(
        "field of {} nodes x 12000 samples {field:.3} s; both domains with two records {all:.2} s ({} nodes)",
        study.by_model.nodes.len(),
        found.nodes.len()
    );
}

/// A beam of 1000 m on the flat plate: half sines, a third of the modes vertical, lateral and torsional each.
fn beam(nodes: usize, modes: usize) -> Bridge {
    let along: Vec<f64> = (0..nodes)
        .map(|i| 1000.0 * i as f64 / (nodes - 1) as f64)
        .collect();
    let lengths = tributary_lengths(&along);
    let mode = |m: usize| BridgeMode {
        number: m + 1,
        frequency_hz: 0.06 + 0.012 * m as f64 + if m % 3 == 2 { 0.2 } else { 0.0 },
        generalised_mass: if m % 3 == 2 { 1.3e9 } else { 9e6 },
        damping_ratio: 0.005,
        shape: along
            .iter()
            .map(|x| {
                let mut shape = [0.0; 3];
                shape[m % 3] = ((m / 3 + 1) as f64 * PI * x / 1000.0).sin();
                shape
            })
            .collect(),
    };
    let group = StripGroup {
        name: "girder".into(),
        width_m: 30.0,
        wind_factor: 1.0,
        nodes: (0..nodes).collect(),
        forces: Arc::new(RationalModel::jones_flat_plate()),
    };
    let node = |(i, (along_m, length_m)): (usize, (&f64, f64))| Node {
        name: (i + 1).to_string(),
        along_m: *along_m,
        length_m,
    };
    let all = along.iter().zip(lengths).enumerate().map(node).collect();
    let modes = (0..modes).map(mode).collect();
    Bridge::new("beam", 1.25, all, modes, vec![group]).expect("a bridge")
}

/// Ten minutes at 20 Hz with 39 modes and 100 strips, field and response each.
fn hundred_strips() {
    let bridge = beam(100, 39);
    let gust = |length_m, intensity| {
        let shape = SpectrumShape::Kaimal;
        Some(Gust {
            spectrum: GustSpectrum {
                shape,
                length_m,
                intensity,
            },
            admittance: Default::default(),
        })
    };
    let problem = SpanProblem {
        bridge: &bridge,
        gust_matrices: vec![[[-0.2, 4.1], [0.16, 0.1], [0.04, 1.1]]],
        turbulence: Turbulence {
            along: gust(150.0, 0.12),
            vertical: gust(15.0, 0.06),
        },
        coherence: Coherence::default(),
    };
    let made = || turbulence_field(&problem, 30.0, (0.05, 12_000), 1).expect("a field");
    let field = median(|| drop(made()));
    let turbulence = made();
    let response = median(|| {
        span_record(&problem, &[50], 30.0, &turbulence).expect("a response");
    });
    println!(
        "100 strips, 12000 samples: field {field:.3} s, response of 39 modes after it {response:.3} s"
    );
}

/// Memory of a bridge of 1000 nodes and 100 modes: coupled, followed over twenty wind speeds, stepped.
fn thousand_nodes() {
    let bridge = beam(1000, 100);
    let realised = bridge.forces().realize().expect("a realisation");
    let section = CoupledSection::new(bridge.structure(), realised).expect("a coupled bridge");
    let speeds: Vec<f64> = (1..=20).map(f64::from).collect();
    let begin = Instant::now();
    let curves = trace_modes("beam", &section, &speeds).expect("modes");
    let n = bridge.modes.len();
    let mut stepper = Stepper::new(section.clone());
    let mut state = stepper
        .released(&vec![1.0; n], &vec![0.0; n])
        .expect("a release");
    stepper
        .advance(&mut state, &Inputs::steady(30.0, n), 0.05)
        .expect("a step");
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find(|l| l.starts_with("VmHWM"));
    println!(
        "1000 nodes, 100 modes, {} states: {:.2} s, curves {:?}, peak memory of this whole program: {}",
        section.states(),
        begin.elapsed().as_secs_f64(),
        curves.ended,
        peak.unwrap_or("not known")
    );
}
