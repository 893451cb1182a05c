//! What a change costs at run time: of the wind at every step, of a parameter, of the instance itself; each against the
//! plain way of doing the same, in the same run, as ratios.
//!
//! `cargo bench --bench changes` prints a table; nothing is asserted here.

use aerodeck::aerodynamics::{GustForce, RationalAdmittance, Realizable};
use aerodeck::aeroelastic::{CoupledSection, CoupledSystem};
use aerodeck::flutter::{OnsetSearch, find_onset};
use aerodeck::fmu::instance::Instance;
use aerodeck::fmu::resources::{OptionFiles, Resources};
use aerodeck::response::{Inputs, Stepper};
use aerodeck::state_space::{StateEquation, c2d};
use aerodeck::trained_model::TrainedModel;
use nalgebra::DVector;
use std::hint::black_box;
use std::time::Instant;

/// Interleaved rounds of ours and the baseline; medians are printed.
const ROUNDS: usize = 7;
const STEP_S: f64 = 0.005;

fn main() {
    println!("medians of {ROUNDS} interleaved rounds, one thread\n");
    for kind in ["continuous_laguerre", "discrete_laguerre"] {
        let model = model(kind);
        println!("{kind}, {} states", coupled(&model).states());
        winds(&model);
        gusts(&model);
        parameters(&model);
        println!();
    }
}

fn file(kind: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/models");
    std::fs::read_to_string(format!("{folder}/{kind}.json")).expect("a model")
}

fn model(kind: &str) -> TrainedModel {
    TrainedModel::from_json(&file(kind)).expect("a model")
}

fn coupled(model: &TrainedModel) -> CoupledSection {
    let structure = model.section.structure().expect("a structure");
    CoupledSection::new(structure, model.model.realize()).expect("a section")
}

/// Prints the medians of both, in microseconds each time, and their ratio.
fn compare(
    what: &str,
    times: usize,
    mut ours: impl FnMut(usize),
    (baseline, mut theirs): (&str, impl FnMut(usize)),
) {
    let mut seconds = [vec![], vec![]];
    for _ in 0..ROUNDS {
        let begin = Instant::now();
        (0..times).for_each(&mut ours);
        seconds[0].push(begin.elapsed().as_secs_f64());
        let begin = Instant::now();
        (0..times).for_each(&mut theirs);
        seconds[1].push(begin.elapsed().as_secs_f64());
    }
    let [a, b] = seconds.map(|mut all| {
        all.sort_by(f64::total_cmp);
        1e6 * all[ROUNDS / 2] / times as f64
    });
    println!(
        "  {what}: {a:.3} us; {baseline}: {b:.3} us; ratio {:.1}",
        b / a
    );
}

/// A gust series: another wind at every step.
fn wind(i: usize) -> f64 {
    30.0 + 3.0 * (0.01 * i as f64).sin()
}

fn winds(model: &TrainedModel) {
    let section = coupled(model);
    let steady = |_| Inputs::steady(30.0, 2);
    let held = |i| Inputs::steady(wind(i), 2);
    let ramps = |i| {
        let mut inputs = held(i);
        inputs.wind_speed_rate_m_s2 = (wind(i + 1) - wind(i)) / STEP_S;
        inputs
    };
    stepped("steady wind", &section, steady, &[0.01, 0.0]);
    stepped("steady wind, died out", &section, steady, &[1e-249, 0.0]);
    stepped("wind set at every step", &section, held, &[0.01, 0.0]);
    stepped("wind on ramps", &section, ramps, &[0.01, 0.0]);
}

/// Gusts on top, through four lags each, against the same steps without them.
fn gusts(model: &TrainedModel) {
    let tau = std::f64::consts::TAU;
    let force = GustForce {
        dofs: model.section.dofs(),
        coefficients: vec![[0.0, tau], [0.0, 0.25 * tau]],
        admittance: RationalAdmittance::Sears,
        source: "thin plate".into(),
    };
    let run = |force: Option<&GustForce>| {
        let mut stepper = Stepper::in_gusts(coupled(model), force);
        let mut state = stepper
            .released(&[0.01, 0.0], &[0.0; 2])
            .expect("a release");
        let blows = force.is_some();
        move |i: usize| {
            let mut inputs = Inputs::steady(wind(i), 2);
            inputs.wind_speed_rate_m_s2 = (wind(i + 1) - wind(i)) / STEP_S;
            if blows {
                inputs.gust_m_s = vec![0.1 * wind(i), 0.05 * wind(7 * i)];
                inputs.gust_rate_m_s2 = vec![1.0, -2.0];
            }
            stepper
                .advance(&mut state, &inputs, STEP_S)
                .expect("a step");
        }
    };
    compare(
        "gusts at every step and wind on ramps",
        2000,
        run(Some(&force)),
        ("wind on ramps alone", run(None)),
    );
}

/// Against a matrix exponential for every step: of the whole section at the wind of its middle or, of a sampled model, of
/// the structure.
fn stepped(
    what: &str,
    section: &CoupledSection,
    inputs: impl Fn(usize) -> Inputs,
    release: &[f64],
) {
    let mut stepper = Stepper::new(section.clone());
    let mut state = stepper.released(release, &[0.0; 2]).expect("a release");
    let step = |i: usize| {
        stepper
            .advance(&mut state, &inputs(i), STEP_S)
            .expect("a step");
    };
    let mut z = DVector::from_element(section.states(), 0.01);
    let by_exponential = |i: usize| {
        let StateEquation { a, b } = match section.at(wind(i)).expect("a system") {
            CoupledSystem::Continuous(s) => StateEquation { a: s.a, b: s.b },
            CoupledSystem::Sampled(_) => section.structure_alone(),
        };
        let phi = c2d(&a, &b, STEP_S).expect("a step").phi;
        let head = &phi * z.rows(0, phi.ncols());
        z.rows_mut(0, phi.nrows()).copy_from(&head);
    };
    compare(
        what,
        2000,
        step,
        ("a matrix exponential a step", by_exponential),
    );
}

fn parameters(model: &TrainedModel) {
    let json = model.to_json().expect("a model");
    let resources =
        || Resources::from_bytes(json.as_bytes(), OptionFiles::default()).expect("resources");
    let mut instance = Instance::new(resources()).expect("an instance");
    let place = |name| {
        let variables = instance.table().variables();
        let place = variables.iter().position(|v| v.name == name);
        place.expect("a variable") as u32
    };
    let (mass, onset) = (place("mass"), place("onset_speed"));
    instance.enter_initialization();
    let search = OnsetSearch {
        speed_max_m_s: model.experiment.onset_search_limit_m_s,
        ..OnsetSearch::default()
    };
    let section = coupled(model);
    let by_search = |_| {
        black_box(find_onset("", &section, &search, Some(model.tested_range)).expect("an onset"));
    };
    let changed = |i: usize| {
        let mass_kg_m = 15.0 + 1e-3 * (i % 100) as f64;
        instance.set_reals(&[mass], &[mass_kg_m]).expect("a mass");
        instance.reals(&[onset], &mut [0.0]).expect("an onset");
    };
    let search_name = "the search of all eigenvalues";
    compare(
        "onset_speed after a change",
        20,
        changed,
        (search_name, by_search),
    );
    let made = |_| drop(black_box(Instance::new(resources()).expect("an instance")));
    compare(
        "an instance made and dropped",
        20,
        made,
        (search_name, by_search),
    );
}
