//! Parameters that active constraints hold together: estimates move only along what these leave free.

use super::poles::FreePoles;
use crate::error::Result;
use crate::identification::basis::Basis;
use crate::identification::dissipative::{ActiveConstraint, Tangent};
use crate::identification::options::Form;
use crate::identification::report::FitReport;
use nalgebra::{DMatrix, DVector};

/// Relative step of central differences with respect to poles.
const STEP: f64 = 1e-5;

/// Orthonormal directions that the active constraints of a fit leave to its parameters, P×q; `None` where nothing holds
/// it. `first` is the first parameter of every transfer function; searched poles are the last.
pub(super) fn tangent_of(
    report: &FitReport,
    (form, poles): (&Form, &FreePoles),
    first: &[usize],
    parameters: usize,
) -> Result<Option<DMatrix<f64>>> {
    let Some(constraints) = &report.constraints else {
        return Ok(None);
    };
    let mut gradients = vec![DVector::zeros(parameters); constraints.active.len()];
    let n = report.entries.len().isqrt();
    for (e, entry) in report.entries.iter().enumerate() {
        let place = (e / n, e % n);
        let values = entry.values();
        let free = form.collapse(&entry.poles);
        let at = |m: usize, factor: f64| {
            let mut moved = free.clone();
            moved[m] *= factor;
            Basis::new(form, &form.expand(&moved))
        };
        let basis = Basis::new(form, &entry.poles)?;
        for (gradient, active) in gradients.iter_mut().zip(&constraints.active) {
            for (c, x) in active.gradient(place, &basis).iter().enumerate() {
                gradient[first[e] + c] = *x;
            }
        }
        for (m, pole) in poles.searched.iter().enumerate() {
            if pole.entry.is_some_and(|entry| entry != place) {
                continue;
            }
            let step = 2.0 * STEP * free[pole.index];
            let (up, down) = (at(pole.index, 1.0 + STEP)?, at(pole.index, 1.0 - STEP)?);
            for (gradient, active) in gradients.iter_mut().zip(&constraints.active) {
                let value = |b: &Basis| held(active, place, b, &values);
                let place = parameters - poles.searched.len() + m;
                gradient[place] += (value(&up) - value(&down)) / step;
            }
        }
    }
    Ok(Some(Tangent::new(gradients.into_iter()).basis(parameters)))
}

/// What a transfer function adds to what a constraint holds.
fn held(active: &ActiveConstraint, place: (usize, usize), basis: &Basis, values: &[f64]) -> f64 {
    let gradient = active.gradient(place, basis);
    gradient.iter().zip(values).map(|(g, v)| g * v).sum()
}

/// How active constraints enter, in words.
pub(super) fn held_sentence(report: &FitReport) -> String {
    match &report.constraints {
        Some(c) => format!(
            "; what {} active constraint(s) hold counts as known",
            c.active.len()
        ),
        None => String::new(),
    }
}
