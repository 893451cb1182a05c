//! What changes of the wind and of a parameter cost, beside the plain way of doing the same.

use super::models::{coupled, model, text};
use super::steps::gust_force;
use crate::entry::Job;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::flutter::{OnsetSearch, find_onset};
use aerodeck::fmu::instance::Instance;
use aerodeck::fmu::resources::Resources;
use aerodeck::response::{Inputs, Stepper};
use aerodeck::state_space::{StateEquation, c2d};
use nalgebra::DVector;
use std::hint::black_box;

const STEP_S: f64 = 0.005;
const CONTINUOUS: &str = "continuous_laguerre";
const DISCRETE: &str = "discrete_laguerre";

/// A gust series: another wind at every step.
fn wind(i: usize) -> f64 {
    30.0 + 3.0 * (0.01 * i as f64).sin()
}

fn held(i: usize) -> Inputs {
    Inputs::steady(wind(i), 2)
}

fn ramps(i: usize) -> Inputs {
    let mut inputs = held(i);
    inputs.wind_speed_rate_m_s2 = (wind(i + 1) - wind(i)) / STEP_S;
    inputs
}

fn stepped(kind: &str, inputs: fn(usize) -> Inputs, release: f64) -> Job {
    driven(Stepper::new(coupled(&model(kind))), inputs, release)
}

fn driven(mut stepper: Stepper, inputs: fn(usize) -> Inputs, release: f64) -> Job {
    let mut state = stepper
        .released(&[release, 0.0], &[0.0; 2])
        .expect("a release");
    let mut i = 0;
    Job::new(move || {
        stepper
            .advance(&mut state, &inputs(i), STEP_S)
            .expect("a step");
        i += 1;
    })
}

pub(crate) fn died_out() -> Job {
    stepped(CONTINUOUS, |_| Inputs::steady(30.0, 2), 1e-249)
}

pub(crate) fn held_continuous() -> Job {
    stepped(CONTINUOUS, held, 0.01)
}

pub(crate) fn held_discrete() -> Job {
    stepped(DISCRETE, held, 0.01)
}

pub(crate) fn ramps_continuous() -> Job {
    stepped(CONTINUOUS, ramps, 0.01)
}

pub(crate) fn ramps_discrete() -> Job {
    stepped(DISCRETE, ramps, 0.01)
}

/// Two gusts on top of the ramps, through four lags each.
pub(crate) fn gusts_on_ramps() -> Job {
    let stepper = Stepper::in_gusts(coupled(&model(CONTINUOUS)), Some(&gust_force()));
    let inputs = |i| {
        let mut inputs = ramps(i);
        inputs.gust_m_s = vec![0.1 * wind(i), 0.05 * wind(7 * i)];
        inputs.gust_rate_m_s2 = vec![1.0, -2.0];
        inputs
    };
    driven(stepper, inputs, 0.01)
}

/// A matrix exponential for every step: of the whole section at the wind of its middle.
pub(crate) fn exponential_continuous() -> Job {
    exponential(coupled(&model(CONTINUOUS)))
}

/// Of a sampled model, of the structure.
pub(crate) fn exponential_discrete() -> Job {
    exponential(coupled(&model(DISCRETE)))
}

fn exponential(section: CoupledSection) -> Job {
    let mut z = DVector::from_element(section.states(), 0.01);
    let mut i = 0;
    Job::new(move || {
        let whole = section.equation_at(wind(i));
        let StateEquation { a, b } = whole.unwrap_or_else(|_| section.structure_alone());
        let phi = c2d(&a, &b, STEP_S).expect("a step").phi;
        let head = &phi * z.rows(0, phi.ncols());
        z.rows_mut(0, phi.nrows()).copy_from(&head);
        i += 1;
    })
}

pub(crate) fn onset_continuous() -> Job {
    onset(CONTINUOUS)
}

pub(crate) fn onset_discrete() -> Job {
    onset(DISCRETE)
}

/// `onset_speed` after another mass.
fn onset(kind: &str) -> Job {
    let json = text(kind);
    let resources = Resources::from_bytes(json.as_bytes(), [None; 3]);
    let mut instance = Instance::new(resources.expect("resources")).expect("an instance");
    let place = |name| instance.table().find_name(name).expect("a variable") as u32;
    let (mass, onset) = (place("mass"), place("onset_speed"));
    instance.enter_initialization();
    let mut i = 0;
    Job::new(move || {
        let mass_kg_m = 15.0 + 1e-3 * f64::from(i % 100);
        instance.set_reals(&[mass], &[mass_kg_m]).expect("a mass");
        instance.reals(&[onset], &mut [0.0]).expect("an onset");
        i += 1;
    })
}

pub(crate) fn search_continuous() -> Job {
    search(CONTINUOUS)
}

pub(crate) fn search_discrete() -> Job {
    search(DISCRETE)
}

/// The search of all eigenvalues from the start.
fn search(kind: &str) -> Job {
    let model = model(kind);
    let search = OnsetSearch {
        speed_max_m_s: model.experiment.onset_search_limit_m_s,
        ..OnsetSearch::default()
    };
    let (section, tested) = (coupled(&model), Some(model.tested_range));
    Job::new(move || {
        black_box(find_onset("", &section, &search, tested).expect("an onset"));
    })
}
