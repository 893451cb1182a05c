//! Whole bridges: Langenuen with 39 modes, and a beam on the flat plate with as many nodes as asked for.

use super::c_interface::{FmiKind, LoadedUnit, Unpacked};
use super::models::folder;
use crate::bridges;
use crate::entry::Job;
use aerodeck::aerodynamics::RationalModel;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::bridge::{Bridge, BridgeMode, Node, StripGroup};
use aerodeck::buffeting::{
    BuffetingProblem, Coherence, Gust, GustSpectrum, SpectrumShape, Turbulence, span_record,
    turbulence_field,
};
use aerodeck::files::bridge::tributary_lengths;
use aerodeck::flutter::trace_modes;
use aerodeck::response::{Inputs, Stepper};
use aerodeck::study::bridge::{BridgeExportOptions, BridgeStudy, bridge_flutter};
use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::hint::black_box;
use std::path::Path;
use std::sync::{Arc, Once};

const STEP_S: f64 = 0.05;

fn write_unit(folder: &Path, study: &BridgeStudy) {
    let wanted = BridgeExportOptions {
        nodes: ["1156", "1081"].map(String::from).to_vec(),
        ..BridgeExportOptions::default()
    };
    let (model, export) = study.export(&wanted).expect("an export");
    let bridge = export.bridge.expect("a bridge");
    let files = [
        ("model.json", model.to_json().expect("a model")),
        ("bridge.json", bridge.to_json().expect("a bridge")),
    ];
    for (name, text) in files {
        std::fs::write(folder.join(name), text).expect("a file");
    }
}

fn unit(folder: &Path) -> LoadedUnit {
    let read = |name| std::fs::read_to_string(folder.join(name)).expect("a file");
    let archive = Unpacked::of_bridge(&read("model.json"), &read("bridge.json"));
    LoadedUnit::new(archive, FmiKind::CoSimulation, &[("wind_speed", 30.0)])
}

pub(crate) fn prepare_whole() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        write_unit(
            &folder("bridge"),
            &bridges::langenuen("LN21-5200", bridges::TWO),
        );
    });
}

/// Flutter by table and by model in uniform wind.
pub(crate) fn flutter() -> Job {
    flutter_of("")
}

/// The same in the profile of docs/bridge.md.
pub(crate) fn flutter_in_profile() -> Job {
    flutter_of(
        "[wind]\nprofile = [{ along_m = -617.5, factor = 0.9 }, { along_m = 617.5, factor = 1.0 }]\n",
    )
}

fn flutter_of(wind: &str) -> Job {
    let text = bridges::langenuen_text("LN21-5200", bridges::TWO, "modified_akima");
    let study = bridges::read(&(text + wind));
    Job::new(move || {
        black_box(bridge_flutter(&study).expect("an answer"));
    })
}

/// A step of the unit of all modes with readings at mid-span.
pub(crate) fn step() -> Job {
    stepped(|_, _| ())
}

/// The same with another wind before each step.
pub(crate) fn step_in_another_wind() -> Job {
    let mut wind = None;
    stepped(move |unit, n| {
        let wind = *wind.get_or_insert_with(|| unit.reference("wind_speed"));
        unit.set(&[wind], &[30.0 + 1e-6 * n]);
    })
}

fn stepped(mut before: impl FnMut(&LoadedUnit, f64) + 'static) -> Job {
    let unit = unit(&folder("bridge"));
    let references = unit.references(["node[1156].heave", "node[1081].rotation"]);
    let mut n = 0.0;
    Job::new(move || {
        before(&unit, n);
        unit.do_step(n * STEP_S, STEP_S);
        unit.get(&references, &mut [0.0; 2]);
        n += 1.0;
    })
}

/// `damping_now` of the unit of all modes in another wind, which goes up and down.
pub(crate) fn damping() -> Job {
    let unit = unit(&folder("bridge"));
    let [wind, damping] = unit.references(["wind_speed", "damping_now"]);
    let mut n = 0.0;
    Job::new(move || {
        unit.set(&[wind], &[another_wind(n)]);
        unit.get(&[damping], &mut [0.0]);
        n += 1.0;
    })
}

/// All eigenvalues in the same winds.
pub(crate) fn all_eigenvalues() -> Job {
    let section = langenuen();
    let mut n = 0.0;
    Job::new(move || {
        let system = section.at(another_wind(n)).expect("a system");
        black_box(system.eigenvalues().expect("eigenvalues"));
        n += 1.0;
    })
}

/// m/s; at most 0.25 a step.
fn another_wind(n: f64) -> f64 {
    30.0 + 5.0 * (0.05 * n).sin()
}

pub(crate) fn prepare_few_modes() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| write_unit(&folder("few_modes"), &bridges::lively()));
}

/// `onset_speed` of the unit of eight modes after another density of the air.
pub(crate) fn onset() -> Job {
    let unit = unit(&folder("few_modes"));
    let [density, onset] = unit.references(["air_density", "onset_speed"]);
    let mut n = 0.0;
    Job::new(move || {
        unit.set(&[density], &[1.2 + 1e-3 * (n % 100.0)]);
        unit.get(&[onset], &mut [0.0]);
        n += 1.0;
    })
}

/// Langenuen, coupled.
fn langenuen() -> CoupledSection {
    bridges::coupled(&bridges::langenuen("LN21-5200", bridges::TWO).by_model)
}

/// A bare product of as many states.
pub(crate) fn product() -> Job {
    let states = langenuen().states();
    let matrix = DMatrix::from_fn(states, states, |i, j| if i == j { 0.9 } else { 1e-4 });
    let mut x = DVector::from_element(states, 1.0);
    let mut y = x.clone();
    Job::new(move || {
        matrix.mul_to(&x, &mut y);
        std::mem::swap(&mut x, &mut y);
        black_box(&x);
    })
}

fn sixty() -> Vec<f64> {
    (1..=60).map(|i| 1.5 * f64::from(i)).collect()
}

pub(crate) fn sweep() -> Job {
    let section = langenuen();
    Job::new(move || {
        black_box(trace_modes("bridge", &section, &sixty()).expect("modes"));
    })
}

/// The matrices of the sweep.
pub(crate) fn sweep_argument() -> Value {
    let section = langenuen();
    let matrix = |v: &f64| super::models::rows(&section.at(*v).expect("a system").a);
    json!({ "matrices": sixty().iter().map(matrix).collect::<Vec<_>>() })
}

/// Both domains with two records of ten minutes.
pub(crate) fn buffeting() -> Job {
    let text = bridges::langenuen_text("LN21-5200", bridges::TWO, "modified_akima").replace(
        "motions =",
        "static = { drag = 0.08, lift = -0.1, lift_slope = 4.0, moment = 0.02, moment_slope = 1.1 }\nmotions =",
    ) + "[buffeting]\n\
         along = { spectrum = { shape = { kind = \"kaimal\" }, length_m = 150.0, intensity = 0.12 } }\n\
         vertical = { spectrum = { shape = { kind = \"kaimal\" }, length_m = 15.0, intensity = 0.06 } }\n\
         time = { records = 2, duration_s = 600.0, step_s = 0.05 }\n";
    let study = bridges::read(&text);
    let block = study.buffeting_block().expect("a block");
    Job::new(move || {
        black_box(
            study
                .buffeting(&block, 35.0, &|_, _| {})
                .expect("a response"),
        );
    })
}

/// A beam of 1000 m on the flat plate: half sines, a third of the modes vertical, lateral and torsional each.
pub(crate) fn beam(nodes: usize, modes: usize) -> Bridge {
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
    let group: StripGroup = StripGroup {
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

/// Turbulence along and across it.
pub(crate) fn problem(bridge: &Bridge) -> BuffetingProblem<'static> {
    let gust = |length_m, intensity| {
        Some(Gust {
            spectrum: GustSpectrum {
                shape: SpectrumShape::Kaimal {},
                length_m,
                intensity,
            },
            admittance: Default::default(),
        })
    };
    let turbulence = Turbulence {
        along: gust(150.0, 0.12),
        vertical: gust(15.0, 0.06),
    };
    let matrices = [[[-0.2, 4.1], [0.16, 0.1], [0.04, 1.1]]];
    BuffetingProblem::of_bridge(bridge, &matrices, turbulence, Coherence::default())
        .expect("a problem")
}

const TEN_MINUTES: usize = 12_000;

/// Turbulence of ten minutes at 100 strips.
pub(crate) fn field() -> Job {
    let bridge = beam(100, 39);
    Job::new(move || {
        black_box(
            turbulence_field(&problem(&bridge), 30.0, STEP_S, TEN_MINUTES, 1).expect("a field"),
        );
    })
}

/// Response of 39 modes to it.
pub(crate) fn response() -> Job {
    let bridge = beam(100, 39);
    let field = turbulence_field(&problem(&bridge), 30.0, STEP_S, TEN_MINUTES, 1).expect("a field");
    Job::new(move || {
        black_box(span_record(&problem(&bridge), &[50], 30.0, STEP_S, &field).expect("a response"));
    })
}

/// A bridge of 1000 nodes and 100 modes: coupled, followed over twenty wind speeds, stepped.
pub(crate) fn thousand_nodes() -> Job {
    Job::new(|| {
        let section = bridges::coupled(&beam(1000, 100));
        let speeds: Vec<f64> = (1..=20).map(f64::from).collect();
        black_box(trace_modes("beam", &section, &speeds).expect("modes"));
        let mut stepper = Stepper::new(section);
        let release = stepper.released(&[1.0; 100], &[0.0; 100]);
        let mut state = release.expect("a release");
        let inputs = Inputs::steady(30.0, 100);
        stepper
            .advance(&mut state, &inputs, STEP_S)
            .expect("a step");
    })
}
