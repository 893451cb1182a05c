//! Onsets of many random sections.

use super::models::{SPEED_MAX_M_S, by_filters, rows};
use crate::entry::{Job, finding};
use aerodeck::aerodynamics::{LaguerreModel, Realizable, Realization};
use aerodeck::flutter::{LinearForces, OnsetSweep, SweepOutcome};
use aerodeck::identification::LEAST_CHOSEN;
use aerodeck::section::SectionModel;
use aerodeck::trained_model::Model;
use aerodeck::uncertainty::monte_carlo::{MonteCarloPlan, monte_carlo};
use nalgebra::DMatrix;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::hint::black_box;
use std::rc::Rc;

pub(crate) const SAMPLES: u32 = 300;

const PLAN: &str = r#"
schema = 1
model = "model.json"
samples = 1000
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

/// Random numbers, section, onset and tally of a whole analysis.
pub(crate) fn analysis(samples: usize) -> Job {
    let mut plan = MonteCarloPlan::from_toml(PLAN, "".into()).expect("a plan");
    plan.samples = samples;
    let trained = by_filters(LEAST_CHOSEN);
    finding(plan, move |plan| monte_carlo(plan, &trained, &|_, _| ()))
}

pub(crate) fn thousand() -> Job {
    analysis(1000)
}

pub(crate) fn million() -> Job {
    analysis(1_000_000)
}

fn laguerre() -> LaguerreModel {
    match by_filters(LEAST_CHOSEN).model {
        Model::Laguerre(model) => model,
        other => panic!("not {}", other.kind()),
    }
}

fn sweep(model: &LaguerreModel) -> OnsetSweep {
    let structure = SectionModel::table_4_1().structure().expect("a structure");
    let forces = LinearForces::of_laguerre(model, None);
    OnsetSweep::new(forces, &structure, SPEED_MAX_M_S).expect("a sweep")
}

/// Sections with coefficients of their forces, drawn once.
fn drawn(sweep: &OnsetSweep) -> Vec<(SectionModel, Vec<f64>)> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut varied = |x: f64, part: f64| x * (1.0 + part * random.random_range(-1.0..1.0));
    let one = |_| {
        let mut s = SectionModel::table_4_1();
        s.air_density_kg_m3 = varied(s.air_density_kg_m3, 0.05);
        s.vertical.mass_kg_m = varied(s.vertical.mass_kg_m, 0.1);
        s.torsion.inertia_kg_m2_m = varied(s.torsion.inertia_kg_m2_m, 0.1);
        s.torsion.damping_ratio = varied(s.torsion.damping_ratio, 0.5);
        let c = sweep.forces().coefficients();
        (s, c.iter().map(|c| varied(*c, 0.05)).collect())
    };
    (0..SAMPLES).map(one).collect()
}

/// Every onset of the drawn sections; the baseline finds the same.
pub(crate) fn onsets() -> Job {
    let sweep = sweep(&laguerre());
    let samples = drawn(&sweep);
    let found = Rc::new(RefCell::new(vec![f64::NAN; samples.len()]));
    let answer = Rc::clone(&found);
    let work = move || {
        for ((section, coefficients), found) in samples.iter().zip(found.borrow_mut().iter_mut()) {
            let outcome = sweep.onset(black_box(section), coefficients);
            *found = match outcome.expect("a sample") {
                SweepOutcome::Onset(o) => o.speed_m_s,
                _ => f64::NAN,
            };
        }
    };
    Job::new(work).finding(move || answer.borrow().clone())
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

pub(crate) fn onsets_argument() -> Value {
    let model = laguerre();
    let realised = |model: &LaguerreModel| {
        let Realization::Continuous(r) = model.realize() else {
            panic!("not continuous")
        };
        r
    };
    let one = |(section, coefficients): &(SectionModel, Vec<f64>)| {
        let s = section.structure().expect("a structure");
        let diagonal = |m: &DMatrix<f64>| m.diagonal().iter().copied().collect::<Vec<_>>();
        let r = realised(&replaced(&model, coefficients));
        json!({
            "width": s.width_m, "density": s.air_density_kg_m3, "mass": diagonal(&s.mass),
            "damping": diagonal(&s.damping), "stiffness": diagonal(&s.stiffness),
            "e0": rows(&r.e0), "e1": rows(&r.e1), "e2": rows(&r.e2), "c": rows(&r.c),
        })
    };
    let r = realised(&model);
    let samples = drawn(&sweep(&model));
    json!({
        "a": rows(&r.a), "b": rows(&r.b), "speed_min": 5.0, "speed_max": SPEED_MAX_M_S, "speeds": 24,
        "samples": samples.iter().map(one).collect::<Vec<_>>(),
    })
}
