//! The coefficients of a saved force model as one row of numbers with names, and back.

use crate::flutter::LinearForces;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;

/// The model as a linear combination; `None` for the sampled one.
pub(super) fn linear(model: &Model, tested: ReducedFrequencyRange) -> Option<LinearForces> {
    match model {
        Model::Laguerre(m) => Some(LinearForces::of_laguerre(m, Some(tested))),
        Model::Rational(m) => Some(LinearForces::of_rational(m, Some(tested))),
        Model::DiscreteLaguerre(_) => None,
    }
}

/// Coefficients and their names, `force.motion.term`.
pub(super) fn of(model: &Model) -> (Vec<f64>, Vec<String>) {
    let forces = match model {
        Model::Laguerre(m) => LinearForces::of_laguerre(m, None),
        Model::Rational(m) => LinearForces::of_rational(m, None),
        Model::DiscreteLaguerre(m) => {
            let (mut values, mut names) = (Vec::new(), Vec::new());
            for term in &m.terms {
                for (l, column) in term.coefficients.column_iter().enumerate() {
                    for (i, value) in column.iter().enumerate() {
                        let (force, motion) = (m.dofs[i].name(), m.dofs[term.input].name());
                        values.push(*value);
                        names.push(format!("{force}.{motion}.c{l}"));
                    }
                }
            }
            return (values, names);
        }
    };
    (forces.coefficients().to_vec(), forces.names().to_vec())
}

/// Puts `values`, in the order of [`of`], into the model.
pub(super) fn replace(model: &mut Model, values: &[f64]) {
    let mut next = values.iter().copied();
    let mut put = |place: &mut f64| {
        if let Some(value) = next.next() {
            *place = value;
        }
    };
    match model {
        Model::Laguerre(m) => {
            for j in 0..m.dofs.len() {
                for matrix in [&mut m.e0, &mut m.e1, &mut m.e2] {
                    matrix.column_mut(j).iter_mut().for_each(&mut put);
                }
                for term in m.terms.iter_mut().filter(|t| t.input == j) {
                    term.coefficients.iter_mut().for_each(&mut put);
                }
            }
        }
        Model::Rational(m) => {
            for j in 0..m.dofs.len() {
                for matrix in [&mut m.a1, &mut m.a2, &mut m.a3] {
                    matrix.column_mut(j).iter_mut().for_each(&mut put);
                }
                for term in &mut m.lag_terms {
                    term.column_mut(j).iter_mut().for_each(&mut put);
                }
            }
        }
        Model::DiscreteLaguerre(m) => {
            let all = m.terms.iter_mut().flat_map(|t| t.coefficients.iter_mut());
            all.for_each(&mut put);
        }
    }
}
