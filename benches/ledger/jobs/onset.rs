//! Modes over wind speed: by eigenvalues and by the p-k iteration.

use super::models::{coupled, four_filters, rows};
use crate::entry::Job;
use aerodeck::aerodynamics::{ContinuousRealization, Realizable, Realization};
use aerodeck::flutter::{FlutterCurves, pk_curves, trace_modes};
use nalgebra::DMatrix;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::hint::black_box;
use std::rc::Rc;

fn speeds() -> Vec<f64> {
    (17..=40).map(f64::from).collect()
}

/// The V-g sweep with modes; the baseline finds the same frequencies at the last speed.
pub(crate) fn sweep() -> Job {
    let section = coupled(&four_filters());
    let found = Rc::new(RefCell::new(vec![]));
    let answer = Rc::clone(&found);
    let work = move || {
        let curves = trace_modes("sweep", &section, &speeds()).expect("modes");
        *found.borrow_mut() = last_frequencies(&curves);
    };
    Job::new(work).finding(move || answer.borrow().clone())
}

fn last_frequencies(curves: &FlutterCurves) -> Vec<f64> {
    let last = curves.branches.iter().filter_map(|b| b.points.last());
    let mut all: Vec<f64> = last.map(|p| p.frequency_hz).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// The p-k iteration over the same speeds.
pub(crate) fn pk() -> Job {
    let trained = four_filters();
    let structure = trained.section.structure().expect("a structure");
    Job::new(move || {
        black_box(pk_curves("pk", &structure, &trained.model, &speeds()).expect("curves"));
    })
}

pub(crate) fn sweep_argument() -> Value {
    let trained = four_filters();
    let structure = trained.section.structure().expect("a structure");
    let Realization::Continuous(ContinuousRealization {
        a,
        b,
        c,
        e0,
        e1,
        e2,
    }) = trained.model.realize()
    else {
        panic!("not continuous");
    };
    let all: [(&str, &DMatrix<f64>); 9] = [
        ("a", &a),
        ("b", &b),
        ("c", &c),
        ("e0", &e0),
        ("e1", &e1),
        ("e2", &e2),
        ("mass", &structure.mass),
        ("damping", &structure.damping),
        ("stiffness", &structure.stiffness),
    ];
    let mut argument = json!({
        "width": structure.width_m, "density": structure.air_density_kg_m3, "speeds": speeds(),
    });
    for (name, matrix) in all {
        argument[name] = rows(matrix);
    }
    argument
}
