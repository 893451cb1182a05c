//! Steps, rates and instances of a section through the C interface, and strips of forces.

use super::c_interface::{FmiKind, LoadedUnit, Unpacked};
use super::models::{by_filters, text};
use crate::entry::Job;
use aerodeck::aerodynamics::{GustForce, RationalAdmittance};
use aerodeck::fmu::force_options::ForceOptions;
use aerodeck::fmu::instance::Instance;
use aerodeck::fmu::resources::Resources;
use aerodeck::identification::{LEAST_CHOSEN, MOST_CHOSEN};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;
use std::hint::black_box;

const STEP_S: f64 = 0.01;
/// Of the continuous model with its section; another number is refused.
const STATES: usize = 12;
const MOTION: [&str; 4] = ["heave", "heave_rate", "rotation", "rotation_rate"];

/// Released; what dies out becomes zero, not a denormal number that would be slow on its own account.
fn released(archive: Unpacked, kind: FmiKind) -> LoadedUnit {
    LoadedUnit::new(archive, kind, &[])
}

/// A step with what `before` sets, and readings of four variables.
fn stepped(
    archive: Unpacked,
    names: [&str; 4],
    before: impl Fn(&LoadedUnit, f64) + 'static,
) -> Job {
    calls(released(archive, FmiKind::CoSimulation), names, before)
}

fn calls(unit: LoadedUnit, names: [&str; 4], before: impl Fn(&LoadedUnit, f64) + 'static) -> Job {
    let references = unit.references(names);
    let (mut n, mut values) = (0.0, [0.0; 4]);
    Job::new(move || {
        before(&unit, n);
        unit.do_step(n * STEP_S, STEP_S);
        unit.get(&references, &mut values);
        n += 1.0;
    })
}

pub(crate) fn motion() -> Job {
    let archive = Unpacked::of_section(&text("continuous_laguerre"), None);
    stepped(archive, MOTION, |_, _| ())
}

/// The same of a deck by filters as many as a fit takes by itself.
pub(crate) fn motion_of_most() -> Job {
    motion_of_deck(MOST_CHOSEN)
}

/// And by the fewest, those of the thesis.
pub(crate) fn motion_of_least() -> Job {
    motion_of_deck(LEAST_CHOSEN)
}

fn motion_of_deck(filters: usize) -> Job {
    let json = by_filters(filters).to_json().expect("a model");
    stepped(Unpacked::of_section(&json, None), MOTION, |_, _| ())
}

/// The calls of [`motion`] with nothing behind them.
pub(crate) fn caller() -> Job {
    let archive = Unpacked::of_section(&text("continuous_laguerre"), None);
    let unit = released(archive, FmiKind::CoSimulation).that_does_nothing();
    calls(unit, MOTION, |_, _| ())
}

pub(crate) fn forces() -> Job {
    let names = ["heave", "lift", "rotation", "moment"];
    let archive = Unpacked::of_section(&text("continuous_laguerre"), None);
    stepped(archive, names, |_, _| ())
}

pub(crate) fn discrete() -> Job {
    let archive = Unpacked::of_section(&text("discrete_laguerre"), None);
    stepped(archive, MOTION, |_, _| ())
}

/// Another wind before each step.
pub(crate) fn another_wind() -> Job {
    let archive = Unpacked::of_section(&text("continuous_laguerre"), None);
    let wind = archive_reference("wind_speed", None);
    stepped(archive, MOTION, move |unit, n| {
        unit.set(&[wind], &[10.0 + 1e-6 * n]);
    })
}

/// Two gusts before each step, through Sears's admittance.
pub(crate) fn gusts() -> Job {
    let gusts = serde_json::to_string(&gust_force()).expect("gusts");
    let references = ["gust_u", "gust_w"].map(|name| archive_reference(name, Some(&gusts)));
    let archive = Unpacked::of_section(&text("continuous_laguerre"), Some(&gusts));
    stepped(archive, MOTION, move |unit, n| {
        let gust = (0.01 * n).sin();
        unit.set(&references, &[gust, 0.5 * gust]);
    })
}

fn archive_reference(name: &str, gusts: Option<&str>) -> u32 {
    let options = [None, gusts.map(str::as_bytes), None];
    let text = text("continuous_laguerre");
    let resources = Resources::from_bytes(text.as_bytes(), options).expect("resources");
    resources.table.find_name(name).expect("a variable") as u32
}

/// The gusts of a thin plate.
pub(crate) fn gust_force() -> GustForce {
    GustForce {
        dofs: aerodeck::section::Dof::TWO.to_vec(),
        coefficients: vec![[0.0, TAU], [0.0, 0.25 * TAU]],
        admittance: RationalAdmittance::Sears,
        source: "thin plate".into(),
    }
}

/// Rates of all states at an instant, for an importer that integrates.
pub(crate) fn derivative() -> Job {
    let archive = Unpacked::of_section(&text("continuous_laguerre"), None);
    let unit = released(archive, FmiKind::ModelExchange);
    unit.integrate();
    let mut states = vec![0.01; STATES];
    let (mut rates, mut n) = (states.clone(), 0.0);
    Job::new(move || {
        n += 1.0;
        states[0] = 0.01 * (0.01 * f64::sin(n));
        unit.rates_at(n * 1e-3, &mut states, &mut rates);
        black_box(&rates);
    })
}

fn instance_of(kind: &str) -> Job {
    let archive = Unpacked::of_section(&text(kind), None);
    Job::new(move || archive.make_and_free())
}

pub(crate) fn instance() -> Job {
    instance_of("continuous_laguerre")
}

pub(crate) fn instance_rational() -> Job {
    instance_of("rational")
}

pub(crate) fn instance_discrete() -> Job {
    instance_of("discrete_laguerre")
}

/// A product of 12 by 16 numbers in nalgebra: states and inputs.
pub(crate) fn product_in_nalgebra() -> Job {
    let matrix = DMatrix::from_fn(12, 16, |i, j| 1.0 / (1.0 + i as f64 + j as f64));
    let operand = DVector::from_element(16, 0.5);
    let mut product = DVector::zeros(12);
    Job::new(move || {
        product.gemv(1.0, black_box(&matrix), black_box(&operand), 0.0);
        black_box(&product);
    })
}

/// Strips of the force unit.
pub(crate) const STRIPS: u32 = 1000;
const STRIP_STEP_S: f64 = 0.02;

/// Motion of all strips set, one step, all forces read.
pub(crate) fn strips() -> Job {
    strips_of(STRIPS.into())
}

pub(crate) fn strips_of(strips: u64) -> Job {
    let mut options = ForceOptions::single(0.5);
    options.strips = vec![options.strips[0].clone(); strips as usize];
    options.named_strips = true;
    let mut unit = running(Some(&options.to_json().expect("options")));
    let names = |of: &str| {
        (1..=strips)
            .map(|i| format!("strip[{i}].{of}"))
            .collect::<Vec<_>>()
    };
    let motion = places(&unit, &[names("heave"), names("rotation")].concat());
    let forces = places(&unit, &[names("lift"), names("moment")].concat());
    let (mut moved, mut found) = (vec![0.0; motion.len()], vec![0.0; forces.len()]);
    let mut n = 0.0;
    Job::new(move || {
        let t = n * STRIP_STEP_S;
        for (i, x) in moved.iter_mut().enumerate() {
            *x = 0.01 * (6.0 * t + i as f64).sin();
        }
        unit.set_reals(&motion, &moved).expect("motion");
        unit.do_step(t, STRIP_STEP_S).expect("a step");
        unit.reals(&forces, &mut found).expect("forces");
        n += 1.0;
    })
}

/// As many coupled sections, each stepped by itself in the same wind, and their forces read.
pub(crate) fn as_many_sections() -> Job {
    let mut sections: Vec<_> = (0..STRIPS).map(|_| running(None)).collect();
    let names = ["lift", "moment"].map(str::to_owned);
    let outputs = places(&sections[0], &names);
    let mut n = 0.0;
    Job::new(move || {
        for section in &mut sections {
            section
                .do_step(n * STRIP_STEP_S, STRIP_STEP_S)
                .expect("a step");
            section.reals(&outputs, &mut [0.0; 2]).expect("forces");
        }
        n += 1.0;
    })
}

fn running(force: Option<&str>) -> Instance {
    let json = text("continuous_laguerre");
    let options = [force.map(str::as_bytes), None, None];
    let resources = Resources::from_bytes(json.as_bytes(), options).expect("resources");
    let mut instance = Instance::new(resources).expect("an instance");
    instance.enter_initialization();
    instance.exit_initialization().expect("initial values");
    instance
}

fn places(instance: &Instance, names: &[String]) -> Vec<u32> {
    let table = instance.table();
    let place = |name: &String| table.find_name(name).expect("a variable") as u32;
    names.iter().map(place).collect()
}

/// Ten million steps: their memory must not grow.
pub(crate) fn ten_million() -> Job {
    let mut steps = motion();
    Job::new(move || steps.run(10_000_000))
}

/// Instances of a runtime that is loaded and unloaded every time.
pub(crate) fn loads() -> Job {
    Job::new(|| {
        for _ in 0..1000 {
            Unpacked::of_section(&text("continuous_laguerre"), None).make_and_free();
        }
    })
}
