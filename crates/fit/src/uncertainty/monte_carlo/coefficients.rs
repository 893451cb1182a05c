//! The coefficients of a saved force model as one row of numbers with names, and back.

use crate::flutter::LinearForces;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;

/// The model as a linear combination; `None` for the sampled one.
pub(super) fn linear(model: &Model, tested: Option<ReducedFrequencyRange>) -> Option<LinearForces> {
    match model {
        Model::Laguerre(m) => Some(LinearForces::of_laguerre(m, tested)),
        Model::Rational(m) => Some(LinearForces::of_rational(m, tested)),
        Model::MinimumState(m) => Some(LinearForces::of_rational(&m.to_roger(), tested)),
        Model::DiscreteLaguerre(_) => None,
    }
}

/// Coefficients and their names, `force.motion.term`.
pub(super) fn list(model: &Model) -> (Vec<f64>, Vec<String>) {
    let (mut values, mut names) = (Vec::new(), Vec::new());
    if let Model::DiscreteLaguerre(m) = model {
        for term in &m.terms {
            for (l, column) in term.coefficients.column_iter().enumerate() {
                for (i, value) in column.iter().enumerate() {
                    let (force, motion) = (m.dofs[i].name(), m.dofs[term.input].name());
                    values.push(*value);
                    names.push(format!("{force}.{motion}.c{l}"));
                }
            }
        }
    } else if let Some(forces) = linear(model, None) {
        values = forces.coefficients().to_vec();
        names = forces.names();
    }
    (values, names)
}

/// Puts `values`, in the order of [`of`], into the model. Coefficients of their own have no place in the minimum-state
/// form, which becomes the same function in Roger's.
pub(super) fn replace(model: &mut Model, values: &[f64]) {
    if let Model::MinimumState(m) = model {
        *model = Model::Rational(m.to_roger());
    }
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
                for l in 0..m.lag_terms.len() {
                    for (_, own) in m.lag_groups(l) {
                        let mut elsewhere = 0.0;
                        for (x, own) in m.lag_terms[l].column_mut(j).iter_mut().zip(own) {
                            put(if own { x } else { &mut elsewhere });
                        }
                    }
                }
            }
        }
        // became Roger's above
        Model::MinimumState(_) => {}
        Model::DiscreteLaguerre(m) => {
            let all = m.terms.iter_mut().flat_map(|t| t.coefficients.iter_mut());
            all.for_each(&mut put);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::{Lags, MinimumStateModel, RationalModel, Transfer};
    use crate::units::ReducedFrequency;
    use nalgebra::DMatrix;

    /// Own lags and minimum states survive the way through a row of numbers, also one that is changed: the model moves as
    /// its linear combination says.
    #[test]
    fn newer_rational_forms_are_rows_of_numbers() {
        let roger = RationalModel::jones_flat_plate();
        let mut own = roger.clone();
        own.lags = Lags::PerForce(vec![vec![0.08, 0.7], vec![0.08, 0.5]]);
        let small = MinimumStateModel {
            dofs: roger.dofs.clone(),
            a1: roger.a1.clone(),
            a2: roger.a2.clone(),
            a3: roger.a3.clone(),
            lags: vec![0.15, 0.7],
            d: DMatrix::from_row_slice(2, 2, &[1.0, -0.5, 0.1, 0.6]),
            e: DMatrix::from_row_slice(2, 2, &[0.3, 1.0, -1.2, 0.4]),
        };
        let k = ReducedFrequency::from_full_width(0.3);
        for model in [Model::Rational(own), Model::MinimumState(small)] {
            let (mut values, names) = list(&model);
            assert_eq!(values.len(), names.len());
            let mut same = model.clone();
            replace(&mut same, &values);
            let before = model.transfer(k).unwrap();
            // the same terms in another order
            assert!((same.transfer(k).unwrap() - &before).camax() < 1e-14);
            let at = names
                .iter()
                .position(|n| n == "torsion.vertical.a4")
                .unwrap();
            values[at] += 0.1;
            replace(&mut same, &values);
            let moved = same.transfer(k).unwrap() - before;
            assert!(moved[(1, 0)].norm() > 0.05 && moved[(0, 0)].norm() < 1e-14);
        }
    }
}
